// Contacts of nodes with other surfaces: see the header.
#include "biem_lammps_contacts.h"
#include "atom.h"
#include "biem_lammps_compat.h"
#include "biem_mesh_nearest_point.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"
#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

void LammpsContacts::sort_neighbors(const NeighList *list, double *const *stiffness)
{
  const tagint *molecule = atom->molecule;
  const int *type = atom->type;
  std::vector<int> index(atom->nlocal, -1);    // in the list, which in a hybrid style has gaps
  for (int k = 0; k < list->inum; k++) index[list->ilist[k]] = k;
  begin_.assign(1, 0);
  nodes_.clear();
  for (int i = 0; i < atom->nlocal; i++) {
    const int n_neighbors = index[i] >= 0 && atom->num_angle[i] > 0 ? list->numneigh[i] : 0;
    for (int k = 0; k < n_neighbors; k++) {
      const int j = list->firstneigh[i][k] & NEIGHMASK;
      if (molecule[j] != molecule[i] && surfaces.is_body(molecule[j]) &&
          stiffness[type[j]][type[i]] > 0.0)
        nodes_.push_back(j);
    }
    begin_.push_back(static_cast<int>(nodes_.size()));
  }
}

void LammpsContacts::refuse_long_edge(const int *triangle, double length)
{
  const int middle = triangle[1];
  error->one(FLERR, "Pair biem/contact: step {}: an edge of molecule {} at atom {} has the length "
             "{:.4g}, beyond the limit {:.4g} for which the neighbor list was made (twice the "
             "longest edge at the start of the run; 1.01 times for walls): has the membrane become "
             "unstable? If not, start a new run from here",
             update->ntimestep, atom->molecule[middle], atom->tag[middle], length,
             surfaces.edge_limit(atom->type[middle]));
}

void LammpsContacts::find_of_triangle(const int *t, const int *first, const int *last)
{
  double **x = atom->x;
  biem::Mat3 corners;
  corners << biem::Vec3(x[t[0]]), biem::Vec3(x[t[1]]), biem::Vec3(x[t[2]]);
  const biem::Vec3 center = corners.rowwise().mean();
  const double reach = range_ + (corners.colwise() - center).colwise().norm().maxCoeff();
  for (const int *j = first; j != last; j++) {
    const biem::Vec3 p(x[*j]);
    if ((p - center).squaredNorm() >= reach * reach) continue;
    const biem::Vec3 weights =
        biem::compute_nearest_weights(p, corners.col(0), corners.col(1), corners.col(2));
    if ((p - corners * weights).squaredNorm() >= range_ * range_) continue;
    const biem::ContactIds ids = {atom->tag[t[0]], atom->tag[t[1]], atom->tag[t[2]]};
    finds_.push_back({*j, t, weights, biem::make_contact(p, corners, ids, weights)});
    finds_.back().contact.surface = atom->molecule[t[1]];
  }
}

void LammpsContacts::merge(int i, const biem::Contact &contact)
{
  if (slot_of_atom_[i] < 0) {
    slot_of_atom_[i] = static_cast<int>(slots_.size());
    slots_.emplace_back();
  }
  slots_[slot_of_atom_[i]].merge(contact);
}

const std::vector<NodeContact> &LammpsContacts::find_contacts()
{
  double **x = atom->x;
  finds_.clear();
  contacts_.clear();
  int found[2] = {0, 0}, found_all[2];    // at any surface, at a wall
  for (int a = 0; a < neighbor->nanglelist; a++) {
    const int *t = neighbor->anglelist[a];
    const biem::Vec3 middle(x[t[1]]);
    const double squared = std::max((biem::Vec3(x[t[0]]) - middle).squaredNorm(),
                                    (biem::Vec3(x[t[2]]) - middle).squaredNorm());
    const double limit = surfaces.edge_limit(atom->type[t[1]]);
    if (!(squared <= limit * limit)) refuse_long_edge(t, std::sqrt(squared));
    const int first = begin_[t[1]], last = begin_[t[1] + 1];
    if (first == last) continue;
    const size_t before = finds_.size();
    find_of_triangle(t, nodes_.data() + first, nodes_.data() + last);
    if (finds_.size() == before) continue;
    found[surfaces.is_wall(atom->molecule[t[1]])] = 1;
  }
  MPI_Allreduce(found, found_all, 2, MPI_INT, MPI_MAX, world);
  has_any_ = found_all[0] || found_all[1];
  if (!has_any_) return contacts_;

  slot_of_atom_.assign(atom->nlocal + atom->nghost, -1);
  slots_.clear();
  for (const Find &find : finds_) merge(find.node, find.contact);
  message_ = Message::Contacts;
  BiemCompat::reverse_comm(comm, pair_);
  for (biem::ContactSlots &slots : slots_)
    for (int k = 0; k < slots.size(); k++)
      if (slots[k].side < 0.0 && !surfaces.is_wall(slots[k].surface))
        slots[k].distance = -slots[k].distance;
  if (found_all[1]) decide_sides_at_walls();
  message_ = Message::Contacts;
  BiemCompat::forward_comm(comm, pair_);
  keep_winners();
  return contacts_;
}

