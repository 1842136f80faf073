// Runge-Kutta-Chebyshev steps: see the header.
#include "biem_stepper_rkc.h"
#include "biem_error.h"
#include <algorithm>
#include <cmath>
#include <string>

namespace biem {

namespace {

constexpr double kDamping = 2.0 / 13.0;    // epsilon of the method's authors
constexpr double kStability = 0.65;        // of s^2 - 1: 2/3 (1 - 2/15 epsilon), rounded down
// Of the step that the estimate asks for; bounds of the change of a step.
constexpr double kSafety = 0.8, kLeastFactor = 0.1, kMostFactor = 5.0;
constexpr double kOrder = 3.0;    // of the local error

// Chebyshev polynomials of the first kind and their first two derivatives at x, degrees 0 to n.
struct Chebyshev {
  std::vector<double> t, d1, d2;

  Chebyshev(int n, double x) : t(n + 1), d1(n + 1), d2(n + 1)
  {
    t[0] = 1.0;
    t[1] = x;
    d1[1] = 1.0;
    for (int j = 2; j <= n; j++) {
      t[j] = 2.0 * x * t[j - 1] - t[j - 2];
      d1[j] = 2.0 * t[j - 1] + 2.0 * x * d1[j - 1] - d1[j - 2];
      d2[j] = 4.0 * d1[j - 1] + 2.0 * x * d2[j - 1] - d2[j - 2];
    }
  }
};

}    // namespace

std::vector<ChebyshevStage> compute_chebyshev_stages(int n_stages)
{
  if (n_stages < kLeastStages || n_stages > kMostStages)
    throw Error("a Runge-Kutta-Chebyshev step of " + std::to_string(n_stages) +
                " stages was asked for: " + std::to_string(kLeastStages) + " to " +
                std::to_string(kMostStages) + " are possible");
  const double w0 = 1.0 + kDamping / (n_stages * n_stages);
  const Chebyshev c(n_stages, w0);
  const double w1 = c.d1[n_stages] / c.d2[n_stages];
  auto b = [&](int j) {
    const int k = std::max(j, 2);
    return c.d2[k] / (c.d1[k] * c.d1[k]);
  };
  std::vector<ChebyshevStage> stages(n_stages + 1);
  stages[1].mu_tilde = stages[1].time = b(1) * w1;
  for (int j = 2; j <= n_stages; j++) {
    ChebyshevStage &s = stages[j];
    s.mu = 2.0 * w0 * b(j) / b(j - 1);
    s.nu = -b(j) / b(j - 2);
    s.mu_tilde = 2.0 * w1 * b(j) / b(j - 1);
    s.gamma_tilde = -(1.0 - b(j - 1) * c.t[j - 1]) * s.mu_tilde;
    s.time = w1 * c.d2[j] / c.d1[j];
  }
  stages[n_stages].time = 1.0;
  return stages;
}

double stability_limit(int n_stages)
{
  return kStability * (static_cast<double>(n_stages) * n_stages - 1.0);
}

int choose_stages(double dt, double radius)
{
  const double n = std::ceil(std::sqrt(1.0 + std::max(0.0, dt * radius) / kStability));
  return static_cast<int>(std::clamp<double>(n, kLeastStages, kMostStages + 1));
}

double StepController::choose_next(double dt, double error)
{
  const double now = std::max(error / tolerance_, 1e-12);
  double factor = std::pow(now, -1.0 / kOrder);
  // Follows the trend of the last two errors (Watts), where there is one.
  if (last_dt_ > 0.0 && last_error_ > 0.0) {
    const double before = std::max(last_error_ / tolerance_, 1e-12);
    factor = std::min(factor, factor * dt / last_dt_ * std::pow(before / now, 1.0 / kOrder));
  }
  set_last(dt, error);
  return std::min(largest_dt_, dt * std::clamp(kSafety * factor, kLeastFactor, kMostFactor));
}

double StepController::choose_again(double dt, double error) const
{
  const double factor =
      std::isfinite(error) ? std::pow(std::max(error / tolerance_, 1.0), -1.0 / kOrder) : 0.0;
  return dt * std::clamp(kSafety * factor, kLeastFactor, 0.5);
}

}    // namespace biem
