// Checks that every membrane law must pass: forces against differences of the energy, no total
// force or torque. Knows no law.
#ifndef MEMBRANE_CHECKS_H
#define MEMBRANE_CHECKS_H

#include "biem_types.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace biem_test {

using biem::Vec3;

// d(energy)/d(node component) by central differences, extrapolated from steps h and h/2: O(h^4).
template <class Nodes, class Energy>
double differentiate(const Energy &energy, Nodes nodes, int node, int component, double step)
{
  const auto slope = [&](double h) {
    const double center = nodes[node][component];
    nodes[node][component] = center + h;
    const double above = energy(nodes);
    nodes[node][component] = center - h;
    const double below = energy(nodes);
    nodes[node][component] = center;
    return (above - below) / (2.0 * h);
  };
  return (4.0 * slope(0.5 * step) - slope(step)) / 3.0;
}

// step: a small fraction of the edge length. tolerance: relative to the largest force.
template <class Nodes, class Energy>
void expect_forces_are_energy_slopes(const Energy &energy, const Nodes &nodes, const Nodes &force,
                                     double step, double tolerance)
{
  double largest = 0.0;
  for (const Vec3 &f : force) largest = std::max(largest, f.norm());
  for (size_t i = 0; i < nodes.size(); i++)
    for (int c = 0; c < 3; c++)
      EXPECT_NEAR(force[i][c], -differentiate(energy, nodes, i, c, step), tolerance * largest)
          << "node " << i << " component " << c;
}

template <class Nodes> void expect_no_force_and_torque(const Nodes &nodes, const Nodes &force)
{
  Vec3 total = Vec3::Zero(), torque = Vec3::Zero();
  double scale = 0.0;
  for (size_t i = 0; i < nodes.size(); i++) {
    total += force[i];
    torque += nodes[i].cross(force[i]);
    scale += force[i].norm() * std::max(1.0, nodes[i].norm());
  }
  EXPECT_LE(total.norm(), 1e-14 * scale);
  EXPECT_LE(torque.norm(), 1e-14 * scale);
}

inline Vec3 make_random_vector(std::mt19937 &random, double size)
{
  std::uniform_real_distribution<double> uniform(-size, size);
  const double x = uniform(random), y = uniform(random);
  return {x, y, uniform(random)};
}

inline biem::Mat3 make_random_rotation(std::mt19937 &random)
{
  Eigen::Vector4d v;
  for (int i = 0; i < 4; i++) v[i] = std::normal_distribution<double>()(random);
  return Eigen::Quaterniond(v.normalized()).toRotationMatrix();
}

}    // namespace biem_test

#endif
