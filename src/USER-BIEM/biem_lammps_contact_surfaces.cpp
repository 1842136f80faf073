// Surfaces that may touch: see the header.
#include "biem_lammps_contact_surfaces.h"
#include "atom.h"
#include "biem_lammps_atom_directory.h"
#include "biem_lammps_compat.h"
#include "biem_types.h"
#include "domain.h"
#include "error.h"
#include "neighbor.h"
#include <algorithm>

namespace LAMMPS_NS {

namespace {

// Edges of membranes stretch, those of walls do not.
constexpr double kBodyGrowth = 2.0, kWallGrowth = 1.01;

double compute_area(double **x, const int *t)
{
  const biem::Vec3 a(x[t[0]]), b(x[t[1]]), c(x[t[2]]);
  return 0.5 * (b - a).cross(c - a).norm();
}

}    // namespace

void ContactSurfaces::survey(int wall_bit)
{
  AtomDirectory directory(lmp);
  int64_t missing, smallest;
  const std::vector<AtomRecord> corners = directory.look_up_corners(missing);
  MPI_Allreduce(&missing, &smallest, 1, MPI_INT64_T, MPI_MIN, world);
  if (smallest != kNoTag)
    error->all(FLERR, "Pair biem/contact: atom {} is named by an angle but does not exist: was it "
               "deleted?", smallest);
  classify(corners, wall_bit);
  measure_edges(corners);
}

// A surface without handles and boundary has F = 2 V - 4 triangles (Euler). A periodic sheet or
// tube has F = 2 V, an open sheet other numbers.
void ContactSurfaces::classify(const std::vector<AtomRecord> &corners, int wall_bit)
{
  tagint last = 0, last_all;
  for (int i = 0; i < atom->nlocal; i++) last = std::max(last, atom->molecule[i]);
  MPI_Allreduce(&last, &last_all, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  const int n = static_cast<int>(last_all) + 1;
  std::vector<int> counts(3 * n, 0), all(3 * n);    // nodes, triangles, those of walls by group
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->molecule[i] > 0) counts[atom->molecule[i]]++;
  for (size_t t = 0; t < corners.size(); t += 3) {
    const int64_t molecule = corners[t + 1].molecule;
    if (molecule < 1) continue;
    counts[n + molecule]++;
    if (corners[t + 1].mask & wall_bit) counts[2 * n + molecule]++;
  }
  MPI_Allreduce(counts.data(), all.data(), 3 * n, MPI_INT, MPI_SUM, world);
  kinds_.assign(n, Kind::None);
  has_walls_ = false;
  for (int m = 1; m < n; m++) {
    const int n_triangles = all[n + m];
    if (n_triangles == 0) continue;
    const bool is_closed = n_triangles == 2 * all[m] - 4 && all[2 * n + m] == 0;
    kinds_[m] = is_closed ? Kind::Body : Kind::Wall;
    has_walls_ = has_walls_ || !is_closed;
  }
}

void ContactSurfaces::measure_edges(const std::vector<AtomRecord> &corners)
{
  std::vector<double> limits(atom->ntypes + 1, 0.0);
  size_t t = 0;
  for (int i = 0; i < atom->nlocal; i++)
    for (int a = 0; a < atom->num_angle[i]; a++, t += 3) {
      double &limit = limits[atom->type[i]];
      const double growth = is_body(corners[t + 1].molecule) ? kBodyGrowth : kWallGrowth;
      for (int k : {0, 2}) {
        double d[3];
        for (int c = 0; c < 3; c++) d[c] = corners[t + k].x[c] - corners[t + 1].x[c];
        BiemCompat::minimum_image(domain, d);    // walls cross the box
        limit = std::max(limit, growth * biem::Vec3(d).norm());
      }
    }
  edge_limits_.resize(limits.size());
  MPI_Allreduce(limits.data(), edge_limits_.data(), static_cast<int>(limits.size()), MPI_DOUBLE,
                MPI_MAX, world);
}

void ContactSurfaces::measure_areas()
{
  int flag, columns;
  const int index = atom->find_custom("biem_reference", flag, columns);
  double **reference = index >= 0 && flag == 1 && columns == 3 ? atom->darray[index] : nullptr;
  tagint last = 0, last_all;
  for (int i = 0; i < atom->nlocal; i++) last = std::max(last, atom->tag[i]);
  MPI_Allreduce(&last, &last_all, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  const int n = static_cast<int>(last_all) + 1;
  std::vector<double> sums(2 * n, 0.0), all(2 * n);    // of the reference, of the positions
  for (int a = 0; a < neighbor->nanglelist; a++) {
    const int *t = neighbor->anglelist[a];
    const double areas[2] = {reference ? compute_area(reference, t) : 0.0,
                             compute_area(atom->x, t)};
    for (int k = 0; k < 3; k++)
      for (int s = 0; s < 2; s++) sums[s * n + atom->tag[t[k]]] += areas[s] / 3.0;
  }
  MPI_Allreduce(sums.data(), all.data(), 2 * n, MPI_DOUBLE, MPI_SUM, world);
  areas_.resize(n, 0.0);
  for (int i = 0; i < n; i++)
    if (all[i] > 0.0)
      areas_[i] = all[i];
    else if (areas_[i] == 0.0)
      areas_[i] = all[n + i];
}

}    // namespace LAMMPS_NS
