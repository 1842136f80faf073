// Messages of LammpsContacts. Few nodes have contacts, so only these are sent: their number, then
// for each its position in the list of atoms and its contacts.
#include "atom.h"
#include "biem_lammps_contacts.h"
#include <algorithm>

namespace LAMMPS_NS {

namespace {

double *pack_contact(const biem::Contact &contact, double *buffer)
{
  *buffer++ = ubuf(contact.surface).d;
  for (const biem::ContactIds *ids : {&contact.feature, &contact.triangle})
    for (const std::int64_t id : *ids) *buffer++ = ubuf(id).d;
  *buffer++ = contact.distance;
  *buffer++ = contact.side;
  return std::copy_n(contact.direction.data(), 3, buffer);
}

const double *unpack_contact(const double *buffer, biem::Contact &contact)
{
  contact.surface = ubuf(*buffer++).i;
  for (biem::ContactIds *ids : {&contact.feature, &contact.triangle})
    for (std::int64_t &id : *ids) id = ubuf(*buffer++).i;
  contact.distance = *buffer++;
  contact.side = *buffer++;
  contact.direction = biem::Vec3(buffer);
  return buffer + 3;
}

// get_index(m): local index of the m-th atom of the message.
template <class Index>
int pack_contacts(int n, Index get_index, const std::vector<int> &slot_of_atom,
                  const std::vector<biem::ContactSlots> &slots, double *buffer)
{
  if (n == 0) return 0;
  double *end = buffer + 1;
  int n_nodes = 0;
  for (int m = 0; m < n; m++) {
    const int slot = slot_of_atom[get_index(m)];
    if (slot < 0) continue;
    n_nodes++;
    *end++ = ubuf(m).d;
    *end++ = ubuf(slots[slot].size()).d;
    for (int k = 0; k < slots[slot].size(); k++) end = pack_contact(slots[slot][k], end);
  }
  buffer[0] = ubuf(n_nodes).d;
  return static_cast<int>(end - buffer);
}

// Calls take(m, contacts) for each node of the message.
template <class Taker> void unpack_contacts(int n, const double *buffer, Taker take)
{
  if (n == 0) return;
  auto n_nodes = ubuf(*buffer++).i;
  for (; n_nodes > 0; n_nodes--) {
    const int m = static_cast<int>(ubuf(*buffer++).i);
    const auto n_contacts = ubuf(*buffer++).i;
    biem::ContactSlots slots;
    for (int k = 0; k < n_contacts; k++) {
      biem::Contact contact;
      buffer = unpack_contact(buffer, contact);
      slots.append(contact);
    }
    take(m, slots);
  }
}

}    // namespace

int LammpsContacts::pack_reverse(int n, int first, double *buffer) const
{
  if (message_ == Message::Normals) {
    std::copy_n(&normals_[3 * first], 3 * n, buffer);
    return 3 * n;
  }
  return pack_contacts(n, [=](int m) { return first + m; }, slot_of_atom_, slots_, buffer);
}

void LammpsContacts::unpack_reverse(int n, const int *list, const double *buffer)
{
  if (message_ == Message::Normals) {
    for (int m = 0; m < n; m++)
      for (int c = 0; c < 3; c++) normals_[3 * list[m] + c] += *buffer++;
    return;
  }
  unpack_contacts(n, buffer, [&](int m, const biem::ContactSlots &received) {
    for (int k = 0; k < received.size(); k++) merge(list[m], received[k]);
  });
}

int LammpsContacts::pack_forward(int n, const int *list, double *buffer) const
{
  return pack_contacts(n, [=](int m) { return list[m]; }, slot_of_atom_, slots_, buffer);
}

void LammpsContacts::unpack_forward(int n, int first, const double *buffer)
{
  unpack_contacts(n, buffer, [&](int m, const biem::ContactSlots &received) {
    int &slot = slot_of_atom_[first + m];
    if (slot < 0) {
      slot = static_cast<int>(slots_.size());
      slots_.emplace_back();
    }
    slots_[slot] = received;
  });
}

}    // namespace LAMMPS_NS
