// Watchdog of a run: see the header.
#include "biem_lammps_watchdog.h"
#include "atom.h"
#include "biem_lammps_bridge.h"
#include "biem_lammps_compat.h"
#include "biem_lammps_crossing_search.h"
#include "biem_lammps_overlap_check.h"
#include "comm.h"
#include "domain.h"
#include "fix.h"
#include "modify.h"
#include "neighbor.h"
#include "write_restart.h"
#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

namespace {

constexpr char kReference[] = "biem_reference";    // property and fix of the reference shape

// A stretch that grows by this factor from one check to the next is an instability of the stepper:
// the flow strains by dt times its rate in a step.
constexpr double kSuddenGrowth = 1.25;

enum class Finding { None, AreaStrain, EdgeStrain, Fold, Collapse, NotANumber };

bool is_finite(const double *x)
{
  return std::isfinite(x[0] + x[1] + x[2]);
}

}    // namespace

struct LammpsWatchdog::Worst {
  Finding finding = Finding::None;
  double excess = 0.0;    // orders findings of one kind
  double value = 0.0, last = 0.0;
  int atoms[4];

  void update(Finding f, double e, double v, const int *t, int n)
  {
    if (std::pair(f, e) <= std::pair(finding, excess)) return;
    finding = f;
    excess = e;
    value = v;
    std::copy_n(t, n, atoms);
  }
  // Orders all findings: their kind counts first.
  double compute_severity() const
  {
    return static_cast<int>(finding) + std::min(0.5, 1e-3 * excess);
  }
};

void LammpsWatchdog::prepare(const NodeGroups &groups)
{
  groups_ = groups;
  int flag, columns;
  const int fix = modify->find_fix(kReference);
  const int index = atom->find_custom(kReference, flag, columns);
  has_reference_ =
      index >= 0 && flag == 1 && columns == 3 && fix >= 0 && modify->fix[fix]->comm_border >= 3;
  edge_stretch_ = area_stretch_ = 0.0;
  int n = 0, n_all;
  for (int i = 0; i < atom->nlocal; i++)
    if (groups_.find_surface(atom->mask[i]) >= 0) n = std::max<int>(n, atom->molecule[i]);
  MPI_Allreduce(&n, &n_all, 1, MPI_INT, MPI_MAX, world);
  group_of_surface_.assign(n_all, -1);
  for (int i = 0; i < atom->nlocal; i++) {
    const int g = groups_.find_surface(atom->mask[i]);
    if (g >= 0) group_of_surface_[atom->molecule[i] - 1] = g;
  }
  MPI_Allreduce(MPI_IN_PLACE, group_of_surface_.data(), n_all, MPI_INT, MPI_MAX, world);
  known_crossings_.clear();
  if (limits_.crossing_interval == 0) return;
  for (const biem::Crossing &c : find_crossings(collect_triangles(lmp, groups_)))
    known_crossings_.insert({c.first, c.second});
}

double **LammpsWatchdog::find_reference() const
{
  if (!has_reference_) return nullptr;
  int flag, columns;
  return atom->darray[atom->find_custom(kReference, flag, columns)];
}

std::string LammpsWatchdog::check()
{
  Worst worst;
  watch_positions(worst);
  watch_triangles(worst);
  watch_hinges(worst);
  struct {
    double severity;
    int rank;
  } mine = {worst.compute_severity(), comm->me}, all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  if (all.severity == 0.0) return "";
  std::string text = comm->me == all.rank ? describe_worst(worst) : "";
  int size = static_cast<int>(text.size());
  MPI_Bcast(&size, 1, MPI_INT, all.rank, world);
  text.resize(size);
  MPI_Bcast(&text[0], size, MPI_CHAR, all.rank, world);
  return text;
}

void LammpsWatchdog::watch_positions(Worst &worst) const
{
  for (int i = 0; i < atom->nlocal; i++)
    if (!is_finite(atom->x[i])) worst.update(Finding::NotANumber, 1.0, 0.0, &i, 1);
}

