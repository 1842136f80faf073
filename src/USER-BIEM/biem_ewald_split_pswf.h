// Split of the periodic Stokeslet sum by the prolate spheroidal wave function of order 0: the
// function of finite support whose Fourier transform is the most concentrated. Cutoff and band
// limit are sharp, and their product c alone sets the error. af Klinteberg, Greengard, Jiang &
// Tornberg, arXiv 2509.21471. doc/theory, label ewald-split.
#ifndef BIEM_EWALD_SPLIT_PSWF_H
#define BIEM_EWALD_SPLIT_PSWF_H

#include "biem_ewald_split.h"
#include <Eigen/Dense>

namespace biem {

class PswfSplit : public EwaldSplit {
 public:
  // bandwidth c = cutoff * band limit, dimensionless; cutoff [length].
  PswfSplit(double bandwidth, double cutoff);

  double fourier_factor(double k2) const override;
  double mollified_slope(double r) const override;
  double truncated_self(double k_max) const override;

 private:
  double continue_wave(double t, double &derivative) const;

  double bandwidth_, cutoff_;
  std::vector<double> wave_;                           // psi(t), Legendre coefficients on [-1, 1]
  std::vector<double> derivative_;                     // psi'(t)
  double at_zero_, total_;                             // psi(0), int_{-1}^{1} psi
  Eigen::VectorXd nodes_, weights_, weighted_wave_;    // quadrature on [0, 1]; weights * psi
};

}    // namespace biem

#endif
