// Distributed periodic images against brute force, on any number of ranks: every rank makes the
// same points and keeps its part.
#include "biem_error.h"
#include "biem_periodic_ghosts.h"
#include "core/random_points.h"
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace biem;

namespace {

enum class Placement { Bricks, AroundTheCell, LastRankOnly };

// All points on every rank, with the indices of those that this rank owns.
struct Cloud {
  Mat3 cell;
  Points points;
  std::vector<int> mine;

  Cloud(const Mat3 &cell, int n, Placement placement) : cell(cell), points(3, n)
  {
    std::mt19937_64 generator(11);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (Eigen::Index i = 0; i < points.size(); i++)
      points.data()[i] = uniform(generator);
    points = (cell * points).eval();
    const std::vector<int> ranks = assign_to_ranks(points, cell, get_n_ranks());
    for (int i = 0; i < n; i++) {
      const int last = get_n_ranks() - 1;
      if ((placement == Placement::LastRankOnly ? last : ranks[i]) == get_rank()) mine.push_back(i);
      if (placement == Placement::AroundTheCell)    // owned points may lie outside of the cell
        points.col(i) += cell * Vec3(i % 3 - 1, 0, i % 2);
    }
  }

  Points owned() const
  {
    Points own(3, mine.size());
    for (size_t i = 0; i < mine.size(); i++)
      own.col(i) = points.col(mine[i]);
    return own;
  }

  // Index of the point and its position, for all images within reach of the box of the owned
  // points but the owned points themselves.
  std::vector<std::pair<int, Vec3>> find_ghosts(double reach) const
  {
    std::vector<std::pair<int, Vec3>> ghosts;
    if (mine.empty()) return ghosts;
    const Points own = owned();
    const Vec3 low = own.rowwise().minCoeff(), high = own.rowwise().maxCoeff();
    constexpr int kImages = 10;
    for (int n = 0; n < points.cols(); n++)
      for (int i = -kImages; i <= kImages; i++)
        for (int j = -kImages; j <= kImages; j++)
          for (int k = -kImages; k <= kImages; k++) {
            const Vec3 x = points.col(n) + cell * Vec3(i, j, k);
            const bool is_own = std::binary_search(mine.begin(), mine.end(), n);
            if (i == 0 && j == 0 && k == 0 && is_own) continue;
            if (((low - x).array() > reach).any() || ((x - high).array() > reach).any()) continue;
            ghosts.emplace_back(n, x);
          }
    return ghosts;
  }
};

// The index of its point for every owned and ghost node, taken through forward().
std::vector<int> exchange_indices(PeriodicGhosts &ghosts, const Cloud &cloud)
{
  std::vector<double> values(ghosts.nodes().cols(), -1.0);
  std::copy(cloud.mine.begin(), cloud.mine.end(), values.begin());
  ghosts.forward(values.data(), 1);
  return std::vector<int>(values.begin(), values.end());
}

bool is_less(const std::pair<int, Vec3> &a, const std::pair<int, Vec3> &b)
{
  if (a.first != b.first) return a.first < b.first;
  for (int c = 0; c < 3; c++)
    if (std::fabs(a.second[c] - b.second[c]) > 1e-9) return a.second[c] < b.second[c];
  return false;
}

Mat3 make_cell(double xy, double xz, double yz)
{
  Mat3 cell;
  cell << 1.3, xy, xz, 0.0, 0.9, yz, 0.0, 0.0, 1.1;
  return cell;
}

struct GhostCase {
  Mat3 cell;
  double reach;
  Placement placement;
};

class Ghosts : public ::testing::TestWithParam<GhostCase> {
 protected:
  Ghosts() : cloud_(GetParam().cell, 60, GetParam().placement) {}

  Cloud cloud_;
  PeriodicGhosts ghosts_{MPI_COMM_WORLD, cloud_.owned(), GetParam().cell, GetParam().reach};
};

std::vector<GhostCase> make_cases()
{
  std::vector<GhostCase> cases;
  const Mat3 rotated =
      Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()) * make_cell(0.2, 0.5, 0.1);
  for (const Mat3 &cell :
       {make_cell(0, 0, 0), make_cell(0, 0.6, 0), make_cell(-0.5, 0.4, 0.3), Mat3(rotated)})
    for (double reach : {0.0, 0.27, 1.73})    // 1.73: further than the cell is wide
      for (Placement placement :
           {Placement::Bricks, Placement::AroundTheCell, Placement::LastRankOnly})
        cases.push_back({cell, reach, placement});
  return cases;
}

}    // namespace

TEST_P(Ghosts, AreAllImagesWithinReachAndCarryTheirOwnersValues)
{
  const std::vector<int> indices = exchange_indices(ghosts_, cloud_);
  ASSERT_EQ(ghosts_.n_owned(), static_cast<int>(cloud_.mine.size()));
  std::vector<std::pair<int, Vec3>> found, expected = cloud_.find_ghosts(GetParam().reach);
  for (int i = 0; i < static_cast<int>(indices.size()); i++)
    if (i < ghosts_.n_owned())
      EXPECT_EQ(ghosts_.nodes().col(i), cloud_.points.col(cloud_.mine[i]));
    else
      found.emplace_back(indices[i], ghosts_.nodes().col(i));
  ASSERT_EQ(found.size(), expected.size());
  std::sort(found.begin(), found.end(), is_less);
  std::sort(expected.begin(), expected.end(), is_less);
  for (size_t i = 0; i < found.size(); i++) {
    EXPECT_EQ(found[i].first, expected[i].first);
    EXPECT_LT((found[i].second - expected[i].second).norm(), 1e-12);
  }
}

