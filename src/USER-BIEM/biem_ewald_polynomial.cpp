// Polynomial interpolation: see the header.
#include "biem_ewald_polynomial.h"
#include <cmath>

namespace biem {

std::vector<double> interpolate_chebyshev(const std::function<double(double)> &f, int n)
{
  std::vector<double> sample(n), coefficients(n, 0.0);
  for (int j = 0; j < n; j++)
    sample[j] = f(std::cos(M_PI * (j + 0.5) / n));
  std::vector<double> cosine(4 * n);    // of pi i/(2 n): small arguments, no lost digits
  for (int i = 0; i < 4 * n; i++)
    cosine[i] = std::cos(M_PI * i / (2 * n));
  for (int k = 0; k < n; k++) {
    for (int j = 0; j < n; j++)
      coefficients[k] += sample[j] * cosine[k * (2 * j + 1) % (4 * n)];
    coefficients[k] *= (k == 0 ? 1.0 : 2.0) / n;
  }
  return coefficients;
}

std::vector<double> differentiate_chebyshev(const std::vector<double> &c)
{
  const int n = static_cast<int>(c.size());
  std::vector<double> d(n + 1, 0.0);
  for (int k = n - 1; k >= 1; k--)    // d_{k-1} = d_{k+1} + 2 k c_k
    d[k - 1] = d[k + 1] + 2.0 * k * c[k];
  d[0] *= 0.5;
  d.resize(n - 1);
  return d;
}

std::vector<double> to_monomials(const std::vector<double> &chebyshev, int degree)
{
  std::vector<double> result(degree + 1, 0.0), previous{1.0}, current{0.0, 1.0};
  result[0] = chebyshev[0];
  for (int k = 1; k <= degree; k++) {    // T_{k+1} = 2 v T_k - T_{k-1}
    for (size_t i = 0; i < current.size(); i++)
      result[i] += chebyshev[k] * current[i];
    std::vector<double> next(current.size() + 1, 0.0);
    for (size_t i = 0; i < current.size(); i++)
      next[i + 1] = 2.0 * current[i];
    for (size_t i = 0; i < previous.size(); i++)
      next[i] -= previous[i];
    previous = std::move(current);
    current = std::move(next);
  }
  return result;
}

}    // namespace biem
