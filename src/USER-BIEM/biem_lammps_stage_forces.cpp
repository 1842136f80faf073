// Forces between LAMMPS' steps: see the header.
#include "biem_lammps_stage_forces.h"
#include "angle.h"
#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "dihedral.h"
#include "domain.h"
#include "fix.h"
#include "force.h"
#include "improper.h"
#include "modify.h"
#include "neighbor.h"
#include "pair.h"
#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

void StageForces::start_run(double list_reach, double shear_rate)
{
  list_reach_ = list_reach;
  shear_rate_ = std::fabs(shear_rate);
  n_rebuilds_ = 0;
  are_lists_lost_ = false;
  lists_are_new();
}

void StageForces::note_move(double distance, double elapsed)
{
  drift_ += distance;
  elapsed_ += std::fabs(elapsed);
}

// Two atoms come closer by twice the drift, and by what the background shear moves them against
// each other. The displacement of single atoms and of the box, which LAMMPS looks at, is larger.
bool StageForces::update()
{
  const double reach = list_reach_ + neighbor->skin;
  const bool is_valid = 2.0 * drift_ + shear_rate_ * elapsed_ * reach <= neighbor->skin;
  if (is_valid && !are_lists_lost_) {
    update_ghosts();
    return false;
  }
  reneighbor();
  n_rebuilds_++;
  are_lists_lost_ = false;
  lists_are_new();
  return true;
}

void StageForces::update_ghosts() const
{
  comm->forward_comm();
}

// The order of Verlet::run().
void StageForces::reneighbor() const
{
  if (modify->n_pre_exchange) modify->pre_exchange();
  if (domain->triclinic) domain->x2lamda(atom->nlocal);
  domain->pbc();
  if (domain->box_change) {
    domain->reset_box();
    comm->setup();
    if (neighbor->style) neighbor->setup_bins();
  }
  comm->exchange();
  comm->borders();
  if (domain->triclinic) domain->lamda2x(atom->nlocal + atom->nghost);
  if (modify->n_pre_neighbor) modify->pre_neighbor();
  neighbor->build(1);
  if (modify->n_post_neighbor) modify->post_neighbor();
}

void StageForces::compute() const
{
  const int n = force->newton ? atom->nlocal + atom->nghost : atom->nlocal;
  if (n > 0) std::fill_n(atom->f[0], 3 * static_cast<ptrdiff_t>(n), 0.0);
  auto call_others = [&](int mask, void (Fix::*function)(int)) {
    for (int i = 0; i < modify->nfix; i++)
      if (modify->fix[i] != own_ && (modify->fmask[i] & mask)) (modify->fix[i]->*function)(0);
  };
  call_others(FixConst::PRE_FORCE, &Fix::pre_force);
  if (force->pair && force->pair->compute_flag) force->pair->compute(0, 0);
  if (force->bond) force->bond->compute(0, 0);
  if (force->angle) force->angle->compute(0, 0);
  if (force->dihedral) force->dihedral->compute(0, 0);
  if (force->improper) force->improper->compute(0, 0);
  if (force->newton) comm->reverse_comm();
  call_others(FixConst::POST_FORCE, &Fix::post_force);
}

}    // namespace LAMMPS_NS
