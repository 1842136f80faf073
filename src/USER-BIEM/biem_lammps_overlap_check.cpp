// Check of overlaps: see the header.
#include "biem_lammps_overlap_check.h"
#include "biem_lammps_atom_directory.h"
#include "biem_lammps_bridge.h"
#include "biem_lammps_compat.h"
#include "biem_lammps_crossing_search.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "update.h"
#include "utils.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace LAMMPS_NS {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A closed surface, and the point at which another one is, in the image that is near it.
struct Candidate {
  int outer, inner;
  biem::Vec3 point;
};

biem::SurfaceTriangle make_triangle(Domain *domain, const AtomRecord *corners,
                                    const NodeGroups &groups)
{
  biem::SurfaceTriangle t{};
  t.surface = static_cast<int>(corners[0].molecule) - 1;
  t.is_sheet = groups.kind(corners[0].mask) == biem::SurfaceKind::Wall;
  for (int k = 0; k < 3; k++)
    for (int a = 0; a < 3; a++)
      t.corners[3 * k + a] = corners[k].x[a];
  for (int k = 1; t.is_sheet && k < 3; k++) {    // walls cross the box: the closest images
    biem::Vec3 d = t.corner(k) - t.corner(0);
    BiemCompat::minimum_image(domain, d.data());
    for (int a = 0; a < 3; a++)
      t.corners[3 * k + a] = t.corners[a] + d[a];
  }
  return t;
}

class OverlapCheck : protected Pointers {
 public:
  OverlapCheck(LAMMPS *lmp, const NodeGroups &groups, const MeshSurvey &survey) :
      Pointers(lmp), groups_(groups), survey_(survey), lattice_(get_cell(lmp)),
      triangles_(collect_triangles(lmp, groups))
  {
  }

  void check_crossings(RunStart start)
  {
    bool is_warned = false;
    for (const biem::Crossing &c :
         find_all_crossings(world, lattice_, survey_.longest_mean_edge, triangles_)) {
      const bool is_allowed = start == RunStart::Continued && is_free(c.first) && is_free(c.second);
      if (is_allowed && is_warned) continue;
      const std::string text = describe_crossing(c);
      if (!is_allowed) error->all(FLERR, text);
      if (comm->me == 0) error->warning(FLERR, text);
      is_warned = true;
    }
  }

  void check_nesting()
  {
    const std::vector<Candidate> candidates = find_candidates();
    if (candidates.empty()) return;
    std::vector<double> angles(candidates.size(), 0.0);
    std::vector<std::vector<int>> of_surface(survey_.n_molecules);
    for (size_t c = 0; c < candidates.size(); c++)
      of_surface[candidates[c].outer].push_back(static_cast<int>(c));
    for (const biem::SurfaceTriangle &t : triangles_)
      for (int c : of_surface[t.surface])
        angles[c] += biem::compute_solid_angle(t, candidates[c].point);
    MPI_Allreduce(MPI_IN_PLACE, angles.data(), static_cast<int>(angles.size()), MPI_DOUBLE, MPI_SUM,
                  world);
    for (size_t c = 0; c < candidates.size(); c++)
      if (std::fabs(angles[c]) > 2.0 * M_PI) report_nesting(candidates[c]);
  }

 private:
  const SurfaceGroup &group_of(int surface) const
  {
    return groups_.surfaces[survey_.group[surface]];
  }
  bool is_free(int surface) const
  {
    const SurfaceGroup &g = group_of(surface);
    return g.kind == biem::SurfaceKind::Cell && g.viscosity_ratio == 1.0;
  }
  std::string name(int surface) const
  {
    return describe(group_of(surface).kind) + " " + std::to_string(surface + 1);
  }

