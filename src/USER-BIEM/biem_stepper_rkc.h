// Runge-Kutta-Chebyshev steps of second order: coefficients for any number of stages, the number
// that a stiffness needs, the embedded error estimate and the choice of the next step.
// Pure functions; knows no nodes and no forces.
// Sommeijer, Shampine & Verwer, J. Comput. Appl. Math. 88, 315 (1997); doc/theory, label rkc2.
#ifndef BIEM_STEPPER_RKC_H
#define BIEM_STEPPER_RKC_H

#include "biem_types.h"
#include <vector>

namespace biem {

constexpr int kLeastStages = 2, kMostStages = 200;

// For y' = F(y), in displacements d_j = Y_j - y_n, with d_0 = 0 and F_j = F at stage j:
//   d_1 = h mu~_1 F_0,  d_j = mu_j d_{j-1} + nu_j d_{j-2} + h (mu~_j F_{j-1} + gamma~_j F_0),
// and the step ends with d_s.
struct ChebyshevStage {
  double mu = 0.0, nu = 0.0, mu_tilde = 0.0, gamma_tilde = 0.0;
  double time = 0.0;    // c_j: stage j is at t_n + c_j h; c_0 = 0, c_s = 1
};

// Displacement at stage j from those at the two before, and h F there and at the start.
inline Vec3 combine(const ChebyshevStage &stage, const Vec3 &last, const Vec3 &before,
                    const Vec3 &step_last, const Vec3 &step_start)
{
  return stage.mu * last + stage.nu * before + stage.mu_tilde * step_last +
         stage.gamma_tilde * step_start;
}

// Stages 0 to n_stages (kLeastStages to kMostStages; Error otherwise).
std::vector<ChebyshevStage> compute_chebyshev_stages(int n_stages);

// Fewest stages for which the eigenvalues in [-radius, 0] [1/time] are damped in a step dt; more
// than kMostStages where they would be needed. limit: the largest dt * radius of n_stages.
int choose_stages(double dt, double radius);
double stability_limit(int n_stages);

// The local error of a step h is about kErrorOfDisplacement d_s + kErrorOfRate h (F_0 + F_s).
constexpr double kErrorOfDisplacement = -0.8, kErrorOfRate = 0.4;

// Next step from the errors of the last ones: the local error is of third order in dt.
class StepController {
 public:
  StepController(double tolerance, double largest_dt) :
      tolerance_(tolerance), largest_dt_(largest_dt)
  {
  }
  void set_largest(double dt) { largest_dt_ = dt; }
  bool is_accepted(double error) const { return error <= tolerance_; }
  // After a step dt with this error: the dt of the next step, or of the same one again.
  double choose_next(double dt, double error);
  double choose_again(double dt, double error) const;

  // Error and length of the last step that was accepted, for restarts.
  double last_error() const { return last_error_; }
  double last_dt() const { return last_dt_; }
  void set_last(double dt, double error)
  {
    last_dt_ = dt;
    last_error_ = error;
  }

 private:
  double tolerance_, largest_dt_;
  double last_error_ = 0.0, last_dt_ = 0.0;    // 0: none yet
};

}    // namespace biem

#endif
