// dihedral_style biem/bend: bending of membranes whose edges (hinges) are LAMMPS dihedrals.
// Knows how many triangles a cell has; the law is in biem_membrane_bend.
#ifdef DIHEDRAL_CLASS
// clang-format off
DihedralStyle(biem/bend,DihedralBiemBend);
// clang-format on
#else

#ifndef LMP_DIHEDRAL_BIEM_BEND_H
#define LMP_DIHEDRAL_BIEM_BEND_H

#include "dihedral.h"

#include <vector>

namespace LAMMPS_NS {

class DihedralBiemBend : public Dihedral {
 public:
  DihedralBiemBend(class LAMMPS *);
  ~DihedralBiemBend() override;
  void compute(int, int) override;
  void coeff(int, char **) override;
  void init_style() override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;

  // Energy of the hinge i1-i2-i3-i4; local indices of the closest images.
  double compute_hinge_energy(int type, int i1, int i2, int i3, int i4);

 protected:
  double *bending_modulus;    // per dihedral type, energy
  double *angle;              // per dihedral type, beta0 in rad where it is a value
  int *angle_of_sphere;       // per dihedral type, 1 where beta0 is that of a sphere
  std::vector<double> sphere_angle;    // per molecule id, rad; 0 without triangles

  void allocate();
  void compute_sphere_angles();
  double find_angle(int type, int i2);
};

}    // namespace LAMMPS_NS

#endif
#endif
