// Direct Ewald sums: see the header. The real part costs O(n_t n_s), the Fourier part
// O((n_t + n_s) n_k); the default splitting balances them.
#include "biem_oracle_periodic.h"
#include "biem_error.h"
#include <algorithm>
#include <cmath>
#include <complex>

namespace biem {

namespace {

constexpr double kDecay = 6.2;    // exp(-kDecay^2) = 2e-17
const double kSqrtPi = std::sqrt(M_PI);

using Strengths = Eigen::MatrixXd;      // n_columns x n_s
using Amplitudes = Eigen::VectorXcd;    // of the strengths at one wave vector

double choose_splitting(const Mat3 &cell, Eigen::Index n_targets, Eigen::Index n_sources)
{
  // A real term costs about ten Fourier terms; xi^3 V is the ratio of the volumes of the two sums.
  const double pairs = static_cast<double>(n_targets) * n_sources / (n_targets + n_sources);
  const double s = std::clamp(std::pow(300.0 * pairs, 1.0 / 6.0), kSqrtPi, 8.0);
  return s / std::cbrt(std::fabs(cell.determinant()));
}

Eigen::Vector3i count_vectors(const Mat3 &lattice, double radius)
{
  Eigen::Vector3i count;    // |n_a| <= radius / distance of the lattice planes
  const Mat3 dual = lattice.inverse();
  for (int a = 0; a < 3; a++)
    count[a] = static_cast<int>(std::ceil(radius * dual.row(a).norm()));
  return count;
}

// Lattice vectors within radius of the origin.
std::vector<Vec3> list_lattice(const Mat3 &cell, double radius)
{
  const Eigen::Vector3i count = count_vectors(cell, radius);
  std::vector<Vec3> vectors;
  for (int i = -count[0]; i <= count[0]; i++)
    for (int j = -count[1]; j <= count[1]; j++)
      for (int k = -count[2]; k <= count[2]; k++) {
        const Vec3 v = cell * Vec3(i, j, k);
        if (v.norm() <= radius) vectors.push_back(v);
      }
  return vectors;
}

// Calls add(t, s, r, |r|) for every image of every pair with |r| <= cutoff; |r| = 0 if they
// coincide up to rounding.
template <class Add>
void for_each_image(const Mat3 &cell, PointsView targets, PointsView sources, double cutoff,
                    const Add &add)
{
  const Mat3 inverse = cell.inverse();
  const double half_diagonal = 0.5 * cell.colwise().norm().sum();
  const std::vector<Vec3> lattice = list_lattice(cell, cutoff + half_diagonal);
  const double zero = 1e-13 * cell.norm(), cutoff2 = cutoff * cutoff;
  for (Eigen::Index t = 0; t < targets.cols(); t++)
    for (Eigen::Index s = 0; s < sources.cols(); s++) {
      const Vec3 far = targets.col(t) - sources.col(s);
      const Vec3 turns = (inverse * far).array().round();
      const Vec3 nearest = far - cell * turns;
      for (const Vec3 &v : lattice) {
        const Vec3 r = nearest + v;
        const double r2 = r.squaredNorm();
        if (r2 <= cutoff2) add(t, s, r, r2 < zero * zero ? 0.0 : std::sqrt(r2));
      }
    }
}

// exp(i k.x) of all points at one wave vector, as real and imaginary parts.
struct Phases {
  Eigen::ArrayXd re, im;

  static Phases product(const Phases &a, const Phases &b)
  {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
};

// Plane waves exp(2 pi i n s_a) of the fractional coordinates s of the points, |n| <= count.
class PlaneWaves {
 public:
  PlaneWaves(const Mat3 &cell, PointsView points, const Eigen::Vector3i &count) : count_(count)
  {
    Points s = cell.inverse() * points;
    s.array() -= s.array().round();    // far points keep their digits
    for (int a = 0; a < 3; a++)
      for (int n = -count[a]; n <= count[a]; n++) {
        const Eigen::ArrayXd angle = 2.0 * M_PI * n * s.row(a).transpose().array();
        waves_[a].push_back({angle.cos(), angle.sin()});
      }
  }
  const Phases &wave(int axis, int n) const { return waves_[axis][n + count_[axis]]; }

