// Layer operators that are restricted to some sources, targets and layers have the numbers of the
// whole, and pay for what they are restricted to; on any number of ranks.
#include "biem_error.h"
#include "layer_scene.h"
#include <gtest/gtest.h>

using namespace biem;

namespace {

// Some nodes of every surface and one of the points: on no rank all, on some ranks maybe none.
std::vector<char> make_targets(const LayerScene &scene)
{
  std::vector<char> targets(scene.nodes.cols());
  for (size_t i = 0; i < targets.size(); i++)
    targets[i] = i % 7 < 3 && scene.nodes(0, static_cast<Eigen::Index>(i)) > 0.4;
  targets.back() = 1;
  return targets;
}

Points keep(const Points &values, const std::vector<char> &targets)
{
  Points kept = values;
  for (size_t i = 0; i < targets.size(); i++)
    if (!targets[i]) kept.col(static_cast<Eigen::Index>(i)).setZero();
  return kept;
}

constexpr Layers kAllLayers[] = {Layers::Single, Layers::Double, Layers::Both};

}    // namespace

TEST(RestrictedLayerOperator, HasTheNumbersOfTheWholeAtItsTargetsAndZeroElsewhere)
{
  const LayerScene scene = make_three_spheres(162);
  const Points f = make_smooth(scene, 0.3), q = make_smooth(scene, -0.8);
  const std::vector<char> targets = make_targets(scene);
  Distributed whole(MPI_COMM_WORLD, scene, 1e-4);
  Distributed part(MPI_COMM_WORLD, scene, 1e-4, Layers::Both, {{}, {}, targets});
  for (Layers layers : kAllLayers) {
    const Points expected = whole.apply(layers, f, q);
    EXPECT_LT(compute_largest(part.apply(layers, f, q) - keep(expected, targets)),
              1e-12 * compute_largest(expected));
  }
}

TEST(RestrictedLayerOperator, WithoutSomeSourcesIsTheWholeOfADensityThatIsZeroThere)
{
  const LayerScene scene = make_three_spheres(162);
  const Points f = make_smooth(scene, 0.3), q = make_smooth(scene, -0.8);
  Points f_kept = f, q_kept = q;
  f_kept.middleCols(162, 162).setZero();
  q_kept.middleCols(162, 162).setZero();
  Distributed whole(MPI_COMM_WORLD, scene, 1e-4);
  Distributed part(MPI_COMM_WORLD, scene, 1e-4, Layers::Both, {{0, 2}, {}});
  for (Layers layers : kAllLayers) {
    const Points expected = whole.apply(layers, f_kept, q_kept);
    EXPECT_LT(compute_largest(part.apply(layers, f, q) - expected),
              1e-12 * compute_largest(expected));
    EXPECT_GT(compute_largest(whole.apply(layers, f, q) - expected),
              0.1 * compute_largest(expected));
  }
}

TEST(RestrictedLayerOperator, OfSurfacesWithDifferentLayersIsTheSumOfOneOperatorForEachLayer)
{
  const LayerScene scene = make_three_spheres(162);
  const Points f = make_smooth(scene, 0.3), q = make_smooth(scene, -0.8);
  const Points single =
      Distributed(MPI_COMM_WORLD, scene, 1e-4, Layers::Single, {{0, 2}, {}})
          .apply(Layers::Single, f, kNone);
  const Points dual = Distributed(MPI_COMM_WORLD, scene, 1e-4, Layers::Double, {{1, 2}, {}})
                          .apply(Layers::Double, kNone, q);
  const Points expected[] = {single, dual, single + dual};
  const std::vector<Layers> carried{Layers::Single, Layers::Double, Layers::Both};
  for (const std::vector<char> &targets : {std::vector<char>(), make_targets(scene)}) {
    Distributed mixed(MPI_COMM_WORLD, scene, 1e-4, Layers::Both, {{}, carried, targets});
    for (int l = 0; l < 3; l++)
      EXPECT_LT(compute_largest(mixed.apply(kAllLayers[l], f, q) - keep(expected[l], targets)),
                1e-12 * compute_largest(expected[l]));
  }
}

