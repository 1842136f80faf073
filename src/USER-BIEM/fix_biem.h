#ifdef FIX_CLASS
// clang-format off
FixStyle(biem,FixBiem);
// clang-format on
#else

#ifndef LMP_FIX_BIEM_H
#define LMP_FIX_BIEM_H

#include "fix.h"

namespace LAMMPS_NS {

// Moves membranes and tracers with the Stokes flow that the membrane forces and the background flow
// cause; owns the tilt of a sheared box. Parses, calls the core, publishes; see doc/fix_biem.md.
class FixBiem : public Fix {
 public:
  FixBiem(class LAMMPS *, int, char **);
  ~FixBiem() override;
  int setmask() override;
  void init() override;
  void init_list(int, class NeighList *) override;
  void setup(int) override;
  void initial_integrate(int) override;
  void pre_exchange() override;
  void post_force(int) override;
  void post_run() override;
  void reset_dt() override;
  double compute_scalar() override;
  double compute_vector(int) override;
  double compute_array(int, int) override;
  double memory_usage() override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;

 private:
  struct Impl;
  Impl *impl;
  double **array;    // per atom: velocity, traction, area (published), then the history

  void publish();
  void check_volumes();
};

}    // namespace LAMMPS_NS

#endif
#endif
