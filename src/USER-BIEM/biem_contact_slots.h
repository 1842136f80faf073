// The nearest points of other surfaces to one node, put together from finds of single triangles in
// any order and on any rank. Knows no positions, no law and no communication.
#ifndef BIEM_CONTACT_SLOTS_H
#define BIEM_CONTACT_SLOTS_H

#include "biem_types.h"

#include <array>
#include <cstdint>

namespace biem {

// Ids of atoms in rising order; where a feature has fewer than three, zeros come first.
using ContactIds = std::array<std::int64_t, 3>;

// The point of a surface nearest to a node, as one triangle sees it.
struct Contact {
  std::int64_t surface;     // id of the surface that is touched
  ContactIds feature;       // corner, edge or face that holds the nearest point
  ContactIds triangle;      // of the triangles around the feature the one with the smallest ids
  double distance;          // length; >= 0 until the sign is known
  // Sum over the triangles around the feature of their angle there times the cosine between their
  // normal and the direction: this is the angle-weighted pseudo-normal of Baerentzen & Aanaes, IEEE
  // Trans. Vis. Comput. Graph. 11, 243 (2005), along the direction. Negative: the node is inside.
  double side;
  Vec3 direction;    // from the nearest point to the node, unit vector
};

// Contact of the point p with the triangle, whose corners are in columns. The surface is set by the
// caller. ids: of the corners. weights: of the nearest point.
Contact make_contact(const Vec3 &p, const Mat3 &corners, const ContactIds &ids,
                     const Vec3 &weights);

// The nearest contacts of a node, one for each surface.
class ContactSlots {
 public:
  static constexpr int kCapacity = 4;

  // Keeps the contact if it is the nearest of its surface and, where there are more surfaces than
  // slots, one of the nearest of all. Every triangle is merged once. The result does not depend on
  // the order, but for rounding.
  void merge(const Contact &contact);

  int size() const { return size_; }
  Contact &operator[](int k) { return contacts_[k]; }
  const Contact &operator[](int k) const { return contacts_[k]; }
  const Contact *find(std::int64_t surface) const;    // null: none

  // Adds a contact as it is, to a slot that is free.
  void append(const Contact &contact) { contacts_[size_++] = contact; }

 private:
  int size_ = 0;
  std::array<Contact, kCapacity> contacts_;
};

}    // namespace biem

#endif
