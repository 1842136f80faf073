// compute biem/cell: shape, motion, energy and stresslet of each cell, one row per molecule ID.
// Knows how to gather sums over triangles; the shape that follows is in biem_mesh_moments.
#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(biem/cell,ComputeBiemCell);
// clang-format on
#else

#ifndef LMP_COMPUTE_BIEM_CELL_H
#define LMP_COMPUTE_BIEM_CELL_H

#include "compute.h"

#include <vector>

namespace LAMMPS_NS {

class ComputeBiemCell : public Compute {
 public:
  ComputeBiemCell(class LAMMPS *, int, char **);
  ~ComputeBiemCell() override;
  void init() override;
  void compute_array() override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;
  double memory_usage() override;

 protected:
  struct Sums;                       // what is added up per cell, over triangles and nodes
  class Angle *skalak;               // angle style biem/skalak, or null
  class DihedralBiemBend *bend;      // dihedral style biem/bend, or null
  class Fix *flow;                   // fix biem, or null
  double **values;                   // rows by molecule ID, columns as documented
  std::vector<double> origin;        // 3 per molecule, near the cell, so that no digits cancel
  std::vector<double> node_area;     // a third of the adjacent triangles; owned and ghost atoms
  int is_first;                      // since init()

  tagint find_last_molecule();
  void check_group();
  void compute_origins();
  void add_triangles(std::vector<Sums> &);
  void add_hinges(std::vector<Sums> &);
  void add_nodes(std::vector<Sums> &);
  void check_image_flags(const int *);
  void publish(const Sums &, tagint);
  void replace_stresslet(tagint, double *);
};

}    // namespace LAMMPS_NS

#endif
#endif
