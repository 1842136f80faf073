// Parameters of one periodic sum of a simulation: chosen once from the accuracy, kept through runs
// and restarts until what they depend on changes. Knows settings and points, no surfaces.
#ifndef BIEM_LAMMPS_PARAMETERS_H
#define BIEM_LAMMPS_PARAMETERS_H

#include "biem_lammps_settings.h"
#include "pointers.h"

namespace LAMMPS_NS {

class LammpsParameters : protected Pointers {
 public:
  LammpsParameters(LAMMPS *lmp, const FixBiemSettings &settings) :
      Pointers(lmp), settings_(settings)
  {
  }

  // scene: cell, tilt, sources, targets, bodies and layers; the rest is the user's. points: this
  // rank's, 3 x n, for tuning by search. Returns whether they are new. Collective. Throws Error if
  // the accuracy cannot be met.
  bool choose(biem::EwaldScene scene, biem::PointsView points);
  const biem::EwaldParameters &values() const { return values_; }

  static constexpr int kStateSize = 18;
  std::vector<double> get_state() const;
  void set_state(const double *state);

 private:
  bool is_still_valid(const biem::EwaldScene &scene) const;
  biem::EwaldParameters search(const biem::EwaldScene &scene, biem::PointsView points) const;

  FixBiemSettings settings_;
  biem::EwaldParameters values_;
  // Box lengths and layers that they were chosen for.
  biem::Vec3 lengths_ = biem::Vec3::Zero();
  biem::Layers layers_ = biem::Layers::Single;
};

}    // namespace LAMMPS_NS

#endif