void LammpsContacts::keep_winners()
{
  for (const Find &find : finds_) {
    const int slot = slot_of_atom_[find.node];
    const biem::Contact *winner =
        slot < 0 ? nullptr : slots_[slot].find(find.contact.surface);
    if (!winner || winner->triangle != find.contact.triangle) continue;
    const double sign = winner->distance < 0.0 ? -1.0 : 1.0;
    contacts_.push_back({find.node, find.triangle, find.weights, sign * find.contact.direction,
                         sign * find.contact.distance});
  }
}

// Mean unwrapped position of the nodes of each molecule, by its id.
biem::Points LammpsContacts::compute_centers()
{
  const auto n = static_cast<Eigen::Index>(surfaces.n_molecules()) + 1;
  Eigen::Matrix4Xd sums = Eigen::Matrix4Xd::Zero(4, n);
  for (int i = 0; i < atom->nlocal; i++) {
    if (!surfaces.is_body(atom->molecule[i])) continue;
    biem::Vec3 x;
    domain->unmap(atom->x[i], atom->image[i], x.data());
    sums.col(atom->molecule[i]) += Eigen::Vector4d(x[0], x[1], x[2], 1.0);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(4 * n), MPI_DOUBLE, MPI_SUM, world);
  return sums.topRows(3) * sums.row(3).cwiseMax(1.0).cwiseInverse().asDiagonal();
}

// A wall has no inside. A node is behind it if the wall lies between the node and the center of its
// body. Where the wall is curved, the center may be beyond the plane of the wall's triangle all the
// same; then the normal of the node, which points out of its body, tells: it points to the wall.
bool LammpsContacts::is_behind_wall(const biem::Contact &contact, const biem::Vec3 &normal,
                                    const biem::Vec3 &arm) const
{
  constexpr double kTowardsWall = -0.5;    // cosine: within 60 degrees of the wall's direction
  const bool is_center_behind = contact.direction.dot(arm) + contact.distance < 0.0;
  return is_center_behind && contact.direction.dot(normal) > kTowardsWall * normal.norm();
}

void LammpsContacts::decide_sides_at_walls()
{
  normals_.assign(3 * static_cast<size_t>(atom->nlocal + atom->nghost), 0.0);
  double **x = atom->x;
  for (int a = 0; a < neighbor->nanglelist; a++) {
    const int *t = neighbor->anglelist[a];
    if (!surfaces.is_body(atom->molecule[t[1]])) continue;
    const biem::Vec3 first(x[t[0]]);
    const biem::Vec3 normal =
        (biem::Vec3(x[t[1]]) - first).cross(biem::Vec3(x[t[2]]) - first);
    for (int k = 0; k < 3; k++)
      for (int c = 0; c < 3; c++) normals_[3 * t[k] + c] += normal[c];
  }
  message_ = Message::Normals;
  BiemCompat::reverse_comm(comm, pair_);
  const biem::Points centers = compute_centers();
  for (int i = 0; i < atom->nlocal; i++) {
    if (slot_of_atom_[i] < 0) continue;
    biem::Vec3 position;
    domain->unmap(x[i], atom->image[i], position.data());
    const biem::Vec3 arm = centers.col(atom->molecule[i]) - position;
    biem::ContactSlots &slots = slots_[slot_of_atom_[i]];
    for (int k = 0; k < slots.size(); k++)
      if (surfaces.is_wall(slots[k].surface) &&
          is_behind_wall(slots[k], biem::Vec3(&normals_[3 * i]), arm))
        slots[k].distance = -slots[k].distance;
  }
}

}    // namespace LAMMPS_NS
