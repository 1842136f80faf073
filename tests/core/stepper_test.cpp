// Time steppers on ordinary differential equations of known solution: orders, stability, stages,
// error estimate and choice of the step.
#include "biem_error.h"
#include "biem_stepper.h"
#include "biem_stepper_rkc.h"
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

using namespace biem;

namespace {

using Rate = std::function<Vec3(double t, const Vec3 &y)>;

struct Problem {
  const char *name;
  Rate rate;
  std::function<Vec3(double t)> exact;
};

Vec3 curve(double t)
{
  return {std::sin(t), 0.5 * std::cos(2.0 * t), std::exp(-t)};
}

Vec3 curve_rate(double t)
{
  return {std::cos(t), -std::sin(2.0 * t), -std::exp(-t)};
}

Vec3 nonlinear(const Vec3 &y)
{
  return y.cross(Vec3(2.0 * y[0], -y[1], 0.5 * y[2])) - y.squaredNorm() * y;
}

// One without time (logistic growth), one with, of which the solution is the curve.
std::vector<Problem> make_problems()
{
  const Vec3 start(0.1, 0.4, 1.5);
  return {{"without time",
           [](double, const Vec3 &y) { return Vec3(y.array() * (1.0 - y.array())); },
           [start](double t) {
             return Vec3(1.0 / (1.0 + (1.0 / start.array() - 1.0) * std::exp(-t)));
           }},
          {"with time",
           [](double t, const Vec3 &y) {
             return Vec3(curve_rate(t) + nonlinear(y) - nonlinear(curve(t)));
           },
           curve}};
}

// Displacement of one step; times: of the stages, where rate was asked for.
Vec3 take_chebyshev_step(const std::vector<ChebyshevStage> &stages, const Rate &rate, double t,
                         const Vec3 &y, double h)
{
  const Vec3 start = h * rate(t, y);
  Vec3 before = Vec3::Zero(), last = combine(stages[1], before, before, start, start);
  for (size_t j = 2; j < stages.size(); j++) {
    const Vec3 now = h * rate(t + stages[j - 1].time * h, y + last);
    const Vec3 next = combine(stages[j], last, before, now, start);
    before = last;
    last = next;
  }
  return last;
}

// Error at time 2 after n_steps, of which every second one is longer by this ratio.
double compute_chebyshev_error(const Problem &problem, int n_stages, int n_steps, double ratio)
{
  const auto stages = compute_chebyshev_stages(n_stages);
  Vec3 y = problem.exact(0.0);
  double t = 0.0;
  for (int k = 0; k < n_steps; k++) {
    const double h = 4.0 / n_steps / (1.0 + ratio) * (k % 2 ? ratio : 1.0);
    y += take_chebyshev_step(stages, problem.rate, t, y, h);
    t += h;
  }
  return (y - problem.exact(2.0)).norm();
}

double compute_multistep_error(const Problem &problem, Stepper stepper, int n_steps, double ratio)
{
  Vec3 y = problem.exact(0.0), previous = Vec3::Zero();
  double t = 0.0, previous_dt = 0.0;
  for (int k = 0; k < n_steps; k++) {
    const double h = 4.0 / n_steps / (1.0 + ratio) * (k % 2 ? ratio : 1.0);
    const Vec3 now = problem.rate(t, y);
    y += compute_displacement(stepper, now, previous, h, previous_dt);
    previous = now;
    previous_dt = h;
    t += h;
  }
  return (y - problem.exact(2.0)).norm();
}

// Factor by which a step of y' = z y changes y, h = 1.
double compute_amplification(const std::vector<ChebyshevStage> &stages, double z)
{
  const Rate rate = [z](double, const Vec3 &y) {
    return Vec3(z * y);
  };
  return 1.0 + take_chebyshev_step(stages, rate, 0.0, Vec3::UnitX(), 1.0)[0];
}

const std::vector<int> kStageNumbers = {2, 3, 5, 10, 20, 60, kMostStages};

}    // namespace

TEST(Steppers, EulerIsOfFirstAndAdamsBashforthOfSecondOrder)
{
  for (const Problem &problem : make_problems())
    for (double ratio : {1.0, 2.0}) {
      const auto order = [&](Stepper stepper) {
        return std::log2(compute_multistep_error(problem, stepper, 400, ratio) /
                         compute_multistep_error(problem, stepper, 800, ratio));
      };
      EXPECT_NEAR(order(Stepper::Euler), 1.0, 0.1) << problem.name << ", ratio " << ratio;
      EXPECT_NEAR(order(Stepper::AdamsBashforth2), 2.0, 0.1) << problem.name << ", ratio " << ratio;
    }
}