void LammpsWatchdog::watch_triangles(Worst &worst)
{
  double **x = atom->x, **reference = find_reference();
  const double edge_limit = std::pow(limits_.edge_stretch, 2);
  const double area_limit = std::pow(limits_.area_stretch, 2);
  double largest_edge = 1.0, largest_area = 1.0;    // these four are squared
  for (int n = 0; n < neighbor->nanglelist; n++) {
    const int *t = neighbor->anglelist[n];
    if (!is_on_cell(t[1])) continue;
    const biem::TriangleMeasure now = biem::measure_triangle(x[t[0]], x[t[1]], x[t[2]]);
    if (now.is_collapsed())
      worst.update(Finding::Collapse, biem::kCollapsedQuality / now.compute_quality(),
                   now.compute_quality(), t, 3);
    if (!reference) continue;
    const biem::TriangleMeasure rest =
        biem::measure_triangle(reference[t[0]], reference[t[1]], reference[t[2]]);
    if (rest.is_collapsed()) continue;
    const biem::TriangleStrain strain = biem::compute_strain(rest, now);
    const double edge = strain.compute_edge_stretch(), area = strain.compute_area_stretch();
    largest_edge = std::max(largest_edge, edge);
    largest_area = std::max(largest_area, area);
    if (edge > edge_limit)
      worst.update(Finding::EdgeStrain, edge / edge_limit,
                   edge > strain.longest_edge ? strain.shortest_edge : strain.longest_edge, t, 3);
    if (area > area_limit) worst.update(Finding::AreaStrain, area / area_limit, strain.area, t, 3);
  }
  if (worst.finding == Finding::EdgeStrain || worst.finding == Finding::AreaStrain) {
    worst.value = std::sqrt(worst.value);
    worst.last = std::sqrt(worst.finding == Finding::EdgeStrain ? edge_stretch_ : area_stretch_);
  }
  edge_stretch_ = largest_edge;
  area_stretch_ = largest_area;
}

void LammpsWatchdog::watch_hinges(Worst &worst) const
{
  double **x = atom->x;
  for (int n = 0; n < neighbor->ndihedrallist; n++) {
    const int *t = neighbor->dihedrallist[n];
    if (!is_on_cell(t[1])) continue;
    if (!biem::is_folded(x[t[0]], x[t[1]], x[t[2]], x[t[3]], limits_.fold_cosine)) continue;
    const double cosine = biem::compute_fold_cosine(x[t[0]], x[t[1]], x[t[2]], x[t[3]]);
    worst.update(Finding::Fold, limits_.fold_cosine - cosine, cosine, t, 4);
  }
}

bool LammpsWatchdog::is_on_cell(int i) const
{
  const int g = group_of_surface_[atom->molecule[i] - 1];
  return groups_.surfaces[g].kind == biem::SurfaceKind::Cell;
}

// Names what was found, where, the value and the limit, and what to change.
std::string LammpsWatchdog::describe_worst(const Worst &worst) const
{
  const tagint *tag = atom->tag;
  const int *t = worst.atoms;
  // Angles and dihedrals are stored with their second atom, which is owned.
  const int node = worst.finding == Finding::NotANumber ? t[0] : t[1];
  std::string who = "atom " + std::to_string(tag[node]);
  if (groups_.find_surface(atom->mask[node]) >= 0)
    who = name_surface(static_cast<int>(atom->molecule[node]) - 1) + ", " + who;
  if (worst.finding == Finding::NotANumber)
    return fmt::format("{}: the position is not a number: use a smaller timestep, and check the "
                       "forces that other fixes and pair styles put on the atom",
                       who);
  who = name_surface(static_cast<int>(atom->molecule[node]) - 1);
  if (worst.finding == Finding::Fold)
    return fmt::format("{}: the triangles of atoms {} {} {} and {} {} {} are folded onto each "
                       "other (cosine of the angle between their normals {:.3f}, limit {:.3f}): "
                       "use a smaller timestep; if the fold stays, the membrane crumples at the "
                       "size of a triangle: use a finer mesh or a larger bending modulus",
                       who, tag[t[0]], tag[t[1]], tag[t[2]], tag[t[3]], tag[t[2]], tag[t[1]],
                       worst.value, limits_.fold_cosine);
  const std::string where =
      fmt::format("{}: the triangle of atoms {} {} {}", who, tag[t[0]], tag[t[1]], tag[t[2]]);
  if (worst.finding == Finding::Collapse)
    return fmt::format("{} has collapsed (quality {:.2g} of 1, limit {:.2g}): use a smaller "
                       "timestep; if the triangle was bad from the start, use a better mesh",
                       where, worst.value, biem::kCollapsedQuality);
  const bool is_edge = worst.finding == Finding::EdgeStrain;
  const double limit = is_edge ? limits_.edge_stretch : limits_.area_stretch;
  const double stretch = std::max(worst.value, 1.0 / worst.value);
  const std::string what =
      fmt::format("{} has {} of {:.4g} times {} reference (limits {:.4g} and {:.4g})", where,
                  is_edge ? "an edge" : "an area", worst.value, is_edge ? "that of its" : "its",
                  1.0 / limit, limit);
  if (worst.last > 0.0 && stretch > kSuddenGrowth * worst.last)
    return fmt::format("{}, and the largest stretch has grown from {:.4g} to {:.4g} since the last "
                       "check: use a smaller timestep",
                       what, worst.last, stretch);
  return fmt::format("{}: the membrane is too soft for this flow: use a larger modulus {} or a "
                     "weaker flow; if this strain is meant, give a larger limit with the keyword "
                     "'watch {}', and if it comes from a coarse mesh, use a finer one",
                     what, is_edge ? "ES" : "ED", is_edge ? "edge" : "area");
}

