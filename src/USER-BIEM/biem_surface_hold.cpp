// Held volume and area: see the header.
#include "biem_surface_hold.h"
#include "biem_error.h"
#include <cmath>

namespace biem {

namespace {

// Sums over the nodes of one cell; with u the velocity, n = g_V/|g_V| and x the nodes:
enum Sum {
  kVolumeFlux,    // u.g_V
  kVolumeSize,    // n.g_V
  kNVolumeSums,
  kAreaFlux = kNVolumeSums,    // u.g_A
  kAreaOfNormal,               // n.g_A
  kNodes,                      // 1
  kCenter,                     // x
  kMoment = kCenter + 3,       // g_A x: symmetric, because no rotation changes the area
  kNAreaSums = kMoment + 9
};

// u -= alpha n + strain (x - center).
struct Correction {
  double alpha = 0.0;
  Mat3 strain = Mat3::Zero();
  Vec3 center = Vec3::Zero();
};

std::vector<double> sum_up(const HeldGeometry &g, PointsView velocity, int n_sums, size_t n_cells)
{
  std::vector<double> sums(n_sums * n_cells, 0.0);
  for (Eigen::Index i = 0; i < velocity.cols(); i++) {
    if (g.cell_of_node[i] < 0) continue;
    double *sum = &sums[n_sums * g.cell_of_node[i]];
    const Vec3 u = velocity.col(i), volume_gradient = g.volume_gradient.col(i);
    const double size = volume_gradient.norm();
    sum[kVolumeFlux] += u.dot(volume_gradient);
    sum[kVolumeSize] += size;
    if (n_sums == kNVolumeSums) continue;
    const Vec3 area_gradient = g.area_gradient.col(i), x = g.nodes.col(i);
    sum[kAreaFlux] += u.dot(area_gradient);
    if (size > 0.0) sum[kAreaOfNormal] += volume_gradient.dot(area_gradient) / size;
    sum[kNodes] += 1.0;
    Eigen::Map<Vec3>(sum + kCenter) += x;
    Eigen::Map<Mat3>(sum + kMoment) += area_gradient * x.transpose();
  }
  return sums;
}

// Adds the strain to a correction of the volume. area_rate: wanted.
void add_area(const double *sum, const Mat3 &flow_gradient, double area_rate,
              Correction &correction)
{
  const Eigen::Map<const Mat3> moment(sum + kMoment);
  const double twice_area = moment.trace();
  const Mat3 anisotropy = 0.5 * (moment + moment.transpose()) - twice_area / 3.0 * Mat3::Identity();
  if (!(anisotropy.norm() >= kLeastAnisotropy * 0.5 * twice_area)) return;
  const double excess = sum[kAreaFlux] + flow_gradient.cwiseProduct(anisotropy).sum() -
                        correction.alpha * sum[kAreaOfNormal] - area_rate;
  correction.strain = excess / anisotropy.squaredNorm() * anisotropy;
  correction.center = Eigen::Map<const Vec3>(sum + kCenter) / sum[kNodes];
}

}    // namespace

Hold parse_hold(const std::string &name)
{
  if (name == "none") return Hold::None;
  if (name == "volume") return Hold::Volume;
  if (name == "area") return Hold::VolumeAndArea;
  throw Error("cannot hold '" + name + "': choose none, volume or area (volume and area)");
}

void project_held(const HeldCells &cells, const HeldGeometry &g, NodeExchange &exchange,
                  PointsRef velocity)
{
  if (cells.hold == Hold::None) return;
  const bool has_area = cells.hold == Hold::VolumeAndArea;
  const int n_sums = has_area ? kNAreaSums : kNVolumeSums;
  const size_t n_cells = cells.reference_volume.size();
  std::vector<double> sums = sum_up(g, velocity, n_sums, n_cells);
  exchange.sum(sums.data(), static_cast<int>(sums.size()));
  std::vector<Correction> corrections(n_cells);
  for (size_t c = 0; c < n_cells; c++) {
    const double *sum = &sums[n_sums * c];
    const double volume_rate =
        cells.relaxation_rate * (cells.reference_volume[c] - cells.volume[c]);
    corrections[c].alpha = (sum[kVolumeFlux] - volume_rate) / sum[kVolumeSize];
    if (has_area)
      add_area(sum, g.flow_gradient,
               cells.relaxation_rate * (cells.reference_area[c] - cells.area[c]), corrections[c]);
  }
  for (Eigen::Index i = 0; i < velocity.cols(); i++) {
    const double size = g.volume_gradient.col(i).norm();
    if (g.cell_of_node[i] < 0 || size == 0.0) continue;
    const Correction &k = corrections[g.cell_of_node[i]];
    velocity.col(i) -= k.alpha / size * g.volume_gradient.col(i);
    if (has_area) velocity.col(i) -= k.strain * (g.nodes.col(i) - k.center);
  }
}

}    // namespace biem