TEST(RestrictedLayerOperator, KnowsTheLayersOfANodeWhoseElementsAreAllOnAnotherRank)
{
  const LayerScene scene = make_two_spheres(162);    // the second one's top lies in the next cell
  const Points f = make_smooth(scene, 0.3), q = make_smooth(scene, -0.8);
  const Points single = Distributed(MPI_COMM_WORLD, scene, 1e-4, Layers::Single, {{1}, {}})
                            .apply(Layers::Single, f, kNone);
  const Points dual = Distributed(MPI_COMM_WORLD, scene, 1e-4, Layers::Double, {{0}, {}})
                          .apply(Layers::Double, kNone, q);
  Distributed mixed(MPI_COMM_WORLD, scene, 1e-4, Layers::Both,
                    {{}, {Layers::Double, Layers::Single}});
  const Points expected = single + dual;
  EXPECT_LT(compute_largest(mixed.apply(Layers::Both, f, q) - expected),
            1e-12 * compute_largest(expected));
}

TEST(RestrictedLayerOperator, PaysOnlyForTheLayersThatAreCarriedAndForItsTargets)
{
  const LayerScene scene = make_three_spheres(42);
  const Points f = make_smooth(scene, 0.3), q = make_smooth(scene, -0.8);
  auto count = [&](Layers layers, const Selection &selection) {
    Distributed part(MPI_COMM_SELF, scene, 1e-2, Layers::Both, selection);
    part.apply(layers, f, q);
    const OperatorProfile p = part.profile();
    return std::array<long, 2>{p.n_near_pairs, p.sum.n_pairs};
  };
  std::vector<char> one_target(scene.nodes.cols(), 0);
  one_target[5] = 1;
  const std::vector<Layers> carried{Layers::Single, Layers::Double, Layers::Double};
  const auto whole = count(Layers::Both, {{}, {}});
  const auto first = count(Layers::Both, {{0}, {}});
  const auto one = count(Layers::Both, {{}, {}, one_target});
  const auto single_only = count(Layers::Single, {{}, carried});
  for (int rule = 0; rule < 2; rule++) {
    EXPECT_LT(first[rule], 0.5 * whole[rule]);
    EXPECT_LT(one[rule], 0.05 * whole[rule]);
    EXPECT_EQ(single_only[rule], first[rule]);
  }
}

TEST(RestrictedLayerOperator, MayHaveNoSourcesOrNoTargets)
{
  const LayerScene scene = make_three_spheres(42);
  const Points f = make_smooth(scene, 0.3);
  Distributed no_sources(MPI_COMM_WORLD, scene, 1e-2, Layers::Both, {{7}, {}});
  EXPECT_EQ(compute_largest(no_sources.apply(Layers::Both, f, f)), 0.0);
  const std::vector<char> nothing(scene.nodes.cols(), 0);
  Distributed no_targets(MPI_COMM_WORLD, scene, 1e-2, Layers::Both, {{}, {}, nothing});
  EXPECT_EQ(compute_largest(no_targets.apply(Layers::Both, f, f)), 0.0);
}

TEST(RestrictedLayerOperator, RefusesMarksAndLayersThatDoNotFit)
{
  const SurfaceMesh mesh = make_icosphere(2);
  LayerScene scene;
  scene.cell = 5.0 * Mat3::Identity();
  scene.add_sphere(42, Vec3::Zero());
  const EwaldParameters p = scene.choose(1e-2);
  PeriodicGhosts ghosts(scene.nodes, scene.cell, p.cutoff + 1.0);
  FlatElements elements;
  elements.set_geometry(ghosts.nodes(), mesh.triangles);
  const NearCandidates candidates = find_near_candidates(elements, ghosts.nodes());
  const Eigen::VectorXd areas = Eigen::VectorXd::Ones(42);
  const Points shift = Points::Zero(3, elements.n_elements());
  LayerOperator layers(MPI_COMM_SELF, p);
  layers.set_cell(scene.cell, Vec3::Zero());
  auto set = [&](const NearCandidates &near, const std::vector<char> *is_target,
                 const std::vector<Layers> *carried) {
    layers.set_geometry({ghosts.nodes(), 42, elements, near, areas, mesh.triangles, shift,
                         is_target, carried},
                        Layers::Single, ghosts);
  };
  const std::vector<char> too_few_marks(41, 1);
  const std::vector<Layers> too_few_layers(79, Layers::Single);
  const NearCandidates of_some = select_candidates(candidates, {1, 2, 3}, nullptr);
  EXPECT_THROW(set(candidates, &too_few_marks, nullptr), Error);
  EXPECT_THROW(set(candidates, nullptr, &too_few_layers), Error);
  EXPECT_THROW(set(of_some, nullptr, nullptr), Error);
  EXPECT_NO_THROW(set(candidates, nullptr, nullptr));
}