TEST(ChebyshevSteps, AreOfSecondOrderForAnyNumberOfStages)
{
  for (const Problem &problem : make_problems())
    for (int s : {2, 5, 10, 20})
      for (double ratio : {1.0, 2.0}) {
        const double coarse = compute_chebyshev_error(problem, s, 80, ratio);
        const double fine = compute_chebyshev_error(problem, s, 160, ratio);
        std::printf("  %s, %d stages, ratio %g: %.2e %.2e order %.3f\n", problem.name, s, ratio,
                    coarse, fine, std::log2(coarse / fine));
        EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1)
            << problem.name << ", " << s << " stages, ratio " << ratio;
        EXPECT_LT(fine, 1e-3);
      }
}

TEST(ChebyshevSteps, StagesAreAtTheirTimes)
{
  for (int s : kStageNumbers) {
    const auto stages = compute_chebyshev_stages(s);
    ASSERT_EQ(stages.size(), static_cast<size_t>(s) + 1);
    EXPECT_EQ(stages.front().time, 0.0);
    EXPECT_EQ(stages.back().time, 1.0);
    // y' = 1 arrives at t = c_j, y' = 2 t at t^2 from the second stage on.
    const double h = 0.3;
    double line[3] = {0.0, h * stages[1].mu_tilde, 0.0}, parabola[3] = {0.0, 0.0, 0.0};
    EXPECT_NEAR(line[1], h * stages[1].time, 1e-15);
    for (int j = 2; j <= s; j++) {
      const ChebyshevStage &c = stages[j];
      EXPECT_GT(c.time, stages[j - 1].time) << s << " stages, stage " << j;
      line[2] = c.mu * line[1] + c.nu * line[0] + h * (c.mu_tilde + c.gamma_tilde);
      parabola[2] =
          c.mu * parabola[1] + c.nu * parabola[0] + h * c.mu_tilde * 2.0 * stages[j - 1].time * h;
      EXPECT_NEAR(line[2], h * c.time, 1e-12) << s << " stages, stage " << j;
      for (double *y : {line, parabola}) {
        y[0] = y[1];
        y[1] = y[2];
      }
    }
    EXPECT_NEAR(parabola[2], h * h, 1e-11) << s << " stages";
  }
}

TEST(ChebyshevSteps, ConstantRateIsExact)
{
  const Vec3 rate(0.3, -2.0, 50.0);
  for (int s : kStageNumbers) {
    const Vec3 d = take_chebyshev_step(
        compute_chebyshev_stages(s), [&](double, const Vec3 &) { return rate; }, 0.0,
        Vec3(1.0, 2.0, 3.0), 0.7);
    EXPECT_LT((d - 0.7 * rate).norm(), 1e-12 * rate.norm()) << s << " stages";
  }
}

TEST(ChebyshevSteps, AreStableOnTheirRealIntervalAndDampedInsideIt)
{
  for (int s : kStageNumbers) {
    const auto stages = compute_chebyshev_stages(s);
    const double limit = stability_limit(s);
    EXPECT_NEAR(limit, 0.65 * (s * s - 1.0), 1e-9 * limit);
    double largest = 0.0, smallest = 1.0;    // where the polynomial oscillates
    for (int k = 1; k <= 4000; k++) {
      const double z = -limit * k / 4000.0, p = compute_amplification(stages, z);
      ASSERT_LE(std::fabs(p), 1.0) << s << " stages, z " << z;
      if (z > -0.06) continue;
      largest = std::max(largest, p);
      smallest = std::min(smallest, p);
    }
    std::printf("  %d stages: %.4f to %.4f on [%.4g, -0.06]\n", s, smallest, largest, -limit);
    EXPECT_LT(largest, 0.97) << s << " stages";    // 1 - epsilon/3 with epsilon = 2/13
    EXPECT_GT(smallest, 0.3) << s << " stages";
    // It ends there; an odd polynomial has to change its sign first.
    const double outside = s % 2 ? -1.4 * limit : -1.05 * limit;
    EXPECT_GT(std::fabs(compute_amplification(stages, outside)), 1.0) << s << " stages";
  }
}

