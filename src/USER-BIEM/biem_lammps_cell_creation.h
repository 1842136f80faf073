// Between placed surface meshes and LAMMPS' atoms, angles and dihedrals: what is in the box
// already, room for topology, new atoms. Knows no shapes and no packing method.
#ifndef BIEM_LAMMPS_CELL_CREATION_H
#define BIEM_LAMMPS_CELL_CREATION_H

#include "biem_mesh_packing.h"
#include "biem_mesh_topology.h"
#include "lmptype.h"
#include "pointers.h"
#include <string>
#include <vector>

namespace LAMMPS_NS {

// One cell (or wall) in its own frame, ready for storage with LAMMPS' second atoms.
struct CellTemplate {
  biem::SurfaceMesh mesh;
  std::vector<biem::Hinge> hinges;
  biem::MiddleNodeLoad load;
};

// What every atom of the new cells has in common.
struct CellLabels {
  int type, angle_type, dihedral_type;
  int group_bits;           // besides all
  tagint first_molecule;    // of the first cell; the others follow
};

// All atoms and their angles, taken as triangles. On rank 0; empty on the others. Collective.
// command: the name with which messages begin.
biem::PackingObstacles gather_obstacles(LAMMPS *lmp, const std::string &command);

class CellCreation : protected Pointers {
 public:
  CellCreation(LAMMPS *lmp, const std::string &command) : Pointers(lmp), command_(command) {}

  // Room for the template's angles and dihedrals per atom, and for those of any cell or wall to
  // come: made where the box is empty, else an error with the keywords of create_box. Then the
  // property that stores the reference shape.
  void prepare(const CellTemplate &cell);

  // Adds the cells; atom IDs follow the largest existing one, cell by cell, node by node.
  // Returns the first new ID. The result does not depend on the number of ranks. Collective.
  tagint add(const CellTemplate &cell, const std::vector<biem::RigidPlacement> &placements,
             const CellLabels &labels);

 private:
  void prepare_topology(const CellTemplate &cell);
  void prepare_reference();
  bool is_owned(const double *x) const;
  void add_cell(const CellTemplate &cell, const biem::RigidPlacement &placement, tagint first_tag);
  void set_labels(const CellTemplate &cell, const CellLabels &labels, int first_local,
                  tagint first_tag);
  void set_topology(const CellTemplate &cell, const CellLabels &labels, tagint first_tag,
                    tagint n_cells);
  void update_counts(const CellTemplate &cell, bigint n_cells);

  std::string command_;
};

}    // namespace LAMMPS_NS

#endif