std::string LammpsWatchdog::name_surface(int surface) const
{
  return describe(groups_.surfaces[group_of_surface_[surface]].kind) + " " +
         std::to_string(surface + 1);
}

// Corners in one piece, as far along as the image flags of the middle atom say. The list has the
// images of the other two that are closest to it.
std::vector<biem::SurfaceTriangle> LammpsWatchdog::make_triangles() const
{
  std::vector<biem::SurfaceTriangle> triangles(neighbor->nanglelist);
  for (int n = 0; n < neighbor->nanglelist; n++) {
    const int *t = neighbor->anglelist[n], middle = t[1];
    biem::SurfaceTriangle &record = triangles[n];
    record.surface = static_cast<int>(atom->molecule[middle]) - 1;
    record.is_sheet = groups_.kind(atom->mask[middle]) == biem::SurfaceKind::Wall;
    double unwrapped[3];
    domain->unmap(atom->x[middle], atom->image[middle], unwrapped);
    for (int k = 0; k < 3; k++)
      for (int a = 0; a < 3; a++)
        record.corners[3 * k + a] = atom->x[t[k]][a] + (unwrapped[a] - atom->x[middle][a]);
  }
  return triangles;
}

std::string LammpsWatchdog::check_crossings()
{
  for (const biem::Crossing &c : find_crossings(make_triangles()))
    if (!known_crossings_.count({c.first, c.second})) return describe_crossing(c);
  return "";
}

std::vector<biem::Crossing>
LammpsWatchdog::find_crossings(const std::vector<biem::SurfaceTriangle> &triangles) const
{
  double sum = 0.0, width;    // largest root mean square edge
  for (const biem::SurfaceTriangle &t : triangles) {
    const biem::TriangleMeasure m = biem::measure_triangle(t.corners, t.corners + 3, t.corners + 6);
    sum = std::max(sum, m.edges[0] + m.edges[1] + m.edges[2]);
  }
  MPI_Allreduce(&sum, &width, 1, MPI_DOUBLE, MPI_MAX, world);
  width = std::sqrt(width / 3.0);
  if (!(width > 0.0 && std::isfinite(width))) return {};    // no surfaces, or check() reports them
  return find_all_crossings(world, biem::MeshLattice(get_cell(lmp)), width, triangles);
}

std::string LammpsWatchdog::describe_crossing(const biem::Crossing &c) const
{
  double where[3] = {c.where[0], c.where[1], c.where[2]};
  domain->remap(where);
  const bool is_own = c.first == c.second;
  const std::string other = is_own ? "its own periodic image" : name_surface(c.second);
  return fmt::format("the surfaces of {} and {} (molecule ids) have gone through each other near "
                     "({:.4g}, {:.4g}, {:.4g}): {}use a smaller timestep or a finer mesh, or keep "
                     "the surfaces apart with pair_style biem/contact",
                     name_surface(c.first), other, where[0], where[1], where[2],
                     is_own ? "use a larger box, or " : "");
}

std::string LammpsWatchdog::write_restart(bigint step)
{
  int is_good = 1, all_good;
  for (int i = 0; i < atom->nlocal; i++)
    if (!is_finite(atom->x[i])) is_good = 0;
  MPI_Allreduce(&is_good, &all_good, 1, MPI_INT, MPI_MIN, world);
  if (!all_good) return "";
  // A restart file has its atoms in the box; between two reneighborings they may be outside.
  const int n = atom->nlocal;
  std::vector<double> x(3 * n);
  std::vector<imageint> image(atom->image, atom->image + n);
  for (int i = 0; i < n; i++) {
    std::copy_n(atom->x[i], 3, &x[3 * i]);
    domain->remap(atom->x[i], atom->image[i]);
  }
  const std::string file = "restart.biem." + std::to_string(step);
  WriteRestart writer(lmp);
  BiemCompat::choose_one_file(writer);
  writer.write(file);
  for (int i = 0; i < n; i++) {
    std::copy_n(&x[3 * i], 3, atom->x[i]);
    atom->image[i] = image[i];
  }
  return file;
}

}    // namespace LAMMPS_NS
