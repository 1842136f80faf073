// Spectral radius by Arnoldi's method: see the header.
#include "biem_lammps_stiffness.h"
#include "atom.h"
#include "domain.h"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

namespace LAMMPS_NS {

using namespace NodeColumn;

namespace {

// Evaluations of one estimate.
constexpr int kKrylovSize = 3;
// The first estimate restarts until two agree so well.
constexpr double kAgreement = 0.02;
constexpr int kMostRestarts = 8;
// Largest displacement of a node, of the longest edge: small enough for the linear range, large
// enough for velocities that are accurate to the tolerance of the solver only.
constexpr double kPerturbation = 2e-3;

static_assert(kKrylov + 3 * (kKrylovSize + 1) <= kColumns, "room for the Krylov vectors");

}    // namespace

void StiffnessEstimate::start_run()
{
  last_count_ -= flow_.n_all();
  n_evaluations_ = 0.0;
}

bool StiffnessEstimate::is_due(double n_evaluations) const
{
  return !is_started_ || flow_.n_all() - last_count_ >= n_evaluations;
}

double StiffnessEstimate::upper_radius(double n_evaluations) const
{
  const double share = (flow_.n_all() - last_count_) / n_evaluations;
  return radius_ + std::max(0.0, radius_ - previous_radius_) * std::min(1.0, share);
}

void StiffnessEstimate::renew(double time)
{
  time_ = time;
  save_positions();
  body_modes_.resize(kKrylovSize + 1);
  for (const auto &body : bodies_)
    body_modes_[0][body.first];
  const bool is_first = !is_started_;
  if (is_first) start_mode();
  lay_body_mode(0);
  add_step_error();
  set_start_rates();
  previous_radius_ = radius_;
  for (int restart = 0; restart < kMostRestarts; restart++) {
    const double last = radius_;
    radius_ = iterate();
    if (!is_first || std::fabs(radius_ - last) <= kAgreement * radius_) break;
  }
  if (is_first) previous_radius_ = radius_;
  for (int i = 0; i < atom->nlocal; i++)
    std::copy_n(vector(i, 0), 3, array_[i] + kStiffMode);
  is_started_ = true;
  flow_.forces.update_ghosts();
  last_count_ = flow_.n_all();
}

// Positions, to the last digit; the mode of the last estimate.
void StiffnessEstimate::save_positions()
{
  bodies_ = solver_.particles.bodies();
  for (int i = 0; i < atom->nlocal; i++) {
    std::copy_n(atom->x[i], 3, array_[i] + kPreviousDisplacement);
    std::copy_n(array_[i] + kStiffMode, 3, vector(i, 0));
  }
}

// Velocities at the positions of now: known, or their fast part.
void StiffnessEstimate::set_start_rates()
{
  for (int i = 0; i < atom->nlocal; i++)
    for (int a = 0; a < 3; a++)
      array_[i][kStartRate + a] =
          array_[i][kVelocity + a] - (is_fast_ ? array_[i][kSlow + a] : 0.0);
}

void StiffnessEstimate::restore_positions()
{
  for (int i = 0; i < atom->nlocal; i++)
    std::copy_n(array_[i] + kPreviousDisplacement, 3, atom->x[i]);
  solver_.particles.bodies() = bodies_;
}

bool StiffnessEstimate::moves(int i) const
{
  const biem::SurfaceKind kind = flow_.kind(i);
  return kind == biem::SurfaceKind::Cell || kind == biem::SurfaceKind::Rigid;
}

double *StiffnessEstimate::vector(int i, int k) const
{
  return array_[i] + kKrylov + 3 * k;
}

// Every mode has some part of random displacements; the same ones on any number of ranks.
void StiffnessEstimate::start_mode()
{
  auto draw = [&](int seed) {
    std::minstd_rand engine(static_cast<unsigned>(seed) * 2654435761U + 1U);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    engine.discard(3);
    biem::Vec3 v;
    for (int a = 0; a < 3; a++)
      v[a] = number(engine);
    return v;
  };
  for (int i = 0; i < atom->nlocal; i++) {
    Eigen::Map<biem::Vec3> mode(vector(i, 0));
    mode.setZero();
    if (flow_.kind(i) == biem::SurfaceKind::Cell) mode = draw(static_cast<int>(atom->tag[i]));
  }
  for (auto &entry : body_modes_[0])
    entry.second = {draw(-2 * entry.first), draw(-2 * entry.first - 1)};
}

// What is wrong with the last step is mostly fast modes: those that have become faster than the one
// of the last estimate show there first.
void StiffnessEstimate::add_step_error()
{
  for (const auto &body : bodies_)
    body_modes_[1][body.first] = BodyMode();
  for (int i = 0; i < atom->nlocal; i++) {
    const bool is_cell = flow_.kind(i) == biem::SurfaceKind::Cell;
    for (int a = 0; a < 3; a++)
      vector(i, 1)[a] = is_cell ? array_[i][kStepError + a] : 0.0;
  }
  const double mode = std::sqrt(dot(0, 0)), error = std::sqrt(dot(1, 1));
  if (mode > 0.0 && error > 0.0) add(mode / error, 1, 0);
}

// Arnoldi from vector 0, which becomes the mode of the largest Ritz value; that is returned.
double StiffnessEstimate::iterate()
{
  const double norm = std::sqrt(dot(0, 0));
  if (norm == 0.0) return 0.0;
  scale(0, 1.0 / norm);
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(kKrylovSize + 1, kKrylovSize);
  int n = 0;
  while (n < kKrylovSize) {
    apply_jacobian(n, n + 1);
    for (int j = 0; j <= n; j++) {
      h(j, n) = dot(j, n + 1);
      add(-h(j, n), j, n + 1);
    }
    h(n + 1, n) = std::sqrt(dot(n + 1, n + 1));
    n++;
    if (h(n, n - 1) <= 1e-10 * h.norm()) break;    // an invariant subspace
    scale(n, 1.0 / h(n, n - 1));
  }
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(h.topLeftCorner(n, n));
  Eigen::Index largest;
  const double radius = solver.eigenvalues().cwiseAbs().maxCoeff(&largest);
  Eigen::VectorXd mode = solver.eigenvectors().col(largest).real();
  if (mode[0] < 0.0) mode = -mode;    // a sign that rounding does not choose
  scale(0, mode[0]);
  for (int j = 1; j < n; j++)
    add(mode[j], j, 0);
  return radius;
}

// vector to = Jacobian of the velocities times vector from.
void StiffnessEstimate::apply_jacobian(int from, int to)
{
  // A power of two: another run that starts from another longest edge perturbs by the same.
  const double edge = std::exp2(std::round(std::log2(solver_.longest_edge())));
  const double size = kPerturbation * edge / find_largest(from);
  for (int i = 0; i < atom->nlocal; i++)
    for (int a = 0; moves(i) && a < 3; a++)
      atom->x[i][a] += size * vector(i, from)[a];
  for (auto &entry : solver_.particles.bodies()) {
    const BodyMode &mode = body_modes_[from].at(entry.first);
    entry.second.position += size * mode.shift;
    biem::turn_body(size * mode.turn, entry.second);
  }
  flow_.forces.update_ghosts();
  flow_.compute_forces();
  const biem::Points rates = evaluate();
  for (int i = 0; i < atom->nlocal; i++) {
    Eigen::Map<biem::Vec3> image(vector(i, to));
    const biem::Vec3 velocity = rates.col(i), start(array_[i] + kStartRate);
    image.setZero();
    if (flow_.kind(i) == biem::SurfaceKind::Cell) image = (velocity - start) / size;
  }
  for (const auto &entry : bodies_) {
    const biem::RigidBody &now = solver_.particles.bodies().at(entry.first);
    body_modes_[to][entry.first] = {(now.velocity - entry.second.velocity) / size,
                                    (now.rotation - entry.second.rotation) / size};
  }
  restore_positions();
  lay_body_mode(to);
}

biem::Points StiffnessEstimate::evaluate()
{
  n_evaluations_ += 1.0;
  return is_fast_ ? flow_.evaluate_inner_aside() : flow_.evaluate_aside(time_).velocity;
}

// To the nodes of the particles, so that all nodes count alike.
void StiffnessEstimate::lay_body_mode(int k)
{
  for (int i = 0; i < atom->nlocal; i++) {
    if (flow_.kind(i) != biem::SurfaceKind::Rigid) continue;
    const int molecule = static_cast<int>(atom->molecule[i]);
    const BodyMode &mode = body_modes_[k].at(molecule);
    biem::Vec3 x;
    domain->unmap(atom->x[i], atom->image[i], x.data());
    Eigen::Map<biem::Vec3>(vector(i, k)) =
        mode.shift + mode.turn.cross(x - bodies_.at(molecule).position);
  }
}

double StiffnessEstimate::dot(int j, int k) const
{
  double sum = 0.0;
  for (int i = 0; i < atom->nlocal; i++)
    if (moves(i))
      sum += Eigen::Map<const biem::Vec3>(vector(i, j))
                 .dot(Eigen::Map<const biem::Vec3>(vector(i, k)));
  solver_.exchange.sum(&sum, 1);
  return sum;
}

void StiffnessEstimate::add(double factor, int from, int to)
{
  for (int i = 0; i < atom->nlocal; i++)
    for (int a = 0; a < 3; a++)
      vector(i, to)[a] += factor * vector(i, from)[a];
  for (auto &entry : body_modes_[to]) {
    const BodyMode &mode = body_modes_[from].at(entry.first);
    entry.second.shift += factor * mode.shift;
    entry.second.turn += factor * mode.turn;
  }
}

void StiffnessEstimate::scale(int k, double factor)
{
  add(factor - 1.0, k, k);
}

double StiffnessEstimate::find_largest(int k) const
{
  double largest = 0.0, all;
  for (int i = 0; i < atom->nlocal; i++)
    if (moves(i)) largest = std::max(largest, Eigen::Map<const biem::Vec3>(vector(i, k)).norm());
  MPI_Allreduce(&largest, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all;
}

std::vector<double> StiffnessEstimate::get_state() const
{
  const size_t n = body_modes_.empty() ? 0 : body_modes_[0].size();
  std::vector<double> state = {is_started_ ? 1.0 : 0.0, radius_, previous_radius_,
                               flow_.n_all() - last_count_, static_cast<double>(n)};
  if (n == 0) return state;
  for (const auto &entry : body_modes_[0]) {
    state.push_back(entry.first);
    state.insert(state.end(), entry.second.shift.data(), entry.second.shift.data() + 3);
    state.insert(state.end(), entry.second.turn.data(), entry.second.turn.data() + 3);
  }
  return state;
}

const double *StiffnessEstimate::set_state(const double *state)
{
  is_started_ = state[0] != 0.0;
  radius_ = state[1];
  previous_radius_ = state[2];
  last_count_ = -state[3];
  const int n = static_cast<int>(state[4]);
  state += 5;
  body_modes_.resize(kKrylovSize + 1);
  for (int k = 0; k < n; k++, state += 7)
    body_modes_[0][static_cast<int>(*state)] = {biem::Vec3(state + 1), biem::Vec3(state + 4)};
  return state;
}

}    // namespace LAMMPS_NS
