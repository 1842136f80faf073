// Choice of the parameters by cost: see the header and doc/theory, label ewald-errors.
#include "biem_ewald_parameters.h"
#include "biem_error.h"
#include "biem_ewald_error_model.h"
#include "biem_ewald_split_pswf.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

namespace biem {

namespace {

constexpr double kMostGridPoints = 2e9;         // what a large cluster can still hold
constexpr double kTightestTolerance = 1e-10;    // double precision leaves no margin below
// Shares of the tolerance for the independent error sources, in quadrature with a margin.
constexpr double kSpmeShare = 0.42;    // real space, truncation, aliasing
// The sharp band limit may fall on a shell of many modes of a small cell, 3 times the average
// error.
constexpr double kPswfShare = 0.25;    // truncation, aliasing

// Nanoseconds on one AVX-512 core (bench/ewald); only their ratios matter. Fixed numbers, not a
// measurement at setup, so that a scene has the same parameters on every machine.
constexpr double kPairCost = 8.0;
constexpr double kGridVisitCost = 0.55;    // per window point, source or target, three components
constexpr double kGridPointCost = 25.0;    // FFTs and scaling of a 32^3 grid, three components

constexpr double kFinestOversampling = 3.0, kOversamplingStep = 0.05;

double volume(const EwaldScene &s)
{
  return std::fabs(s.cell.determinant());
}

// Length of each lattice vector in the worst tilt.
Vec3 worst_lengths(const EwaldScene &s)
{
  Vec3 c = s.cell.col(2);
  c[0] = std::max(std::fabs(c[0]), s.max_tilt);
  return Vec3(s.cell.col(0).norm(), s.cell.col(1).norm(), c.norm());
}

// Root of a decreasing function, by bisection in [low, high].
template <class Function> double find_root(Function f, double target, double low, double high)
{
  for (int i = 0; i < 40; i++) {
    const double middle = 0.5 * (low + high);
    (f(middle) > target ? low : high) = middle;
  }
  return high;
}

// Pairs within the cutoff per target: the target's own body plus the average density of the rest.
double expected_neighbors(const EwaldScene &s, double cutoff)
{
  double own = 0.0;
  if (s.body_radius > 0.0)
    own = s.body_sources * std::min(1.0, std::pow(0.5 * cutoff / s.body_radius, 2));
  return own + s.n_sources * 4.0 / 3.0 * M_PI * std::pow(cutoff, 3) / volume(s);
}

double cost(const EwaldScene &s, const EwaldParameters &p)
{
  const double points = static_cast<double>(p.grid[0]) * p.grid[1] * p.grid[2];
  return kPairCost * s.n_targets * expected_neighbors(s, p.cutoff) +
         kGridVisitCost * std::pow(p.order, 3) * (s.n_sources + s.n_targets) +
         kGridPointCost * points * std::log2(points) / 15.0;
}

void set_grid(const EwaldScene &s, double spacing, EwaldParameters &p)
{
  const Vec3 lengths = worst_lengths(s);
  for (int a = 0; a < 3; a++)
    p.grid[a] = next_fft_size(std::max(p.order, static_cast<int>(std::ceil(lengths[a] / spacing))));
}

// Of one order, for oversamplings 1 + kOversamplingStep, 1 + 2 kOversamplingStep, ...; made once.
const std::vector<AliasingTable> &get_kaiser_tables(int order)
{
  static std::map<int, std::vector<AliasingTable>> all;
  std::vector<AliasingTable> &tables = all[order];
  if (tables.empty())
    for (double s = 1.0 + kOversamplingStep; s <= kFinestOversampling; s += kOversamplingStep)
      tables.emplace_back(KaiserBesselWindow(order, s));
  return tables;
}

// Chooses the cheapest parameters of one method over cutoffs and orders.
class Chooser {
 public:
  explicit Chooser(const EwaldScene &scene) : scene_(scene), model_(volume(scene)) {}

  EwaldParameters choose()
  {
    const double length = std::cbrt(volume(scene_));
    const double low = scene_.min_cutoff > 0.0 ? scene_.min_cutoff : 0.05 * length;
    const double high = scene_.max_cutoff > 0.0 ? scene_.max_cutoff : 0.6 * length;
    constexpr int kCutoffs = 40;
    const bool is_spme = scene_.method == EwaldMethod::Spme;
    for (int order :
         is_spme ? std::vector<int>{4, 6, 8, 10} : std::vector<int>{4, 5, 6, 7, 8, 9, 10, 11, 12}) {
      tables_ = is_spme ? std::vector<AliasingTable>{AliasingTable(BsplineWindow(order))}
                        : get_kaiser_tables(order);
      for (int i = 0; i <= kCutoffs; i++) {
        EwaldParameters p;
        p.method = scene_.method;
        p.order = order;
        p.tolerance = scene_.tolerance;
        p.cutoff = low * std::pow(high / low, static_cast<double>(i) / kCutoffs);
        if (is_spme ? fill_spme(p) : fill_pswf(p)) keep_if_cheaper(p);
      }
    }
    if (best_.order == 0) {
      std::ostringstream message;
      message << "accuracy " << scene_.tolerance << " cannot be met with a cutoff between " << low
              << " and " << high << " in this cell: the grid would be too large; allow a larger"
              << " cutoff or a larger tolerance";
      throw Error(message.str());
    }
    best_.expected_error = compute_expected_error(scene_, best_);
    return best_;
  }

