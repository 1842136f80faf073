// Kinds of surfaces and blocks of unknowns: see the header.
#include "biem_scene.h"
#include <algorithm>

namespace biem {

bool Scene::has(SurfaceKind kind) const
{
  return std::any_of(surfaces.begin(), surfaces.end(),
                     [&](const Surface &s) { return s.kind == kind; });
}

bool Scene::has_unknowns() const
{
  return std::any_of(surfaces.begin(), surfaces.end(),
                     [](const Surface &s) { return s.is_unknown(); });
}

bool Scene::has_contrast() const
{
  return std::any_of(surfaces.begin(), surfaces.end(), [](const Surface &s) {
    return s.kind == SurfaceKind::Cell && s.is_unknown();
  });
}

Layers Scene::unknown_layers() const
{
  const bool has_double = std::any_of(surfaces.begin(), surfaces.end(), [](const Surface &s) {
    return s.double_layer_factor() != 0.0;
  });
  if (!has(SurfaceKind::Wall)) return Layers::Double;
  return has_double ? Layers::Both : Layers::Single;
}

namespace {

bool is_equal(const Points &a, const Points &b)
{
  return a.cols() == b.cols() && a == b;
}

bool is_equal(const Surface &a, const Surface &b)
{
  return a.kind == b.kind && a.viscosity_ratio == b.viscosity_ratio && a.shape == b.shape &&
         a.velocity == b.velocity;
}

bool is_equal(const SurfaceMesh &a, const SurfaceMesh &b)
{
  return is_equal(a.nodes, b.nodes) && a.triangles == b.triangles;
}

}    // namespace

bool operator==(const Scene &a, const Scene &b)
{
  const auto equal = [](const auto &x, const auto &y) {
    return is_equal(x, y);
  };
  return std::equal(a.surfaces.begin(), a.surfaces.end(), b.surfaces.begin(), b.surfaces.end(),
                    equal) &&
         std::equal(a.shapes.begin(), a.shapes.end(), b.shapes.begin(), b.shapes.end(), equal) &&
         a.connectivities == b.connectivities && is_equal(a.walls.nodes, b.walls.nodes) &&
         a.walls.triangles == b.walls.triangles &&
         (a.walls.nodes.cols() == 0 || a.walls.cell == b.walls.cell);
}

std::string describe_blocks(const BlockSizes &n)
{
  std::string text;
  auto add = [&](long n_nodes, const std::string &what, const std::string &unknown) {
    if (n_nodes == 0) return;
    text += "  " + what + ": " + std::to_string(n_nodes) + " nodes, ";
    text += unknown.empty() ? "no unknowns (single layer)\n"
                            : std::to_string(3 * n_nodes) + " unknowns (" + unknown + ")\n";
  };
  add(n.n_free, "cells of viscosity ratio 1", "");
  add(n.n_contrast, "cells of other viscosity ratios", "velocity, double layer");
  add(n.n_rigid, "rigid particles", "density of the completed double layer");
  add(n.n_wall, "walls", "force density, single layer");
  const bool has_double = n.n_contrast + n.n_rigid > 0;
  if (has_double)
    text += "  one system of " + std::to_string(3 * (n.n_contrast + n.n_rigid + n.n_wall)) +
            " unknowns, solved by GMRES in every evaluation\n";
  else if (n.n_wall > 0)
    text += "  the walls' forces follow from the inverse of the wall block, without iterations\n";
  else
    text += "  one single layer in every evaluation, nothing to solve\n";
  return text;
}

}    // namespace biem
