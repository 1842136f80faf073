// Sheared periodic box: see the header.
#include "biem_lammps_sheared_box.h"
#include "atom.h"
#include "domain.h"
#include "irregular.h"
#include "update.h"
#include <cmath>

namespace LAMMPS_NS {

ShearedBox::~ShearedBox()
{
  if (is_sheared()) domain->h_rate[4] = 0.0;
}

double ShearedBox::run_strain() const
{
  if (base_step_ < 0) return 0.0;
  return rate_ * static_cast<double>(update->ntimestep - base_step_) * base_dt_;
}

double ShearedBox::unflipped_tilt() const
{
  return base_tilt_ + domain->zprd * run_strain();
}
double ShearedBox::strain() const
{
  return base_strain_ + run_strain();
}

void ShearedBox::start()
{
  if (!is_sheared()) return;
  domain->h_rate[4] = rate_ * domain->zprd;    // LAMMPS' record of how fast xz changes
  const bool is_started = base_step_ >= 0;
  const double tilt = is_started ? unflipped_tilt() : domain->xz;
  const double offset = (tilt - domain->xz) / domain->xprd;
  const bool is_same_box = std::fabs(offset - std::round(offset)) < 1e-9;
  if (is_started && is_same_box && base_dt_ == update->dt) return;
  base_strain_ = strain();
  base_tilt_ = is_same_box ? tilt : domain->xz;
  base_step_ = update->ntimestep;
  base_dt_ = update->dt;
}

bool ShearedBox::advance()
{
  if (!is_sheared()) return false;
  const double length = domain->xprd, tilt = unflipped_tilt();
  domain->xz = tilt - length * std::round((tilt - domain->xz) / length);
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
  return {base_tilt_, base_dt_, base_strain_, static_cast<double>(base_step_),
          static_cast<double>(n_flips_)};
}

void ShearedBox::set_state(const double *state)
{
  base_tilt_ = state[0];
  base_dt_ = state[1];
  base_strain_ = state[2];
  base_step_ = static_cast<bigint>(state[3]);
  n_flips_ = static_cast<bigint>(state[4]);
}

}    // namespace LAMMPS_NS
