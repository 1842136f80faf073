// Forces at positions between LAMMPS' steps: ghosts and neighbor lists as these positions need
// them, then what LAMMPS itself would compute. Knows no flow solver and no stepper.
#ifndef BIEM_LAMMPS_STAGE_FORCES_H
#define BIEM_LAMMPS_STAGE_FORCES_H

#include "lmptype.h"
#include "pointers.h"

namespace LAMMPS_NS {

class Fix;

class StageForces : protected Pointers {
 public:
  StageForces(LAMMPS *lmp, const Fix *own) : Pointers(lmp), own_(own) {}

  // list_reach: largest distance of a pair in any list, without skin.
  void start_run(double list_reach, double shear_rate);
  // LAMMPS has renewed its lists.
  void lists_are_new() { drift_ = elapsed_ = 0.0; }
  // All atoms have moved for a time, by up to distance besides the background shear. The same on
  // all ranks.
  void note_move(double distance, double elapsed);
  // The next update() renews the lists: atoms have been put elsewhere.
  void require_new_lists() { are_lists_lost_ = true; }

  // Ghosts to the positions of now. Where the lists may have lost a pair: atoms to the ranks that
  // own them, new lists (as Min::energy_force() does between steps); then returns true. Collective.
  bool update();
  void update_ghosts() const;
  // All forces but those of this fix; energies and virials are left to LAMMPS' own step.
  void compute() const;

  bigint n_rebuilds() const { return n_rebuilds_; }    // within steps, since start_run()

 private:
  void reneighbor() const;

  const Fix *own_;
  double list_reach_ = 0.0, shear_rate_ = 0.0;
  double drift_ = 0.0, elapsed_ = 0.0;    // since the last renewal
  bool are_lists_lost_ = false;
  bigint n_rebuilds_ = 0;
};

}    // namespace LAMMPS_NS

#endif
