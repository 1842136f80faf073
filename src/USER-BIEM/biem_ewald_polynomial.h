// Polynomial interpolation on [-1, 1]: Chebyshev coefficients, and their monomial form for Horner's
// scheme. Knows nothing of what is interpolated.
#ifndef BIEM_EWALD_POLYNOMIAL_H
#define BIEM_EWALD_POLYNOMIAL_H

#include <functional>
#include <vector>

namespace biem {

// Coefficients of T_0 ... T_{n-1} of the polynomial through f at the n Chebyshev points.
std::vector<double> interpolate_chebyshev(const std::function<double(double)> &f, int n);

// Coefficients of the derivative of sum c_k T_k, one fewer.
std::vector<double> differentiate_chebyshev(const std::vector<double> &chebyshev);

// Monomial coefficients of sum c_k T_k, k <= degree.
std::vector<double> to_monomials(const std::vector<double> &chebyshev, int degree);

}    // namespace biem

#endif