 private:
  bool fill_spme(EwaldParameters &p) const
  {
    const double share = kSpmeShare * scene_.tolerance;
    p.splitting = find_root([&](double xi) { return model_.gaussian_real(xi, p.cutoff); }, share,
                            0.5 / p.cutoff, 12.0 / p.cutoff);
    const double xi = p.splitting;
    p.band_limit =
        2.0 * xi *
        find_root([&](double x) { return model_.gaussian_truncation(xi, x); }, share, 0.8, 12.0);
    // Aliasing falls with 1/h; the root is found in 1/h so that the function decreases.
    const GaussianSplit split(xi);
    const double coarsest = M_PI / p.band_limit;
    auto aliasing = [&](double q) {
      return model_.aliasing(split, p.band_limit, tables_[0], 1.0 / q);
    };
    const double inverse = find_root(aliasing, share, 1.0 / coarsest, 20.0 / coarsest);
    set_grid(scene_, 1.0 / inverse, p);
    return aliasing(inverse) <= 1.01 * share;
  }

  bool fill_pswf(EwaldParameters &p) const
  {
    const double share = kPswfShare * scene_.tolerance;
    const double bandwidth = find_root(
        [&](double c) { return model_.pswf_truncation(c, c / p.cutoff); }, share, 3.0, 37.0);
    p.band_limit = bandwidth / p.cutoff;
    const PswfSplit split(bandwidth, p.cutoff);
    for (size_t i = 0; i < tables_.size(); i++) {
      p.oversampling = 1.0 + kOversamplingStep * (i + 1);
      const double spacing = M_PI / (p.oversampling * p.band_limit);
      if (model_.aliasing(split, p.band_limit, tables_[i], spacing) > share) continue;
      set_grid(scene_, spacing, p);
      return true;
    }
    return false;
  }

  void keep_if_cheaper(const EwaldParameters &p)
  {
    if (static_cast<double>(p.grid[0]) * p.grid[1] * p.grid[2] > kMostGridPoints) return;
    const double candidate_cost = cost(scene_, p);
    if (candidate_cost >= best_cost_) return;
    best_cost_ = candidate_cost;
    best_ = p;
  }

  const EwaldScene &scene_;
  EwaldErrorModel model_;
  std::vector<AliasingTable> tables_;    // of the present order; PSWF: one per oversampling
  EwaldParameters best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
};

}    // namespace

EwaldMethod parse_ewald_method(const std::string &name)
{
  if (name == "spme") return EwaldMethod::Spme;
  if (name == "pswf") return EwaldMethod::Pswf;
  throw Error("unknown ewald method '" + name + "': choose spme or pswf");
}

std::string describe(EwaldMethod method)
{
  return method == EwaldMethod::Spme ? "SPME, Gaussian split, B-splines"
                                     : "PSWF split, Kaiser-Bessel window";
}

int next_fft_size(int n)
{
  for (;; n++) {
    int rest = n;
    for (int prime : {2, 3, 5, 7})
      while (rest % prime == 0)
        rest /= prime;
    if (rest == 1) return n;
  }
}

std::unique_ptr<EwaldSplit> make_split(const EwaldParameters &p)
{
  if (p.method == EwaldMethod::Spme) return std::make_unique<GaussianSplit>(p.splitting);
  return std::make_unique<PswfSplit>(p.band_limit * p.cutoff, p.cutoff);
}

std::unique_ptr<EwaldWindow> make_window(const EwaldParameters &p)
{
  if (p.order < 3 || p.order > kMaxWindowOrder)
    throw Error("window order " + std::to_string(p.order) + " is out of range (3 to " +
                std::to_string(kMaxWindowOrder) + ")");
  if (p.method == EwaldMethod::Spme) return std::make_unique<BsplineWindow>(p.order);
  return std::make_unique<KaiserBesselWindow>(p.order, p.oversampling);
}

double compute_expected_error(const EwaldScene &s, const EwaldParameters &p)
{
  const EwaldErrorModel model(volume(s));
  const AliasingTable table(*make_window(p));
  const std::unique_ptr<EwaldSplit> split = make_split(p);
  double square = 0.0;
  if (p.method == EwaldMethod::Spme)
    square =
        std::pow(model.gaussian_real(p.splitting, p.cutoff), 2) +
        std::pow(model.gaussian_truncation(p.splitting, p.band_limit / (2.0 * p.splitting)), 2);
  else
    square = std::pow(model.pswf_truncation(p.band_limit * p.cutoff, p.band_limit), 2);
  const Vec3 lengths = worst_lengths(s);
  for (int a = 0; a < 3; a++)
    square +=
        std::pow(model.aliasing(*split, p.band_limit, table, lengths[a] / p.grid[a]), 2) / 3.0;
  return std::sqrt(square);
}

EwaldParameters choose_ewald_parameters(const EwaldScene &s)
{
  if (!(s.tolerance >= kTightestTolerance && s.tolerance <= 0.1)) {
    std::ostringstream message;
    message << "accuracy " << s.tolerance << " is out of range: the periodic sum can be computed to"
            << " relative tolerances between " << kTightestTolerance << " and 0.1";
    throw Error(message.str());
  }
  return Chooser(s).choose();
}

}    // namespace biem
