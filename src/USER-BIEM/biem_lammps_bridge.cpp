// Bridge between LAMMPS and the core: see the header.
#include "biem_lammps_bridge.h"
#include "atom.h"
#include "biem_lammps_compat.h"
#include "comm.h"
#include "domain.h"
#include "neigh_list.h"
#include "neighbor.h"
#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {

void LammpsExchange::forward(double *values, int n_columns)
{
  values_ = values;
  n_columns_ = n_columns;
  BiemCompat::forward_comm(comm, fix_, n_columns);
}

void LammpsExchange::reverse_add(double *values, int n_columns)
{
  values_ = values;
  n_columns_ = n_columns;
  BiemCompat::reverse_comm(comm, fix_, n_columns);
}

void LammpsExchange::sum(double *values, int n)
{
  MPI_Allreduce(MPI_IN_PLACE, values, n, MPI_DOUBLE, MPI_SUM, world);
}

int LammpsExchange::pack_forward(int n, const int *list, double *buffer) const
{
  for (int i = 0; i < n; i++)
    std::copy_n(values_ + static_cast<ptrdiff_t>(list[i]) * n_columns_, n_columns_,
                buffer + i * n_columns_);
  return n * n_columns_;
}

void LammpsExchange::unpack_forward(int n, int first, const double *buffer)
{
  std::copy_n(buffer, n * n_columns_, values_ + static_cast<ptrdiff_t>(first) * n_columns_);
}

int LammpsExchange::pack_reverse(int n, int first, double *buffer) const
{
  std::copy_n(values_ + static_cast<ptrdiff_t>(first) * n_columns_, n * n_columns_, buffer);
  return n * n_columns_;
}

void LammpsExchange::unpack_reverse(int n, const int *list, const double *buffer)
{
  for (int i = 0; i < n; i++)
    for (int c = 0; c < n_columns_; c++)
      values_[static_cast<ptrdiff_t>(list[i]) * n_columns_ + c] += buffer[i * n_columns_ + c];
}

namespace {

// An edge may grow by this between two reneighborings without leaving the near list.
constexpr double kListMargin = 1.1;

}    // namespace

biem::Mat3 get_cell(LAMMPS *lmp)
{
  const Domain &domain = *lmp->domain;
  biem::Mat3 cell = biem::Mat3::Zero();
  cell.diagonal() = biem::Vec3(domain.xprd, domain.yprd, domain.zprd);
  if (domain.triclinic) {
    cell(0, 1) = domain.xy;
    cell(0, 2) = domain.xz;
    cell(1, 2) = domain.yz;
  }
  return cell;
}

biem::Vec3 get_origin(LAMMPS *lmp)
{
  return Eigen::Map<const biem::Vec3>(lmp->domain->boxlo);
}

void LammpsConfiguration::refresh(NeighList *list)
{
  version_++;
  lost_reach_ = 0.0;
  triangles_.clear();
  surface_of_triangle_.clear();
  candidates_.start.assign(1, 0);
  candidates_.node.clear();
  for (int n = 0; n < neighbor->nanglelist; n++) {
    const int *angle = neighbor->anglelist[n];
    triangles_.push_back({angle[0], angle[1], angle[2]});
    surface_of_triangle_.push_back(static_cast<int>(atom->molecule[angle[1]]) - 1);
    add_candidates(triangles_.back(), list);
    candidates_.start.push_back(static_cast<int>(candidates_.node.size()));
  }
  surface_of_node_.resize(atom->nlocal);
  index_of_node_.resize(atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++) {
    const bool is_node = groups_.find_surface(atom->mask[i]) >= 0;
    surface_of_node_[i] = is_node ? static_cast<int>(atom->molecule[i]) - 1 : -1;
    index_of_node_[i] = is_node ? index_(atom->tag[i]) : -1;
  }
  triangle_shift_.resize(3, static_cast<Eigen::Index>(triangles_.size()));
}

void LammpsConfiguration::add_candidates(const biem::Triangle &t, NeighList *list)
{
  biem::Vec3 corner[3];
  for (int v = 0; v < 3; v++)
    corner[v] = Eigen::Map<biem::Vec3>(atom->x[t[v]]);
  double sum = 0.0, longest = 0.0;
  for (int v = 0; v < 3; v++) {
    const double edge = (corner[(v + 1) % 3] - corner[v]).norm();
    sum += edge;
    longest = std::max(longest, edge);
  }
  const double reach = kListMargin * biem::kNearFactor * sum / 3.0;
  if (!(reach + longest <= list_cutoff_) && !(reach + longest <= lost_reach_)) {
    lost_reach_ = reach + longest;
    lost_molecule_ = static_cast<int>(atom->molecule[t[1]]);
  }
  const double reach2 = std::pow(reach + neighbor->skin, 2);
  auto add_if_near = [&](int j) {
    const biem::Vec3 x = Eigen::Map<biem::Vec3>(atom->x[j]);
    if (std::min({(x - corner[0]).squaredNorm(), (x - corner[1]).squaredNorm(),
                  (x - corner[2]).squaredNorm()}) <= reach2)
      candidates_.node.push_back(j);
  };
  const int i = t[1];    // owned: newton on stores an angle with its middle atom
  add_if_near(i);
  for (int k = 0; k < list->numneigh[i]; k++)
    add_if_near(list->firstneigh[i][k] & NEIGHMASK);
}

biem::Configuration LammpsConfiguration::get(std::vector<biem::Mat3> orientations)
{
  orientations_ = std::move(orientations);
  unwrapped_.resize(3, atom->nlocal);
  for (int i = 0; i < atom->nlocal; i++)
    domain->unmap(atom->x[i], atom->image[i], unwrapped_.col(i).data());
  for (size_t e = 0; e < triangles_.size(); e++) {
    const int i = triangles_[e][1];    // owned
    for (int a = 0; a < 3; a++)
      triangle_shift_(a, e) = unwrapped_(a, i) - atom->x[i][a];
  }
  const Eigen::Map<const biem::Points> nodes(atom->x[0], 3, atom->nlocal + atom->nghost);
  return biem::Configuration{
      nodes,          atom->nlocal,    triangles_, surface_of_triangle_, surface_of_node_,
      index_of_node_, triangle_shift_, unwrapped_, candidates_,          orientations_,
      version_};
}

}    // namespace LAMMPS_NS
