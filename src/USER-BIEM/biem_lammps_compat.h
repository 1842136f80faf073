// One interface for LAMMPS 29Sep2021 ... 4Jul2026.  No version numbers: which of two forms a LAMMPS
// has is found by overload resolution (choice<1> goes before choice<0>), so a distribution's
// snapshot between two versions compiles as well.  C++11.  Knows no physics.
#ifndef BIEM_LAMMPS_COMPAT_H
#define BIEM_LAMMPS_COMPAT_H

#include "comm.h"
#include "compute.h"
#include "domain.h"
#include "fix.h"
#include "neigh_request.h"
#include "neighbor.h"

namespace LAMMPS_NS {
namespace BiemCompat {

template <int n> struct choice : choice<n - 1> {};
template <> struct choice<0> {};

namespace detail {

// 2022: forward_comm_fix(fix), forward_comm_compute(compute) became forward_comm(fix or compute).
template <class C, class T>
auto forward(C *comm, T *owner, int size, choice<1>)
    -> decltype(comm->forward_comm(owner, size), void())
{
  comm->forward_comm(owner, size);
}
template <class C> void forward(C *comm, Fix *owner, int size, choice<0>)
{
  comm->forward_comm_fix(owner, size);
}
template <class C> void forward(C *comm, Compute *owner, int, choice<0>)
{
  comm->forward_comm_compute(owner);
}

template <class C, class T>
auto reverse(C *comm, T *owner, int size, choice<1>)
    -> decltype(comm->reverse_comm(owner, size), void())
{
  comm->reverse_comm(owner, size);
}
template <class C> void reverse(C *comm, Fix *owner, int size, choice<0>)
{
  comm->reverse_comm_fix(owner, size);
}
template <class C> void reverse(C *comm, Compute *owner, int, choice<0>)
{
  comm->reverse_comm_compute(owner);
}

// 2025: minimum_image() takes the place of the call first, for its error messages.
template <class D>
auto minimum_image(D *domain, double *d, choice<1>)
    -> decltype(domain->minimum_image(d[0], d[1], d[2]), void())
{
  domain->minimum_image(d[0], d[1], d[2]);
}
template <class D> void minimum_image(D *domain, double *d, choice<0>)
{
  domain->minimum_image(__FILE__, __LINE__, d[0], d[1], d[2]);
}

// 2022: request(ptr) with fields set afterwards became add_request(ptr, flags).
template <class N, class T>
auto request_full_list(N *neighbor, T *owner, int, double cutoff, choice<1>)
    -> decltype(neighbor->add_request(owner, 0), void())
{
  enum { FULL = 1 };    // NeighConst::REQ_FULL, a name that 29Sep2021 does not have
  auto *request = neighbor->add_request(owner, FULL);
  if (cutoff > 0.0) request->set_cutoff(cutoff);
}
template <class N>
void request_full_list(N *neighbor, Fix *owner, int instance, double cutoff, choice<0>)
{
  // Two statements: requests[request()] would read the array's address before request() moves it.
  const int index = neighbor->request(owner, instance);
  auto *request = neighbor->requests[index];
  request->pair = 0;
  request->fix = 1;
  request->half = 0;
  request->full = 1;
  if (cutoff > 0.0) {
    request->cut = 1;
    request->cutoff = cutoff + neighbor->skin;    // 29Sep2021 does not add the skin itself
  }
}

}    // namespace detail

// Owned values to their ghosts; size = values per atom if fewer than comm_forward, else 0.
template <class T> void forward_comm(Comm *comm, T *owner, int size = 0)
{
  detail::forward(comm, owner, size, choice<1>());
}

// Ghosts' values added to their owners.
template <class T> void reverse_comm(Comm *comm, T *owner, int size = 0)
{
  detail::reverse(comm, owner, size, choice<1>());
}

// d: difference of two positions, 3 values, replaced by the shortest periodic image.
inline void minimum_image(Domain *domain, double *d)
{
  detail::minimum_image(domain, d, choice<1>());
}

// Full neighbor list for a fix, rebuilt by LAMMPS; cutoff without the skin (0: that of the pairs).
inline void request_full_list(Neighbor *neighbor, Fix *owner, int instance, double cutoff)
{
  detail::request_full_list(neighbor, owner, instance, cutoff, choice<1>());
}

}    // namespace BiemCompat
}    // namespace LAMMPS_NS

#endif
