// Parts of the coupled system by themselves: rigid motions and fluxes of surfaces, replicas of
// surfaces on ranks, the block of the walls. On 1, 2 and 4 ranks.
#include "coupled_scene.h"
#include <gtest/gtest.h>

using namespace biem;

namespace {

// The surfaces of a scene as an operator has them, and the modes of the closed ones.
struct DistributedModes {
  CoupledScene scene;
  DistributedSuspension nodes;
  SurfaceSubset surfaces;
  SurfaceModes modes;
  Points relative, normals;    // of all nodes

  explicit DistributedModes(const CoupledScene &whole) :
      scene(whole), nodes(MPI_COMM_WORLD, scene, 1e-3, make_settings(1e-3))
  {
    const Configuration c = nodes.configuration();
    std::vector<char> is_source(scene.parts.size(), 0);
    for (size_t s = 0; s < is_source.size(); s++)
      is_source[s] = scene.scene.surfaces[s].is_closed();
    surfaces.set_topology(c, is_source, {}, std::vector<char>(c.n_owned, 1), nodes.ghosts());
    surfaces.set_geometry(c, nodes.ghosts());
    std::vector<int> surface_of_node = c.surface_of_node;
    for (int &s : surface_of_node)
      if (s >= 0 && !is_source[s]) s = -1;
    modes.set_geometry(surface_of_node, static_cast<int>(scene.parts.size()), c.unwrapped,
                       surfaces.areas(), surfaces.volume_gradient(), surfaces.elements(),
                       c.nodes.cols(), nodes.ghosts());
    relative = nodes.gather(modes.relative());
    Points normal = surfaces.volume_gradient();
    for (Eigen::Index i = 0; i < normal.cols(); i++)
      if (surfaces.areas()[i] > 0.0) normal.col(i) /= surfaces.areas()[i];
    normals = nodes.gather(normal);
  }

