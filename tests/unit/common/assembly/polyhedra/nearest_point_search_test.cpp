// Nearest points that are searched for one after the other, held against searches that begin from
// nothing.
#include "common/assembly/polyhedra/nearest_point_search.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/support/status_assertions.h"

namespace mortise::parametric {
namespace {

constexpr int kVariables = 12;
constexpr int kInequalities = 40;
constexpr int kEqualities = 5;

Eigen::MatrixXd RandomRows(int rows, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd made(rows, kVariables);
  for (double& entry : made.reshaped()) entry = normal(random);
  return made;
}

// A polyhedron around 0. The last equality is twice the first.
Polyhedron RandomPolyhedron(std::mt19937& random) {
  std::uniform_real_distribution<double> slack(0.1, 1);
  Polyhedron made{RandomRows(kInequalities, random), Eigen::VectorXd(kInequalities),
                  RandomRows(kEqualities, random), Eigen::VectorXd::Zero(kEqualities)};
  for (double& bound : made.bounds) bound = slack(random);
  made.equalities.row(kEqualities - 1) = 2 * made.equalities.row(0);
  return made;
}

// The same with only some of the equalities.
Polyhedron With(const Polyhedron& all, const std::vector<int>& equalities) {
  return {all.inequalities, all.bounds, all.equalities(equalities, Eigen::all),
          all.values(equalities)};
}

// Values, points and equalities change at random; whatever held before, the point is the nearest.
TEST(NearestPointSearchTest, FindsWhatASearchFromNothingFinds) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.4);
  std::bernoulli_distribution coin(0.5);
  int found = 0, empty = 0;
  for (int polyhedron = 0; polyhedron < 20; ++polyhedron) {
    Polyhedron now = RandomPolyhedron(random);
    NearestPointSearch search(now);
    for (int step = 0; step < 40; ++step) {
      std::vector<int> held;
      for (int row = 0; row < kEqualities; ++row) {
        if (coin(random)) {
          // Where both are held, the last must agree with the first now and then.
          now.values[row] =
              row == kEqualities - 1 && coin(random) ? 2 * now.values[0] : normal(random);
          search.Hold(row, now.values[row]);
          held.push_back(row);
        } else {
          search.Release(row);
        }
      }
      Eigen::VectorXd x(kVariables);
      for (double& entry : x) entry = 3 * normal(random);
      ASSERT_OK_AND_ASSIGN(const Projection warm, search.NearestTo(x));
      ASSERT_OK_AND_ASSIGN(const Projection cold, ProjectOnto(With(now, held), x));
      ASSERT_EQ(warm.point.has_value(), cold.point.has_value());
      if (cold.point) {
        ++found;
        EXPECT_LE((*warm.point - *cold.point).cwiseAbs().maxCoeff(), 1e-8);
      } else {
        ++empty;
      }
    }
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(empty, 20);
}

TEST(NearestPointSearchTest, CopiesGoTheirOwnWays) {
  std::mt19937 random(5);
  NearestPointSearch one(RandomPolyhedron(random));
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(kVariables, 0.5);
  ASSERT_OK_AND_ASSIGN(const Projection before, one.NearestTo(x));
  NearestPointSearch other = one;
  for (int row = 0; row < kEqualities; ++row) other.Release(row);
  ASSERT_OK_AND_ASSIGN(const Projection freer, other.NearestTo(x));
  ASSERT_OK_AND_ASSIGN(const Projection after, one.NearestTo(x));
  ASSERT_TRUE(before.point && freer.point && after.point);
  EXPECT_LT((*freer.point - x).norm(), (*before.point - x).norm());
  EXPECT_LE((*after.point - *before.point).norm(), 1e-9);
}

}  // namespace
}  // namespace mortise::parametric