TEST(ChebyshevSteps, AreStableWithComplexEigenvaluesNearTheAxis)
{
  // A damped rotation in x-y: eigenvalues z (1 +- 0.1 i) need not blow up inside the interval.
  for (int s : {5, 10, 20}) {
    const auto stages = compute_chebyshev_stages(s);
    for (int k = 1; k <= 1000; k++) {
      const double z = -0.95 * stability_limit(s) * k / 1000.0;
      const double w = std::min(0.1 * std::fabs(z), 0.2);
      const Rate rate = [z, w](double, const Vec3 &y) {
        return Vec3(z * y[0] - w * y[1], w * y[0] + z * y[1], 0.0);
      };
      const Vec3 y = Vec3::UnitX() + take_chebyshev_step(stages, rate, 0.0, Vec3::UnitX(), 1.0);
      ASSERT_LT(y.norm(), 1.0) << s << " stages, z " << z;
    }
  }
}

TEST(ChebyshevSteps, StiffProblemIsFollowedWithStepsFarBeyondEulers)
{
  // y' = g' - r (y - g) with r dt = 60, where an Euler step multiplies errors by -59.
  const double radius = 600.0, dt = 0.1;
  const int s = choose_stages(dt, radius);
  EXPECT_EQ(s, 10);
  const auto stages = compute_chebyshev_stages(s);
  const Rate rate = [radius](double t, const Vec3 &y) {
    return Vec3(curve_rate(t) - radius * (y - curve(t)));
  };
  Vec3 y = curve(0.0) + Vec3(0.01, -0.01, 0.02);
  for (int k = 0; k < 200; k++)
    y += take_chebyshev_step(stages, rate, k * dt, y, dt);
  EXPECT_LT((y - curve(20.0)).norm(), 1e-3);
}

TEST(ChebyshevSteps, StagesAreTheFewestThatAreStable)
{
  for (double product : {0.0, 0.3, 1.9, 2.0, 14.0, 33.0, 36.0, 350.0, 9999.0}) {
    const int s = choose_stages(0.1, 10.0 * product);
    EXPECT_GE(stability_limit(s), product);
    if (s > kLeastStages) EXPECT_LT(stability_limit(s - 1), product) << product;
  }
  EXPECT_EQ(choose_stages(0.1, 0.0), kLeastStages);
  EXPECT_EQ(choose_stages(1.0, 1.01 * stability_limit(kMostStages)), kMostStages + 1);
  EXPECT_EQ(choose_stages(1.0, 1e300), kMostStages + 1);
  EXPECT_THROW(compute_chebyshev_stages(kLeastStages - 1), Error);
  EXPECT_THROW(compute_chebyshev_stages(kMostStages + 1), Error);
}

TEST(ChebyshevSteps, EstimateIsOfThirdOrderAndBoundsTheErrorOfAStep)
{
  for (int s : {2, 5, 10, 20}) {
    const auto stages = compute_chebyshev_stages(s);
    const auto estimate = [&](double z) {
      const double p = compute_amplification(stages, z);
      return kErrorOfDisplacement * (p - 1.0) + kErrorOfRate * z * (1.0 + p);
    };
    for (double z : {-0.01, -0.1, -0.5}) {    // 0.2 - 0.8 c over 1/6 - c, c the factor of z^3
      const double error = std::exp(z) - compute_amplification(stages, z);
      EXPECT_GT(estimate(z) / error, 1.0) << s << " stages, z " << z;
      EXPECT_LT(estimate(z) / error, 2.0) << s << " stages, z " << z;
    }
    EXPECT_NEAR(std::log2(estimate(-0.01) / estimate(-0.005)), 3.0, 0.05) << s << " stages";
  }
}

TEST(StepController, GoesToTheStepOfItsToleranceWithoutOscillation)
{
  const double tolerance = 1e-4, wanted = 0.01;    // error = tolerance at this step
  for (double first : {1e-5, 1e-3, 0.009}) {
    StepController controller(tolerance, 1.0);
    double dt = first;
    std::vector<double> steps;
    for (int k = 0; k < 60; k++) {
      const double error = tolerance * std::pow(dt / wanted, 3);
      ASSERT_TRUE(controller.is_accepted(error)) << "step " << k << " of " << dt;
      const double next = controller.choose_next(dt, error);
      EXPECT_LE(next, 5.0001 * dt);
      steps.push_back(dt = next);
    }
    for (size_t k = 1; k < steps.size(); k++)    // no step back by more than a tenth
      EXPECT_GT(steps[k], 0.9 * steps[k - 1]) << "first " << first << ", step " << k;
    for (size_t k = 20; k < steps.size(); k++)
      EXPECT_NEAR(steps[k], steps.back(), 0.02 * wanted) << "first " << first << ", step " << k;
    EXPECT_GT(steps.back(), 0.5 * wanted);
    EXPECT_LT(steps.back(), wanted);
  }
}

