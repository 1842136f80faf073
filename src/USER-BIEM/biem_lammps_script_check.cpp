// Checks of the input script: see the header.
#include "biem_lammps_script_check.h"
#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "pointers.h"
#include "update.h"
#include "utils.h"
#include <algorithm>
#include <cstring>
#include <string>

namespace LAMMPS_NS {

namespace {

class ScriptCheck : protected Pointers {
 public:
  ScriptCheck(LAMMPS *lmp, const Fix *fix) : Pointers(lmp), fix_(fix) {}

  void check_system()
  {
    if (!(update->dt > 0.0))
      error->all(FLERR, "Fix biem: timestep " + std::to_string(update->dt) + " must be positive");
    if (!force->newton_bond)
      error->all(FLERR, "Fix biem: 'newton on' is required, so that each triangle is on one rank");
    if (domain->dimension != 3 || !domain->xperiodic || !domain->yperiodic || !domain->zperiodic)
      error->all(FLERR, "Fix biem: the box must be three-dimensional and periodic: boundary p p p");
    if (utils::strmatch(update->integrate_style, "^respa"))
      error->all(FLERR, "Fix biem: run_style respa is not supported; use run_style verlet");
    if (neighbor->nex_type || neighbor->nex_group || neighbor->nex_mol)
      error->all(FLERR,
                 "Fix biem: 'neigh_modify exclude' would hide near pairs of nodes; remove it");
    if (atom->nbonds > 0)
      error->all(FLERR,
                 "Fix biem: the system has bonds, which take pairs out of the neighbor list; "
                 "meshes need angles and dihedrals only");
    check_angles();
    if (!neighbor->dist_check)
      error->all(FLERR,
                 "Fix biem: 'neigh_modify check yes' is required, so that neighbor lists are "
                 "renewed when the box shears");
    if (neighbor->every != 1 || neighbor->delay != 0) {
      if (comm->me == 0)
        utils::logmesg(lmp,
                       "Fix biem: sets 'neigh_modify every 1 delay 0': the box shears in every "
                       "step\n");
      neighbor->every = 1;
      neighbor->delay = 0;
    }
  }

  // LAMMPS hands over the triangles (angles) only where it has an angle style for them.
  void check_angles()
  {
    if (atom->nangles > 0 && !force->angle)
      error->all(FLERR,
                 "Fix biem: the triangles (angles) need an angle style: use 'angle_style "
                 "biem/skalak' for membranes, 'angle_style zero' where there are only rigid "
                 "particles and walls, or 'angle_style hybrid biem/skalak zero' for both");
    tagint off = MAXTAGINT, smallest;
    for (int i = 0; i < atom->nlocal; i++)
      for (int a = 0; a < atom->num_angle[i]; a++)
        if (atom->angle_type[i][a] <= 0) off = std::min(off, atom->tag[i]);
    MPI_Allreduce(&off, &smallest, 1, MPI_LMP_TAGINT, MPI_MIN, world);
    if (smallest < MAXTAGINT)
      error->all(FLERR, "Fix biem: a triangle (angle) of atom " + std::to_string(smallest) +
                            " is turned off; remove the command that does this (delete_bonds, "
                            "fix shake)");
  }

  void check_other_fixes()
  {
    bool is_later = false;
    for (int i = 0; i < modify->nfix; i++) {
      const Fix *other = modify->fix[i];
      if (other == fix_) {
        is_later = true;
        continue;
      }
      if (strcmp(other->style, fix_->style) == 0)
        error->all(FLERR,
                   std::string("Fix biem: only one fix of this kind can be defined, but there "
                               "are '") +
                       fix_->id + "' and '" + other->id + "'");
      if (other->time_integrate)
        error->all(FLERR, std::string("Fix biem: fix ") + other->id + " (" + other->style +
                              ") also moves atoms; remove it, the Stokes flow has no inertia");
      if (other->box_change & ~Fix::BOX_CHANGE_DOMAIN)
        error->all(FLERR,
                   std::string("Fix biem: fix ") + other->id + " (" + other->style +
                       ") changes the box; fix biem owns the tilt of the sheared box itself");
      if (is_later && (modify->fmask[i] & FixConst::POST_FORCE))
        error->all(FLERR,
                   std::string("Fix biem: fix ") + other->id + " (" + other->style +
                       ") changes forces after they have been turned into velocities; define it "
                       "before fix biem");
    }
  }

 private:
  const Fix *fix_;
};

}    // namespace

void check_script(LAMMPS *lmp, const Fix *fix)
{
  ScriptCheck check(lmp, fix);
  check.check_system();
  check.check_other_fixes();
}

}    // namespace LAMMPS_NS