 private:
  Eigen::Vector3i count_;
  std::vector<Phases> waves_[3];
};

// u += sum over k of Re[project(k, sum_s strengths exp(-i k.y)) exp(i k.x)] for 0 < |k| <= limit;
// project returns the complex velocity of a wave vector, conjugate for -k.
template <class Project>
void add_waves(const Mat3 &cell, PointsView targets, PointsView sources, const Strengths &strengths,
               double limit, const Project &project, Points &u)
{
  const Mat3 reciprocal = 2.0 * M_PI * cell.inverse().transpose();
  const Eigen::Vector3i count = count_vectors(reciprocal, limit);
  const PlaneWaves at_targets(cell, targets, count), at_sources(cell, sources, count);
  for (int i = 0; i <= count[0]; i++)
    for (int j = i > 0 ? -count[1] : 0; j <= count[1]; j++) {
      const Phases target_plane = Phases::product(at_targets.wave(0, i), at_targets.wave(1, j));
      const Phases source_plane = Phases::product(at_sources.wave(0, i), at_sources.wave(1, j));
      for (int l = i > 0 || j > 0 ? -count[2] : 1; l <= count[2]; l++) {
        const Vec3 k = reciprocal * Vec3(i, j, l);
        if (k.squaredNorm() > limit * limit) continue;
        const Phases y = Phases::product(source_plane, at_sources.wave(2, l));
        Amplitudes amplitudes(strengths.rows());
        amplitudes.real() = strengths * y.re.matrix();
        amplitudes.imag() = -(strengths * y.im.matrix());
        const Eigen::Vector3cd w = 2.0 * project(k, amplitudes);    // k and -k
        const Phases x = Phases::product(target_plane, at_targets.wave(2, l));
        u.noalias() += w.real() * x.re.matrix().transpose();
        u.noalias() -= w.imag() * x.im.matrix().transpose();
      }
    }
}

// Hasimoto's split function.
double compute_screening(double k2, double xi)
{
  const double q = k2 / (4.0 * xi * xi);
  return (1.0 + q) * std::exp(-q);
}

void check_oracle(const Mat3 &cell, Eigen::Index n_sources, Eigen::Index n_strengths)
{
  if (!(std::fabs(cell.determinant()) > 0.0))
    throw Error("periodic oracle: the volume of the cell is " + std::to_string(cell.determinant()) +
                "; give three independent lattice vectors as the columns of the cell");
  if (n_sources != n_strengths)
    throw Error("periodic oracle: " + std::to_string(n_sources) + " sources but " +
                std::to_string(n_strengths) + " strengths or normals; give one column per source");
}

}    // namespace

Points compute_oracle_single_layer(const Mat3 &cell, PointsView targets, PointsView sources,
                                   PointsView forces, double splitting)
{
  check_oracle(cell, sources.cols(), forces.cols());
  Points u = Points::Zero(3, targets.cols());
  if (targets.cols() == 0 || sources.cols() == 0) return u;
  const double xi = splitting > 0.0 ? splitting
                                    : choose_splitting(cell, targets.cols(), sources.cols());
  const auto add_real = [&](Eigen::Index t, Eigen::Index s, const Vec3 &r, double d) {
    if (d == 0.0) {    // minus the smooth part at r = 0
      u.col(t) -= 4.0 * xi / kSqrtPi * forces.col(s);
      return;
    }
    const double e = std::erfc(xi * d) / d;
    const double g = 2.0 * xi / kSqrtPi * std::exp(-xi * xi * d * d);
    u.col(t) += (e - g) * forces.col(s) + (e + g) / (d * d) * r.dot(forces.col(s)) * r;
  };
  for_each_image(cell, targets, sources, kDecay / xi, add_real);

  const double volume = std::fabs(cell.determinant());
  const auto project = [&](const Vec3 &k, const Amplitudes &f) -> Eigen::Vector3cd {
    const double k2 = k.squaredNorm();
    const std::complex<double> along = k.x() * f[0] + k.y() * f[1] + k.z() * f[2];
    const double factor = 8.0 * M_PI / (k2 * volume) * compute_screening(k2, xi);
    return factor * (f - k * (along / k2));
  };
  add_waves(cell, targets, sources, forces, 2.0 * kDecay * xi, project, u);
  return u;
}

Points compute_oracle_double_layer(const Mat3 &cell, PointsView targets, PointsView sources,
                                   PointsView densities, PointsView normals, double splitting)
{
  check_oracle(cell, sources.cols(), densities.cols());
  check_oracle(cell, sources.cols(), normals.cols());
  Points u = Points::Zero(3, targets.cols());
  if (targets.cols() == 0 || sources.cols() == 0) return u;
  const double xi = splitting > 0.0 ? splitting
                                    : choose_splitting(cell, targets.cols(), sources.cols());
  const Eigen::RowVectorXd flux = (densities.array() * normals.array()).colwise().sum();

  // -6 rrr/r^5 a + (delta_jk r_i + delta_ik r_j + delta_ij r_k) b, the derivative of the split S
  const auto add_real = [&](Eigen::Index t, Eigen::Index s, const Vec3 &r, double d) {
    if (d == 0.0) return;    // the smooth part is odd in r
    const double x = xi * d, g = std::exp(-x * x);
    const double a = std::erfc(x) + 2.0 * x / (3.0 * kSqrtPi) * (3.0 + 2.0 * x * x) * g;
    const double b = 4.0 * xi * xi * xi / kSqrtPi * g;
    const double rq = r.dot(densities.col(s)), rn = r.dot(normals.col(s));
    u.col(t) += (b * flux[s] - 6.0 * a / std::pow(d, 5) * rq * rn) * r;
    u.col(t) += b * (rn * densities.col(s) + rq * normals.col(s));
  };
  for_each_image(cell, targets, sources, kDecay / xi, add_real);

  Strengths symmetric(6, sources.cols());    // (q n + n q) / 2 as xx, yy, zz, yz, xz, xy
  for (int a = 0; a < 3; a++) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    symmetric.row(a) = densities.row(a).cwiseProduct(normals.row(a));
    symmetric.row(3 + a) = 0.5 * densities.row(b).cwiseProduct(normals.row(c));
    symmetric.row(3 + a) += 0.5 * densities.row(c).cwiseProduct(normals.row(b));
  }
  const double volume = std::fabs(cell.determinant());
  // (8 pi i / k^4) [k^2 (k tr D + 2 D k) - 2 k (k.D.k)] gamma
  const auto project = [&](const Vec3 &k, const Amplitudes &d) -> Eigen::Vector3cd {
    const double k2 = k.squaredNorm();
    Eigen::Matrix3cd matrix;
    matrix << d[0], d[5], d[4], d[5], d[1], d[3], d[4], d[3], d[2];
    const Eigen::Vector3cd dk = matrix * k;
    const std::complex<double> kdk = k.x() * dk[0] + k.y() * dk[1] + k.z() * dk[2];
    const std::complex<double> factor(0.0, 8.0 * M_PI / (k2 * volume) * compute_screening(k2, xi));
    return factor * (2.0 * dk + k * (d[0] + d[1] + d[2] - 2.0 * kdk / k2));
  };
  add_waves(cell, targets, sources, symmetric, 2.0 * kDecay * xi, project, u);

  u.colwise() += 8.0 * M_PI / volume * (sources * flux.transpose());
  u -= 8.0 * M_PI / volume * flux.sum() * targets;
  return u;
}

}    // namespace biem