TEST(StepController, RefusedStepIsHalvedAtLeast)
{
  const StepController controller(1e-3, 1.0);
  EXPECT_FALSE(controller.is_accepted(1.01e-3));
  EXPECT_FALSE(controller.is_accepted(NAN));
  EXPECT_DOUBLE_EQ(controller.choose_again(0.1, 1.01e-3), 0.05);
  EXPECT_NEAR(controller.choose_again(0.1, 64e-3), 0.1 * 0.8 / 4.0, 1e-15);
  for (double error : {1e3, double(INFINITY), double(NAN)})
    EXPECT_DOUBLE_EQ(controller.choose_again(0.1, error), 0.01) << error;
}

TEST(StepController, ErrorsFarBelowTheToleranceDoNotShortenTheStep)
{
  // As a suspension starts to move from equilibrium: errors from rounding upwards.
  StepController controller(1e-3, 1.0);
  double dt = 0.01;
  for (double error = 1e-60; error < 1e-18; error *= 1e5) {
    const double next = controller.choose_next(dt, error);
    EXPECT_GE(next, dt) << "error " << error;
    dt = next;
  }
}

TEST(StepController, MaximumIsRespectedAndMayChange)
{
  StepController controller(1e-3, 0.02);
  double dt = 0.005;
  for (int k = 0; k < 10; k++) {
    dt = controller.choose_next(dt, 0.0);
    EXPECT_LE(dt, 0.02);
  }
  EXPECT_EQ(dt, 0.02);
  controller.set_largest(0.004);
  EXPECT_EQ(controller.choose_next(dt, 0.0), 0.004);
}

TEST(StepController, HistoryContinuesExactly)
{
  StepController controller(1e-3, 1.0), restarted(1e-3, 1.0);
  controller.choose_next(0.01, 2e-4);
  controller.choose_next(0.013, 7e-4);
  restarted.set_last(controller.last_dt(), controller.last_error());
  const double next = controller.choose_next(0.012, 9e-4);
  EXPECT_EQ(next, restarted.choose_next(0.012, 9e-4));
  StepController unaware(1e-3, 1.0);
  EXPECT_NE(next, unaware.choose_next(0.012, 9e-4));
}

TEST(StepController, ErrorFollowsTheTolerance)
{
  // A pulse: fast about t = 5, slow elsewhere; y' = p' - (y - p)(1 + p) with the solution p.
  const auto pulse = [](double t) {
    return std::exp(-20.0 * (t - 5.0) * (t - 5.0));
  };
  const Rate rate = [&](double t, const Vec3 &y) {
    const double p = pulse(t);
    return Vec3(-(y[0] - p) * (1.0 + p) - 40.0 * (t - 5.0) * p, 0.0, 0.0);
  };
  const auto stages = compute_chebyshev_stages(6);
  double errors[2];
  for (int level = 0; level < 2; level++) {
    StepController controller(level ? 1e-6 : 1e-4, 0.3);
    double t = 0.0, dt = 0.3, shortest = 1.0;
    int n_accepted = 0, n_refused = 0;
    Vec3 y(pulse(0.0), 0.0, 0.0);
    errors[level] = 0.0;
    while (t < 10.0 - 1e-9 && n_accepted + n_refused < 10000) {
      const Vec3 d = take_chebyshev_step(stages, rate, t, y, dt);
      const double error =
          (kErrorOfDisplacement * d + kErrorOfRate * dt * (rate(t, y) + rate(t + dt, y + d)))
              .norm();
      if (!controller.is_accepted(error)) {
        dt = controller.choose_again(dt, error);
        n_refused++;
        continue;
      }
      t += dt;
      y += d;
      n_accepted++;
      errors[level] = std::max(errors[level], std::fabs(y[0] - pulse(t)));
      shortest = std::min(shortest, dt);
      dt = std::min(controller.choose_next(dt, error), 10.0 - t);
    }
    std::printf("  %d steps, %d refused, shortest %.4f, error %.1e\n", n_accepted, n_refused,
                shortest, errors[level]);
    EXPECT_LT(n_refused, n_accepted / 4);
    EXPECT_LT(shortest, 0.1);
  }
  EXPECT_LT(errors[0], 1e-3);
  // A tolerance of the error per step: the error falls as its power of 2/3.
  EXPECT_NEAR(std::log10(errors[0] / errors[1]), 4.0 / 3.0, 0.4);
}