TEST_P(Ghosts, ReverseAddIsTheTransposeOfForward)
{
  // sum over all nodes of a . forward(b) = sum over owned nodes of reverse_add(a) . b
  const int n_all = static_cast<int>(ghosts_.nodes().cols()), n_owned = ghosts_.n_owned();
  std::mt19937_64 generator(17 + get_rank());
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int n_columns : {1, 3, 5}) {
    Eigen::MatrixXd a(n_columns, n_all), b(n_columns, n_all);
    for (Eigen::Index i = 0; i < a.size(); i++) {
      a.data()[i] = uniform(generator);
      b.data()[i] = uniform(generator);
    }
    const Eigen::MatrixXd ghost_part = a.rightCols(n_all - n_owned);
    ghosts_.forward(b.data(), n_columns);
    double products[2] = {a.cwiseProduct(b).sum(), 0.0};
    ghosts_.reverse_add(a.data(), n_columns);
    products[1] = a.leftCols(n_owned).cwiseProduct(b.leftCols(n_owned)).sum();
    EXPECT_EQ(a.rightCols(n_all - n_owned), ghost_part);
    ghosts_.sum(products, 2);
    EXPECT_NEAR(products[0], products[1], 1e-9);
  }
}

TEST_P(Ghosts, ReverseAddCountsTheImagesOfEachNode)
{
  std::vector<double> copies(ghosts_.nodes().cols(), 1.0);
  ghosts_.reverse_add(copies.data(), 1);
  std::vector<double> n_copies(cloud_.points.cols(), 0.0);
  for (size_t i = 0; i < cloud_.mine.size(); i++)
    n_copies[cloud_.mine[i]] = copies[i];
  ghosts_.sum(n_copies.data(), static_cast<int>(n_copies.size()));
  std::vector<double> expected(cloud_.points.cols(), 0.0);
  for (int i : cloud_.mine)
    expected[i] += 1.0;
  for (const auto &ghost : cloud_.find_ghosts(GetParam().reach))
    expected[ghost.first] += 1.0;
  ghosts_.sum(expected.data(), static_cast<int>(expected.size()));
  EXPECT_EQ(n_copies, expected);
}

TEST_P(Ghosts, SumOverNeighborsDoesNotDependOnTheNumberOfRanks)
{
  const double reach = GetParam().reach;
  PeriodicGhosts alone(cloud_.points, GetParam().cell, reach);
  const auto add_neighbors = [reach](const PeriodicGhosts &g, int i) {
    double sum = 0.0;
    for (Eigen::Index j = 0; j < g.nodes().cols(); j++) {
      const double r = (g.nodes().col(i) - g.nodes().col(j)).norm();
      if (r < reach) sum += (reach - r) * (reach - r) * (1.0 + r);
    }
    return sum;
  };
  for (size_t i = 0; i < cloud_.mine.size(); i++) {
    const double expected = add_neighbors(alone, cloud_.mine[i]);
    EXPECT_NEAR(add_neighbors(ghosts_, static_cast<int>(i)), expected, 1e-11 * (1.0 + expected));
  }
}

INSTANTIATE_TEST_SUITE_P(Cells, Ghosts, ::testing::ValuesIn(make_cases()));

TEST(AssignToRanks, BricksAreEqualAndCompact)
{
  constexpr int kSide = 12;
  Points points(3, kSide * kSide * kSide);
  for (int i = 0; i < points.cols(); i++)
    points.col(i) =
        Vec3(i % kSide + 0.5, i / kSide % kSide + 0.5, i / (kSide * kSide) + 0.5) / kSide;
  const Mat3 cell = make_cell(-0.5, 0.4, 0.3);
  points = (cell * points).eval();
  for (int n_ranks : {1, 2, 4, 6, 8, 12, 27}) {
    std::vector<int> n_points(n_ranks, 0);
    for (int rank : assign_to_ranks(points, cell, n_ranks))
      n_points.at(rank)++;
    EXPECT_EQ(n_points, std::vector<int>(n_ranks, static_cast<int>(points.cols()) / n_ranks));
  }
  Points moved = points;    // an image belongs to the same rank
  moved.colwise() += cell * Vec3(-3, 2, 1);
  EXPECT_EQ(assign_to_ranks(moved, cell, 8), assign_to_ranks(points, cell, 8));
  const Mat3 rod = Vec3(1.0, 1.0, 10.0).asDiagonal();    // cut across its axis only
  const Points in_rod = rod * cell.inverse() * points;
  const std::vector<int> slices = assign_to_ranks(in_rod, rod, 4);
  for (int i = 0; i < in_rod.cols(); i++)
    EXPECT_EQ(slices[i], static_cast<int>(4.0 * in_rod(2, i) / rod(2, 2)));
}

TEST(GhostErrors, PositionThatIsNotFiniteIsAnErrorOnEveryRank)
{
  Points owned = Points::Zero(3, 2);
  if (get_rank() == 0) owned(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(PeriodicGhosts(MPI_COMM_WORLD, owned, Mat3::Identity(), 0.5), Error);
}

TEST(GhostErrors, WrongCellOrReachIsRefused)
{
  const Points owned = Points::Zero(3, 2);
  EXPECT_THROW(PeriodicGhosts(owned, Mat3::Zero(), 0.5), Error);
  EXPECT_THROW(PeriodicGhosts(owned, Mat3::Identity(), -0.5), Error);
  EXPECT_THROW(assign_to_ranks(owned, Mat3::Identity(), 0), Error);
}
