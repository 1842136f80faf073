// Watches a run: positions that are not numbers, collapsed and folded triangles, strain beyond the
// limits, surfaces that cross; says what was found and what to change, and writes a restart file.
// Does not stop the run, and knows neither stepper nor flow.
#ifndef BIEM_LAMMPS_WATCHDOG_H
#define BIEM_LAMMPS_WATCHDOG_H

#include "biem_lammps_topology.h"
#include "biem_mesh_crossings.h"
#include "biem_mesh_watch.h"
#include "pointers.h"
#include <set>
#include <utility>

namespace LAMMPS_NS {

class LammpsWatchdog : protected Pointers {
 public:
  LammpsWatchdog(LAMMPS *lmp, const biem::WatchLimits &limits) : Pointers(lmp), limits_(limits) {}

  // Before every run, after the survey of the meshes and the angle styles' init. Surfaces that
  // cross already are not reported again. Collective.
  void prepare(const NodeGroups &groups);

  // Both need the current positions of owned and ghost atoms and the lists of angles and dihedrals
  // of the last reneighboring; return the worst finding, the same on all ranks, as a sentence
  // without step and full stop ("cell 3 ...: use ..."), or "". Collective.
  std::string check();
  std::string check_crossings();    // also of a step that is not a multiple of the interval

  // Writes the atoms as they are now to restart.biem.<step>; returns the name, or "" where nothing
  // was written because a position is not a number. The file says update->ntimestep, which the
  // caller sets. Leaves the atoms as they are. Collective.
  std::string write_restart(bigint step);

  const biem::WatchLimits &limits() const { return limits_; }

 private:
  struct Worst;

  void watch_positions(Worst &worst) const;
  void watch_triangles(Worst &worst);
  void watch_hinges(Worst &worst) const;
  bool is_on_cell(int atom) const;
  double **find_reference() const;    // rows of owned and ghost atoms, or null
  std::vector<biem::SurfaceTriangle> make_triangles() const;
  std::vector<biem::Crossing>
  find_crossings(const std::vector<biem::SurfaceTriangle> &triangles) const;
  std::string describe_worst(const Worst &worst) const;
  std::string describe_crossing(const biem::Crossing &crossing) const;
  std::string name_surface(int surface) const;

  biem::WatchLimits limits_;
  NodeGroups groups_;
  std::vector<int> group_of_surface_;    // index into the groups, by molecule id - 1; or -1
  bool has_reference_ = false;
  // Squared, of this rank's triangles at the last check; 0: there was none.
  double edge_stretch_ = 0.0, area_stretch_ = 0.0;
  std::set<std::pair<int, int>> known_crossings_;    // molecule ids - 1
};

}    // namespace LAMMPS_NS

#endif
