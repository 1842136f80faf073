// Choice of the parameters by cost: see the header and doc/theory, label ewald-errors.
#include "biem_ewald_parameters.h"
#include "biem_error.h"
#include "biem_ewald_cost.h"
#include "biem_ewald_error_model.h"
#include "biem_ewald_split_pswf.h"
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace biem {

namespace {

constexpr double kMostGridPoints = 2e9;    // what a large cluster can still hold
// Shares of the tolerance for the independent error sources, added in quadrature.
constexpr double kSpmeShare = 0.36;         // real space, truncation, aliasing
constexpr double kPswfShare = 0.45;         // truncation, aliasing
constexpr double kDistinctCutoffs = 0.1;    // relative, of candidates to be timed
constexpr double kFinestOversampling = 3.0, kOversamplingStep = 0.05;

bool is_given(const EwaldScene &s)
{
  return s.splitting > 0.0 || s.grid[0] > 0;
}

double volume(const EwaldScene &s)
{
  return std::fabs(s.cell.determinant());
}

// Root of a decreasing function, by bisection in [low, high].
template <class Function> double find_root(Function f, double target, double low, double high)
{
  for (int i = 0; i < 30; i++) {
    const double middle = 0.5 * (low + high);
    (f(middle) > target ? low : high) = middle;
  }
  return high;
}

// |k| <= K has |n_a| <= K |a_a| / 2 pi. The mode at half of the grid is never used.
void set_grid(const EwaldScene &s, double spacing, EwaldParameters &p)
{
  const Vec3 lengths = worst_lengths(s);
  for (int a = 0; a < 3; a++) {
    const int needed = std::max(p.order, static_cast<int>(std::ceil(lengths[a] / spacing)));
    p.grid[a] = s.grid[a] > 0 ? s.grid[a] : next_fft_size(needed);
    p.modes[a] =
        std::min(static_cast<int>(p.band_limit * lengths[a] / (2.0 * M_PI)), (p.grid[a] - 1) / 2);
  }
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

// Errors of all layers of a scene.
class SceneErrors {
 public:
  explicit SceneErrors(const EwaldScene &s)
  {
    if (has_single(s.layers)) models_.emplace_back(Layers::Single, volume(s), s.n_sources);
    if (has_double(s.layers)) models_.emplace_back(Layers::Double, volume(s), s.n_sources);
  }

  // Largest of f(model) over the layers.
  template <class Function> double largest(const Function &f) const
  {
    double result = 0.0;
    for (const EwaldErrorModel &model : models_)
      result = std::max(result, f(model));
    return result;
  }

 private:
  std::vector<EwaldErrorModel> models_;
};

// Lists parameters of one method that meet the tolerance, over cutoffs and orders.
class Candidates {
 public:
  explicit Candidates(const EwaldScene &scene) :
      scene_(scene), errors_(scene), target_(scene.tolerance / scene.error_factor)
  {
  }

  std::vector<std::pair<double, EwaldParameters>> list()    // with their costs
  {
    const double length = std::cbrt(volume(scene_));
    const double spacing = length / std::cbrt(std::max(1.0, scene_.n_sources));
    const double low = scene_.cutoff > 0.0 ? scene_.cutoff : std::min(0.3 * length, 0.8 * spacing);
    const double high = scene_.cutoff > 0.0 ? scene_.cutoff : 0.6 * length;
    constexpr int kCutoffs = 40;
    for (int i = 0; i <= (scene_.cutoff > 0.0 ? 0 : kCutoffs); i++) {
      EwaldParameters p;
      p.method = scene_.method;
      p.tolerance = scene_.tolerance;
      p.cutoff = low * std::pow(high / low, static_cast<double>(i) / kCutoffs);
      scene_.method == EwaldMethod::Spme ? add_spme(p) : add_pswf(p);
    }
    if (found_.empty()) throw_impossible(low, high);
    return found_;
  }

 private:
  void add_spme(EwaldParameters &p)
  {
    const double share = kSpmeShare * target_;
    p.splitting =
        scene_.splitting > 0.0
            ? scene_.splitting
            : find_root(
                  [&](double xi) {
                    return errors_.largest([&](auto &m) { return m.gaussian_real(xi, p.cutoff); });
                  },
                  share, 0.5 / p.cutoff, 12.0 / p.cutoff);
    const double xi = p.splitting;
    auto truncation = [&](double x) {
      return errors_.largest([&](auto &m) { return m.gaussian_truncation(xi, x); });
    };
    p.band_limit = 2.0 * xi * find_root(truncation, share, 0.8, 12.0);
    const BandSpectrum spectrum(GaussianSplit(xi), p.band_limit);
    for (int order : get_orders({4, 6, 8, 10, 12})) {
      p.order = order;
      const AliasingTable table{BsplineWindow(order)};
      // Aliasing falls with 1/h; the root is found in 1/h so that the function decreases.
      auto aliasing = [&](double q) {
        return errors_.largest([&](auto &m) { return m.aliasing(spectrum, table, 1.0 / q); });
      };
      const double coarsest = M_PI / p.band_limit;
      const double inverse = find_root(aliasing, share, 1.0 / coarsest, 20.0 / coarsest);
      if (aliasing(inverse) > 1.01 * share && !is_given(scene_)) continue;
      set_grid(scene_, 1.0 / inverse, p);
      keep(p);
    }
  }

  void add_pswf(EwaldParameters &p)
  {
    const double share = kPswfShare * target_;
    auto truncation = [&](double c) {
      return errors_.largest([&](auto &m) { return m.pswf_truncation(c, p.cutoff); });
    };
    const double bandwidth = scene_.splitting > 0.0 ? scene_.splitting * p.cutoff
                                                    : find_root(truncation, share, 3.0, 37.0);
    if (truncation(bandwidth) > 1.05 * share && !is_given(scene_)) return;
    p.splitting = bandwidth / p.cutoff;
    p.band_limit = (bandwidth + kBandMargin) / p.cutoff;
    const BandSpectrum spectrum(PswfSplit(bandwidth, p.cutoff), p.band_limit);
    for (int order : get_orders({4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14})) {
      p.order = order;
      const std::vector<AliasingTable> &tables = get_kaiser_tables(order);
      for (size_t i = 0; i < tables.size(); i++) {
        p.oversampling = 1.0 + kOversamplingStep * (i + 1);
        const double spacing = M_PI / (p.oversampling * p.band_limit);
        auto aliasing = [&](auto &m) {
          return m.aliasing(spectrum, tables[i], spacing);
        };
        const bool is_last = is_given(scene_) && i + 1 == tables.size();
        if (errors_.largest(aliasing) > share && !is_last) continue;
        set_grid(scene_, spacing, p);
        keep(p);
        break;
      }
    }
  }

  std::vector<int> get_orders(const std::vector<int> &all) const
  {
    return scene_.order > 0 ? std::vector<int>{scene_.order} : all;
  }

  void keep(EwaldParameters &p)
  {
    if (static_cast<double>(p.grid[0]) * p.grid[1] * p.grid[2] > kMostGridPoints) return;
    if (*std::min_element(p.grid.begin(), p.grid.end()) < p.order) return;
    found_.emplace_back(predict_ewald_cost(scene_, p), p);
  }

  [[noreturn]] void throw_impossible(double low, double high) const
  {
    std::ostringstream message;
    message << "accuracy " << scene_.tolerance << " cannot be met with a cutoff between " << low
            << " and " << high << " in this cell (volume " << volume(scene_) << ", "
            << scene_.n_sources << " sources)";
    if (scene_.grid[0] > 0)
      message << " and the given grid of " << scene_.grid[0] << " x " << scene_.grid[1] << " x "
              << scene_.grid[2] << " points: it must have at least as many points along each axis "
              << "as the window order (at least 4); give a finer grid or leave it out";
    else if (scene_.order > 0)
      message << " and the given window order " << scene_.order
              << ": give a higher order or leave it out";
    else
      message << ": the grid would need more than " << kMostGridPoints
              << " points; allow a larger cutoff or a larger accuracy";
    throw Error(message.str());
  }

  const EwaldScene &scene_;
  SceneErrors errors_;
  double target_;
  std::vector<std::pair<double, EwaldParameters>> found_;
};

void check_scene(const EwaldScene &s)
{
  if (!(s.tolerance >= kTightestTolerance && s.tolerance <= 0.1)) {
    std::ostringstream message;
    message << "accuracy " << s.tolerance << " is out of range: the periodic sum can be computed to"
            << " relative tolerances between " << kTightestTolerance << " and 0.1";
    throw Error(message.str());
  }
}

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
  constexpr int kSmall = 32;    // beyond, transforms of sizes not divisible by 4 are slow
  for (;; n++) {
    if (n > kSmall && n % 4 != 0) continue;
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
  return std::make_unique<PswfSplit>(p.splitting * p.cutoff, p.cutoff);
}

std::unique_ptr<EwaldWindow> make_window(const EwaldParameters &p)
{
  if (p.method == EwaldMethod::Spme) return std::make_unique<BsplineWindow>(p.order);
  return std::make_unique<KaiserBesselWindow>(p.order, p.oversampling);
}

double compute_expected_error(const EwaldScene &s, const EwaldParameters &p)
{
  const AliasingTable table(*make_window(p));
  const BandSpectrum spectrum(*make_split(p), p.band_limit);
  const Vec3 lengths = worst_lengths(s);
  const double largest = SceneErrors(s).largest([&](const EwaldErrorModel &model) {
    double square = 0.0;
    if (p.method == EwaldMethod::Spme)
      square =
          std::pow(model.gaussian_real(p.splitting, p.cutoff), 2) +
          std::pow(model.gaussian_truncation(p.splitting, p.band_limit / (2.0 * p.splitting)), 2);
    else
      square = std::pow(model.pswf_truncation(p.splitting * p.cutoff, p.cutoff), 2);
    for (int a = 0; a < 3; a++)
      square += std::pow(model.aliasing(spectrum, table, lengths[a] / p.grid[a]), 2) / 3.0;
    return std::sqrt(square);
  });
  return s.error_factor * largest;
}

// With a split or grid fixed by the user, candidates need not meet the tolerance: those that do, or
// else the most accurate one, remain.
void prefer_accurate(const EwaldScene &s, std::vector<std::pair<double, EwaldParameters>> &found)
{
  std::vector<double> errors;
  for (const auto &candidate : found)
    errors.push_back(compute_expected_error(s, candidate.second));
  const double best = *std::min_element(errors.begin(), errors.end());
  const double allowed = std::max(s.tolerance, best);
  size_t kept = 0;
  for (size_t i = 0; i < found.size(); i++)
    if (errors[i] <= allowed) found[kept++] = found[i];
  found.resize(kept);
}

std::vector<EwaldParameters> rank_ewald_parameters(const EwaldScene &s, int n)
{
  check_scene(s);
  std::vector<std::pair<double, EwaldParameters>> found = Candidates(s).list();
  if (is_given(s)) prefer_accurate(s, found);
  std::stable_sort(found.begin(), found.end(),
                   [](const auto &a, const auto &b) { return a.first < b.first; });
  std::vector<EwaldParameters> result;
  for (const auto &[cost, p] : found) {
    if (static_cast<int>(result.size()) == n) break;
    auto is_similar = [&p = p](const EwaldParameters &q) {
      return q.order == p.order && std::fabs(std::log(q.cutoff / p.cutoff)) < kDistinctCutoffs;
    };
    if (std::any_of(result.begin(), result.end(), is_similar)) continue;
    result.push_back(p);
    result.back().expected_error = compute_expected_error(s, p);
  }
  return result;
}

EwaldParameters choose_ewald_parameters(const EwaldScene &s)
{
  return rank_ewald_parameters(s, 1).front();
}

}    // namespace biem
