// Nearest points of surfaces to a node: see the header.
#include "biem_contact_slots.h"

#include <algorithm>
#include <cmath>

namespace biem {
namespace {

// Distances that differ by rounding only, as those of two features that are equally near or of one
// feature in two periodic images, are decided by the ids.
constexpr double kTie = 1e-9;

bool is_nearer(const Contact &a, const Contact &b)
{
  if (std::abs(a.distance - b.distance) > kTie * (a.distance + b.distance))
    return a.distance < b.distance;
  if (a.feature != b.feature) return a.feature > b.feature;
  return a.surface < b.surface;
}

double compute_angle(const Vec3 &u, const Vec3 &v)
{
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

// Angle of the triangle at the feature: 2 pi on the face, pi at an edge.
double compute_angle_at(const Mat3 &corners, const Vec3 &weights)
{
  const auto n_corners = (weights.array() != 0.0).count();
  if (n_corners > 1) return n_corners == 3 ? 2.0 * EIGEN_PI : EIGEN_PI;
  const int k = weights[0] != 0.0 ? 0 : weights[1] != 0.0 ? 1 : 2;
  const Vec3 corner = corners.col(k);
  return compute_angle(corners.col((k + 1) % 3) - corner, corners.col((k + 2) % 3) - corner);
}

}    // namespace

Contact make_contact(const Vec3 &p, const Mat3 &corners, const ContactIds &ids,
                     const Vec3 &weights)
{
  Contact contact{};
  contact.triangle = ids;
  for (int k = 0; k < 3; k++)
    contact.feature[k] = weights[k] != 0.0 ? ids[k] : 0;
  std::sort(contact.triangle.begin(), contact.triangle.end());
  std::sort(contact.feature.begin(), contact.feature.end());
  const Vec3 normal =
      (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).normalized();
  const Vec3 offset = p - corners * weights;
  contact.distance = offset.norm();
  contact.direction = contact.distance > 0.0 ? Vec3(offset / contact.distance) : normal;
  contact.side = compute_angle_at(corners, weights) * normal.dot(contact.direction);
  return contact;
}

const Contact *ContactSlots::find(std::int64_t surface) const
{
  for (int k = 0; k < size_; k++)
    if (contacts_[k].surface == surface) return &contacts_[k];
  return nullptr;
}

void ContactSlots::merge(const Contact &contact)
{
  for (int k = 0; k < size_; k++) {
    Contact &kept = contacts_[k];
    if (kept.surface != contact.surface) continue;
    if (kept.feature == contact.feature) {
      const double side = kept.side + contact.side;
      if (contact.triangle < kept.triangle) kept = contact;
      kept.side = side;
    } else if (is_nearer(contact, kept)) {
      kept = contact;
    }
    return;
  }
  if (size_ < kCapacity) {
    append(contact);
    return;
  }
  const auto farthest = std::max_element(contacts_.begin(), contacts_.end(), is_nearer);
  if (is_nearer(contact, *farthest)) *farthest = contact;
}

}    // namespace biem
