// Sheared periodic box: see the header.
#include "biem_lammps_sheared_box.h"
#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fmt/format.h"
#include "irregular.h"
#include "update.h"
#include <cmath>

namespace LAMMPS_NS {

ShearedBox::~ShearedBox()
{
  if (is_sheared()) domain->h_rate[4] = 0.0;
}

// Counts from here on: the state is that of this step.
void ShearedBox::rebase(bigint step, double dt)
{
  base_tilt_ = tilt_;
  base_strain_ = strain_;
  base_step_ = last_step_ = step;
  base_dt_ = dt;
  base_rate_ = rate_;
}

void ShearedBox::start()
{
  if (!is_sheared()) return;
  const double tilt_per_step = rate_ * domain->zprd * update->dt;
  if (std::fabs(tilt_per_step) > 0.5 * domain->xprd)
    error->all(FLERR, fmt::format("Fix biem: timestep {:.6g} shears the box by {:.4g}, more than "
                                  "half of its length {:.4g}; use a smaller timestep",
                                  update->dt, tilt_per_step, domain->xprd));
  domain->h_rate[4] = rate_ * domain->zprd;    // LAMMPS' record of how fast xz changes
  const double offset = (tilt_ - domain->xz) / domain->xprd;
  const bool is_same_box = is_started_ && std::fabs(offset - std::round(offset)) < 1e-9;
  if (is_same_box && base_dt_ == update->dt && base_rate_ == rate_ &&
      last_step_ == update->ntimestep)
    return;
  if (!is_same_box) tilt_ = domain->xz;
  is_started_ = true;
  rebase(update->ntimestep, update->dt);
}

void ShearedBox::begin_step(double dt)
{
  if (is_sheared() && dt != base_dt_) rebase(update->ntimestep - 1, dt);
}

bool ShearedBox::advance(double fraction)
{
  if (!is_sheared()) return false;
  const double length = domain->xprd;
  const double n_steps = static_cast<double>(update->ntimestep - 1 - base_step_) + fraction;
  const double run_strain = rate_ * n_steps * base_dt_;
  strain_ = base_strain_ + run_strain;
  tilt_ = base_tilt_ + domain->zprd * run_strain;
  last_step_ = update->ntimestep;
  domain->xz = tilt_ - length * std::round((tilt_ - domain->xz) / length);
  domain->set_global_box();
  domain->set_local_box();
  return std::fabs(domain->xz) > 0.5 * length;
}

void ShearedBox::flip_if_needed()
{
  const double length = domain->xprd;
  if (!is_sheared() || std::fabs(domain->xz) <= 0.5 * length) return;
  const int n = domain->xz > 0.0 ? -1 : 1;
  domain->xz += n * length;
  domain->set_global_box();
  domain->set_local_box();
  domain->image_flip(0, n, 0);
  for (int i = 0; i < atom->nlocal; i++)
    domain->remap(atom->x[i], atom->image[i]);
  // Atoms change the box coordinate by up to one half, further than comm->exchange() reaches.
  domain->x2lamda(atom->nlocal);
  Irregular irregular(lmp);
  irregular.migrate_atoms();
  domain->lamda2x(atom->nlocal);
  n_flips_++;
}

std::vector<double> ShearedBox::get_state() const
{
  return {base_tilt_,
          base_dt_,
          base_strain_,
          static_cast<double>(base_step_),
          tilt_,
          strain_,
          static_cast<double>(last_step_),
          static_cast<double>(n_flips_),
          base_rate_};
}

void ShearedBox::set_state(const double *state)
{
  base_tilt_ = state[0];
  base_dt_ = state[1];
  base_strain_ = state[2];
  base_step_ = static_cast<bigint>(state[3]);
  tilt_ = state[4];
  strain_ = state[5];
  last_step_ = static_cast<bigint>(state[6]);
  n_flips_ = static_cast<bigint>(state[7]);
  base_rate_ = state[8];
  is_started_ = base_dt_ > 0.0;
}

}    // namespace LAMMPS_NS
