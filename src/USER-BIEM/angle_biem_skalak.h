// angle_style biem/skalak: in-plane elasticity of membranes whose triangles are LAMMPS angles.
// Knows the reference shape as a per-atom property; the law is in biem_membrane_skalak.
#ifdef ANGLE_CLASS
// clang-format off
AngleStyle(biem/skalak,AngleBiemSkalak);
// clang-format on
#else

#ifndef LMP_ANGLE_BIEM_SKALAK_H
#define LMP_ANGLE_BIEM_SKALAK_H

#include "angle.h"

namespace LAMMPS_NS {

class AngleBiemSkalak : public Angle {
 public:
  AngleBiemSkalak(class LAMMPS *);
  ~AngleBiemSkalak() override;
  void compute(int, int) override;
  void coeff(int, char **) override;
  void init_style() override;
  double equilibrium_angle(int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;
  double single(int, int, int, int) override;

 protected:
  double *shear_modulus, *dilatation_modulus;    // per angle type, force/length

  void allocate();
  double **find_reference();
  void check_reference_set();
  void refuse_triangle(const char *what, int i1, int i2, int i3);
};

}    // namespace LAMMPS_NS

#endif
#endif
