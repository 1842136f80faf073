// One interface for LAMMPS 29Sep2021 ... 4Jul2026.  No version numbers: which of two forms a LAMMPS
// has is found by overload resolution (choice<1> goes before choice<0>), so a distribution's
// snapshot between two versions compiles as well.  C++11.  Knows no physics.
// clang-format off: bodies of one statement are on one line
#ifndef BIEM_LAMMPS_COMPAT_H
#define BIEM_LAMMPS_COMPAT_H

#include "comm.h"
#include "compute.h"
#include "domain.h"
#include "fix.h"
#include "neigh_request.h"
#include "neighbor.h"
#include "pair.h"

namespace LAMMPS_NS {
namespace BiemCompat {

template <int n> struct choice : choice<n - 1> {};
template <> struct choice<0> {};

namespace detail {

// 2022: forward_comm_fix(fix), forward_comm_compute(compute), forward_comm_pair(pair) became
// forward_comm(fix, compute or pair).
template <class C, class T>
auto forward(C *comm, T *owner, int size, choice<1>)
    -> decltype(comm->forward_comm(owner, size), void())
{ comm->forward_comm(owner, size); }
template <class C> void forward(C *comm, Fix *owner, int size, choice<0>)
{ comm->forward_comm_fix(owner, size); }
template <class C> void forward(C *comm, Compute *owner, int, choice<0>)
{ comm->forward_comm_compute(owner); }
template <class C> void forward(C *comm, Pair *owner, int, choice<0>)
{ comm->forward_comm_pair(owner); }

template <class C, class T>
auto reverse(C *comm, T *owner, int size, choice<1>)
    -> decltype(comm->reverse_comm(owner, size), void())
{ comm->reverse_comm(owner, size); }
template <class C> void reverse(C *comm, Fix *owner, int size, choice<0>)
{ comm->reverse_comm_fix(owner, size); }
template <class C> void reverse(C *comm, Compute *owner, int, choice<0>)
{ comm->reverse_comm_compute(owner); }
template <class C> void reverse(C *comm, Pair *owner, int, choice<0>)
{ comm->reverse_comm_pair(owner); }

// 2025: minimum_image() takes the place of the call first, for its error messages.
template <class D>
auto minimum_image(D *domain, double *d, choice<1>)
    -> decltype(domain->minimum_image(d[0], d[1], d[2]), void())
{ domain->minimum_image(d[0], d[1], d[2]); }
template <class D> void minimum_image(D *domain, double *d, choice<0>)
{ domain->minimum_image(__FILE__, __LINE__, d[0], d[1], d[2]); }

// 2022: request(ptr) with fields set afterwards became add_request(ptr, flags).
template <class N, class T>
auto request_full_list(N *neighbor, T *owner, int, double cutoff, choice<1>)
    -> decltype(neighbor->add_request(owner, 0), void())
{
  enum { FULL = 1 };    // NeighConst::REQ_FULL, a name that 29Sep2021 does not have
  auto *request = neighbor->add_request(owner, FULL);
  if (cutoff > 0.0) request->set_cutoff(cutoff);
}
inline int is_pair(const Pair *) { return 1; }
inline int is_pair(const Fix *) { return 0; }
template <class N, class T>
void request_full_list(N *neighbor, T *owner, int instance, double cutoff, choice<0>)
{
  // Two statements: requests[request()] would read the array's address before request() moves it.
  const int index = neighbor->request(owner, instance);
  auto *request = neighbor->requests[index];
  request->pair = is_pair(owner);
  request->fix = !is_pair(owner);
  request->half = 0;
  request->full = 1;
  if (cutoff > 0.0) {
    request->cut = 1;
    request->cutoff = cutoff + neighbor->skin;    // 29Sep2021 does not add the skin itself
  }
}

// 2025: MPI-IO files and the flag for them are gone.
template <class W>
auto choose_one_file(W &writer, choice<1>)
    -> decltype(writer.multiproc_options(0, 0, nullptr), void())
{ writer.multiproc_options(0, 0, nullptr); }
template <class W> void choose_one_file(W &writer, choice<0>)
{ writer.multiproc_options(0, 0, 0, nullptr); }

}    // namespace detail

// Owned values to their ghosts; size = values per atom if fewer than comm_forward, else 0.
template <class T> void forward_comm(Comm *comm, T *owner, int size = 0)
{ detail::forward(comm, owner, size, choice<1>()); }

// Ghosts' values added to their owners.
template <class T> void reverse_comm(Comm *comm, T *owner, int size = 0)
{ detail::reverse(comm, owner, size, choice<1>()); }

// d: difference of two positions, 3 values, replaced by the shortest periodic image.
inline void minimum_image(Domain *domain, double *d)
{ detail::minimum_image(domain, d, choice<1>()); }

// Full neighbor list for a fix or pair style, rebuilt by LAMMPS; cutoff without the skin (0: that
// of the pairs).
template <class T>
void request_full_list(Neighbor *neighbor, T *owner, int instance, double cutoff = 0.0)
{ detail::request_full_list(neighbor, owner, instance, cutoff, choice<1>()); }

// writer: a WriteRestart, which its function write() needs before: one file for all ranks.
template <class W> void choose_one_file(W &writer)
{ detail::choose_one_file(writer, choice<1>()); }

}    // namespace BiemCompat
}    // namespace LAMMPS_NS

#endif
