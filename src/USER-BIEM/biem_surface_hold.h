// Volume and area of each cell held by a projection of the velocities: removes what would change
// them, up to what restores the reference values. Knows no forces, no operators and no time step.
#ifndef BIEM_SURFACE_HOLD_H
#define BIEM_SURFACE_HOLD_H

#include "biem_node_exchange.h"
#include "biem_types.h"
#include <string>

namespace biem {

enum class Hold { None, Volume, VolumeAndArea };

// "none", "volume" or "area" (volume and area); throws Error with the choices otherwise.
Hold parse_hold(const std::string &name);

// By surface; values of cells only, zero elsewhere.
struct HeldCells {
  Hold hold = Hold::Volume;
  std::vector<double> reference_volume, reference_area;    // no volumes: nothing is held
  std::vector<double> volume, area;                        // filled by Suspension::evaluate()
  double relaxation_rate = 0.0;    // [1/time] at which an error of volume or area decays
};

// The cells where they are, on the owned nodes. From area_gradient on: read to hold areas only.
struct HeldGeometry {
  const std::vector<int> &cell_of_node;    // n_owned; -1 where there is nothing to hold
  PointsView volume_gradient;              // 3 x n_owned, dV/dx
  PointsView area_gradient;                // 3 x n_owned, dA/dx
  PointsView nodes;                        // 3 x n_owned, every cell in one piece
  // [1/time] of a background flow, without trace, that moves the nodes besides their velocities.
  Mat3 flow_gradient = Mat3::Zero();
};

// Corrects the velocity u (3 x n_owned) so that u.g_V = rate (V0 - V) of each cell, g_V = dV/dx:
// u -= alpha n, n = g_V/|g_V|. With area also (u + flow).g_A = rate (A0 - A), g_A = dA/dx:
//   u -= alpha n + beta S (x - x_c),  S = sum g_A x - (2/3) A I = A (I/3 - <n n>),
// the pure strain of the cell that changes its area fastest; it changes no volume (S:I = 0), so
// that the two equations are solved one after the other. Being smooth on the whole cell, it does
// not couple to the size of the triangles, as a motion by the mean curvature would.
// A cell whose normals are nearly isotropic, |S| < kLeastAnisotropy A, as on a sphere, which has no
// other area at its volume, would be strained by much for a small change of its area: of such a
// cell only the volume is held. Collective: one sum.
void project_held(const HeldCells &cells, const HeldGeometry &geometry, NodeExchange &exchange,
                  PointsRef velocity);

// That of a sphere stretched by 8 %; a red cell has 0.33.
constexpr double kLeastAnisotropy = 0.05;

}    // namespace biem

#endif