  // Closed surfaces whose box holds a point of another, smaller one, or of a wall.
  std::vector<Candidate> find_candidates() const
  {
    const int n = survey_.n_molecules;
    // By surface: lower and negative upper corner of its box.
    std::vector<double> box(6 * n, kInfinity);
    for (const biem::SurfaceTriangle &t : triangles_)
      for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) {
          double *b = &box[6 * t.surface + a];
          b[0] = std::min(b[0], t.corners[3 * k + a]);
          b[3] = std::min(b[3], -t.corners[3 * k + a]);
        }
    MPI_Allreduce(MPI_IN_PLACE, box.data(), 6 * n, MPI_DOUBLE, MPI_MIN, world);
    const std::vector<biem::Vec3> points = choose_points();
    std::vector<Candidate> candidates;
    for (int outer = 0; outer < n; outer++) {
      if (survey_.group[outer] < 0 || group_of(outer).kind == biem::SurfaceKind::Wall) continue;
      const Eigen::Map<const biem::Vec3> low(&box[6 * outer]), minus_high(&box[6 * outer + 3]);
      const biem::Vec3 center = 0.5 * (low - minus_high), half = -0.5 * (low + minus_high);
      for (int inner = 0; inner < n; inner++) {
        if (inner == outer || survey_.group[inner] < 0 || (is_free(outer) && is_free(inner)) ||
            survey_.volumes[inner] >= survey_.volumes[outer])
          continue;
        lattice_.for_each_image(points[inner] - center, half.norm(), [&](const biem::Vec3 &d) {
          if ((d.array().abs() <= half.array()).all())
            candidates.push_back({outer, inner, center + d});
        });
      }
    }
    return candidates;
  }

  // By surface: one of its nodes.
  std::vector<biem::Vec3> choose_points() const
  {
    const int n = survey_.n_molecules;
    std::vector<int> rank(n, -1);
    for (const biem::SurfaceTriangle &t : triangles_)
      rank[t.surface] = comm->me;
    MPI_Allreduce(MPI_IN_PLACE, rank.data(), n, MPI_INT, MPI_MAX, world);
    std::vector<biem::Vec3> points(n, biem::Vec3::Zero());
    for (const biem::SurfaceTriangle &t : triangles_)
      if (rank[t.surface] == comm->me) points[t.surface] = t.corner(0);
    MPI_Allreduce(MPI_IN_PLACE, points[0].data(), 3 * n, MPI_DOUBLE, MPI_SUM, world);
    return points;
  }

  std::string advice() const
  {
    return "; surfaces must not touch or overlap at the start of a run: move or remove one of "
           "them, or enlarge the box; if an earlier run has brought them together, repeat it with "
           "a smaller timestep or a finer mesh";
  }

  std::string describe_crossing(const biem::Crossing &c) const
  {
    double where[3] = {c.where[0], c.where[1], c.where[2]};
    domain->remap(where);
    const std::string other = c.first == c.second ? "its own periodic image" : name(c.second);
    return fmt::format("Fix biem: step {}: the surfaces of {} and {} (molecule ids) cross near "
                       "({:.4g}, {:.4g}, {:.4g}){}",
                       update->ntimestep, name(c.first), other, where[0], where[1], where[2],
                       advice());
  }

  void report_nesting(const Candidate &c)
  {
    biem::Vec3 where = c.point;
    domain->remap(where.data());
    error->all(FLERR, fmt::format("Fix biem: step {}: {} lies inside {} (molecule ids), near "
                                  "({:.4g}, {:.4g}, {:.4g}){}",
                                  update->ntimestep, name(c.inner), name(c.outer), where[0],
                                  where[1], where[2], advice()));
  }

  const NodeGroups &groups_;
  const MeshSurvey &survey_;
  biem::MeshLattice lattice_;
  std::vector<biem::SurfaceTriangle> triangles_;    // of this rank
};

}    // namespace

std::vector<biem::SurfaceTriangle> collect_triangles(LAMMPS *lmp, const NodeGroups &groups)
{
  int64_t missing;    // the survey has looked
  const std::vector<AtomRecord> corners = AtomDirectory(lmp).look_up_corners(missing);
  std::vector<biem::SurfaceTriangle> triangles;
  for (size_t t = 0; t < corners.size(); t += 3)
    triangles.push_back(make_triangle(lmp->domain, &corners[t], groups));
  return triangles;
}

void check_overlaps(LAMMPS *lmp, const NodeGroups &groups, const MeshSurvey &survey, RunStart start)
{
  if (survey.n_triangles == 0) return;
  OverlapCheck check(lmp, groups, survey);
  check.check_crossings(start);
  check.check_nesting();
}

}    // namespace LAMMPS_NS
