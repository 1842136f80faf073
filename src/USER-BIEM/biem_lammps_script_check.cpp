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