  std::vector<SurfaceMotion> compute_motions(const Points &field)
  {
    return modes.compute_motions(nodes.distribute(field), nodes.ghosts());
  }
};

struct Moments {
  double area = 0.0;
  Vec3 centroid = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
};

// By the midpoints of the edges, which integrate quadratic functions exactly.
Moments compute_moments(const SurfaceMesh &mesh)
{
  Moments m;
  for (int pass = 0; pass < 2; pass++) {
    for (const Triangle &t : mesh.triangles) {
      const Mat3 x = mesh.nodes(Eigen::all, t);
      const double third = (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm() / 6.0;
      for (int v = 0; v < 3; v++) {
        const Vec3 middle = 0.5 * (x.col(v) + x.col((v + 1) % 3)), r = middle - m.centroid;
        if (pass == 0) {
          m.area += third;
          m.centroid += third * middle;
        } else
          m.inertia += third * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
      }
    }
    if (pass == 0) m.centroid /= m.area;
  }
  return m;
}

// A wall alone in a box, with the system that holds its block.
struct WallSystem {
  CoupledScene scene;
  DistributedSuspension nodes;
  CoupledSystem system;

  WallSystem(const CoupledScene &wall, double tolerance, Drive drive) :
      scene(wall), nodes(MPI_COMM_WORLD, scene, tolerance, make_settings(1e-6)),
      system(MPI_COMM_WORLD, scene.choose(tolerance), kViscosity, make_settings(1e-6).control,
             scene.scene, drive)
  {
    system.set_cell(scene.cell, Vec3::Zero());
    system.set_geometry(nodes.configuration(), nodes.ghosts());
  }
  static constexpr double kViscosity = 0.6;
};

CoupledScene make_wall_alone(double edge)
{
  CoupledScene scene(make_box());
  scene.add_wall(Vec3::Zero(), make_plane_wall({scene.cell, Vec3::Zero()}, Axis::Z, 0.3, edge));
  return scene;
}

}    // namespace

TEST(SurfaceModes, FindRigidMotionsAndFluxesOfWrappedSurfacesExactly)
{
  DistributedModes d(make_coupled_scene(make_tilted_box(), 5.0));
  Points rigid = Points::Zero(3, d.scene.nodes.cols()), normal = rigid;
  const auto velocity = [](int s) {
    return Vec3(0.3 + s, -1.2, 0.4 * s);
  };
  const auto rotation = [](int s) {
    return Vec3(-0.7, 0.2 * s, 1.1 - s);
  };
  const auto flux = [](int s) {
    return 0.9 - 0.7 * s;
  };
  for (int s : {kContrast, kRigid, kFree}) {
    const Vec3 center = compute_moments(d.scene.parts[s]).centroid;
    for (int i : d.scene.list_nodes(s)) {
      rigid.col(i) = velocity(s) + rotation(s).cross(d.scene.nodes.col(i) - center);
      normal.col(i) = flux(s) * d.normals.col(i);
    }
  }
  const std::vector<SurfaceMotion> a = d.compute_motions(rigid), b = d.compute_motions(normal);
  const std::vector<SurfaceMotion> sum = d.compute_motions(rigid + normal);
  for (int s : {kContrast, kRigid, kFree}) {
    EXPECT_LT((a[s].velocity - velocity(s)).norm(), 1e-13);
    EXPECT_LT((a[s].rotation - rotation(s)).norm(), 1e-13);
    EXPECT_LT(std::fabs(a[s].flux), 1e-13);    // rigid motions have none, also on facets
    EXPECT_NEAR(b[s].flux, flux(s), 1e-13);
    EXPECT_LT(b[s].velocity.norm(), 1e-13);    // as the area vectors add up to zero
    EXPECT_NEAR(sum[s].flux, flux(s), 1e-13);
    const Points fixed = d.nodes.distribute(rigid);
    const Configuration c = d.nodes.configuration();
    for (int i = 0; i < c.n_owned; i++) {
      if (c.surface_of_node[i] != s) continue;
      EXPECT_LT((d.modes.compute_rigid(a[s], i) - fixed.col(i)).norm(), 1e-12);
    }
  }
}

TEST(SurfaceModes, HaveTheMomentsOfTheFacets)
{
  DistributedModes d(make_coupled_scene(make_tilted_box(), 5.0));
  for (int s : {kContrast, kRigid, kFree}) {
    const Moments m = compute_moments(d.scene.parts[s]);
    const SurfaceGeometry &surface = d.modes.surface(s);
    EXPECT_NEAR(surface.area, m.area, 1e-12);
    EXPECT_LT((surface.centroid - m.centroid).norm(), 1e-12);
    EXPECT_LT((surface.inertia - m.inertia).norm(), 1e-12);
  }
}

TEST(SurfaceModes, LeaveOutFreePointsAndWalls)
{
  DistributedModes d(make_coupled_scene(make_box(), 5.0));
  EXPECT_EQ(d.modes.surface(kWall).area, 0.0);
  Points field = Points::Zero(3, d.scene.nodes.cols());
  for (int s : {-1, static_cast<int>(kWall)})
    for (int i : d.scene.list_nodes(s)) {
      field.col(i).setOnes();
      EXPECT_TRUE(d.relative.col(i).isZero(0.0));
    }
  for (const SurfaceMotion &motion : d.compute_motions(field)) {
    EXPECT_TRUE(motion.velocity.isZero(0.0));
    EXPECT_EQ(motion.flux, 0.0);
  }
}

TEST(SurfaceReplicas, AreWholeSurfacesWhereARankOwnsAPart)
{
  const CoupledScene scene = make_coupled_scene(make_box(), 5.0);
  DistributedSuspension nodes(MPI_COMM_WORLD, scene, 1e-3, make_settings(1e-3));
  const Configuration c = nodes.configuration();
  const std::vector<int> taking_part{kContrast, kRigid, kWall};
  std::vector<int> surface_of_node(c.n_owned, -1), first{0, 0, 0, 0};
  std::vector<char> is_owner(scene.parts.size(), 0);
  for (int i = 0; i < c.n_owned; i++) {
    const int s = c.surface_of_node[i];
    if (std::count(taking_part.begin(), taking_part.end(), s) == 0) continue;
    surface_of_node[i] = s;
    is_owner[s] = 1;
  }
  SurfaceReplicas replicas(MPI_COMM_WORLD);
  for (int pass = 0; pass < 2; pass++) {    // nodes may be set again
    replicas.set_nodes(surface_of_node, c.index_of_node);
    for (double factor : {1.0, -2.5}) {
      const std::map<int, Points> whole = replicas.gather(factor * Points(c.unwrapped));
      for (int s = 0; s < static_cast<int>(is_owner.size()); s++)
        EXPECT_EQ(whole.count(s), static_cast<size_t>(is_owner[s])) << "surface " << s;
      for (const auto &[s, values] : whole) {
        ASSERT_EQ(values.cols(), scene.parts[s].nodes.cols());
        EXPECT_TRUE(values == factor * scene.parts[s].nodes) << "surface " << s;
      }
    }
  }
}

TEST(SurfaceReplicas, MayBeOfNothing)
{
  SurfaceReplicas replicas(MPI_COMM_WORLD);
  replicas.set_nodes({-1, -1}, {0, 1});
  EXPECT_TRUE(replicas.gather(Points::Ones(3, 2)).empty());
  replicas.set_nodes({}, {});
  EXPECT_TRUE(replicas.gather(Points(3, 0)).empty());
}

TEST(WallBlock, InvertsThePlaneAndBlocksItsNormal)
{
  WallSystem w(make_wall_alone(0.9), 1e-6, Drive::PressureDrop);
  const WallBlock &walls = w.system.walls();
  ASSERT_FALSE(walls.is_empty());
  if (is_first_rank())
    std::printf("  %s, residual %.1e\n", walls.describe().c_str(), walls.residual());
  EXPECT_LT(walls.residual(), 1e-5);
  EXPECT_EQ(walls.is_blocked(), (std::array<bool, 3>{false, false, true}));
  EXPECT_NEAR(walls.area(), w.scene.cell(0, 0) * w.scene.cell(1, 1), 1e-12 * walls.area());
  const std::vector<Points> jumps = walls.compute_null_vectors();
  ASSERT_EQ(jumps.size(), 1u);
  for (Eigen::Index i = 0; i < jumps[0].cols(); i++)
    EXPECT_LT((jumps[0].col(i) - Vec3::UnitZ()).norm(), 1e-12);
}

TEST(WallBlock, LoadOfAMeanVelocityIsThatOfThePlaneChannel)
{
  // <u> = P H^2/(12 mu) between planes at a distance H. Of first order in the edge, because the
  // reach of the near rule is a multiple of it, with a small factor.
  double previous = 0.0;
  for (double edge : {1.1, 0.55}) {
    WallSystem w(make_wall_alone(edge), 1e-6, Drive::PressureDrop);
    const Vec3 drop(0.7, -0.3, 0.0), velocity = w.system.walls().to_velocity(drop);
    const double height = w.scene.cell(2, 2);
    const Vec3 exact = height * height / (12.0 * WallSystem::kViscosity) * drop;
    const double error = (velocity - exact).norm() / exact.norm();
    if (is_first_rank()) std::printf("  edge %g: relative error %.1e\n", edge, error);
    EXPECT_LT(error, 2.5e-4 * edge);
    if (previous > 0.0) EXPECT_LT(error, 0.55 * previous);
    previous = error;
    EXPECT_EQ(w.system.walls().to_velocity(Vec3::UnitZ())[2], 0.0);
  }
}

TEST(WallBlock, SolvesForForcesAndMeanVelocityTogether)
{
  for (Drive drive : {Drive::MeanVelocity, Drive::PressureDrop}) {
    WallSystem w(make_wall_alone(0.9), 1e-6, drive);
    const WallBlock &walls = w.system.walls();
    PeriodicGhosts &ghosts = w.nodes.ghosts();
    const Configuration c = w.nodes.configuration();
    CoupledFields residual{Points(3, c.n_owned)}, result{Points::Zero(3, c.n_owned)};
    for (int i = 0; i < c.n_owned; i++) {
      const Vec3 x = c.unwrapped.col(i);
      residual.nodes.col(i) = Vec3(std::sin(x[0]), 0.4, std::cos(x[0] + 2.0 * x[1]));
    }
    residual.mean = Vec3(0.3, -0.2, 0.5);
    walls.solve(residual, result, ghosts);
    const Vec3 load = walls.to_velocity(walls.compute_load(result.nodes, ghosts));
    if (drive == Drive::PressureDrop) {
      EXPECT_LT((load - residual.mean).head<2>().norm(), 1e-12);
      EXPECT_EQ(result.mean[2], residual.mean[2]);
    } else
      EXPECT_TRUE(result.mean.isZero(0.0));
    // The same forces are those of a wall that moves with the residual against the mean velocity.
    CoupledFields again{Points::Zero(3, c.n_owned)};
    CoupledFields moved{residual.nodes.colwise() + result.mean};
    WallSystem(w.scene, 1e-6, Drive::MeanVelocity).system.walls().solve(moved, again, ghosts);
    double sums[2] = {(again.nodes - result.nodes).squaredNorm(), result.nodes.squaredNorm()};
    ghosts.sum(sums, 2);
    EXPECT_LT(sums[0], 1e-20 * sums[1]);
  }
}
