// Furthest points of polyhedra by the simplex method, against another method and known corners; and
// polyhedra as products.
#include "common/assembly/polyhedra/linear_programme.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "common/assembly/polyhedra/polyhedron.h"
#include "common/assembly/polyhedra/polyhedron_factors.h"
#include "common/base/errors.h"
#include "tests/support/status_assertions.h"

namespace mortise::parametric {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::ElementsAre;

MatrixXd RandomRows(Eigen::Index rows, Eigen::Index columns, std::mt19937& random) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// Of the simplex x >= 0, sum x <= 1 the furthest point is the corner of the largest weight, or 0.
TEST(LinearProgramme, FindsTheCornersOfASimplex) {
  constexpr Eigen::Index kVariables = 6;
  MatrixXd rows(kVariables + 1, kVariables);
  rows << -MatrixXd::Identity(kVariables, kVariables), Eigen::RowVectorXd::Ones(kVariables);
  VectorXd bounds = VectorXd::Zero(kVariables + 1);
  bounds[kVariables] = 1;
  ASSERT_OK_AND_ASSIGN(LinearProgramme programme, LinearProgramme::Create(rows, bounds));
  std::mt19937 random(1);
  for (int round = 0; round < 50; ++round) {
    const VectorXd weights = RandomRows(kVariables, 1, random);
    ASSERT_OK_AND_ASSIGN(const auto found, programme.Furthest(weights));
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(weights.dot(*found), std::max(weights.maxCoeff(), 0.0), 1e-9);
  }
}

// One programme after the other gives what each gives by itself, by the other method.
TEST(LinearProgramme, AgreesWithTheProximalPointMethod) {
  std::mt19937 random(2);
  for (int round = 0; round < 30; ++round) {
    const Eigen::Index variables = 2 + round % 7;
    MatrixXd rows(6 * variables, variables);
    rows << RandomRows(4 * variables, variables, random), MatrixXd::Identity(variables, variables),
        -MatrixXd::Identity(variables, variables);
    const VectorXd bounds = RandomRows(6 * variables, 1, random).cwiseAbs();
    ASSERT_OK_AND_ASSIGN(LinearProgramme programme, LinearProgramme::Create(rows, bounds));
    const Polyhedron polyhedron{rows, bounds, MatrixXd(0, variables), VectorXd(0)};
    for (int direction = 0; direction < 10; ++direction) {
      const VectorXd along = RandomRows(variables, 1, random);
      ASSERT_OK_AND_ASSIGN(const auto found, programme.Furthest(along));
      ASSERT_OK_AND_ASSIGN(const Furthest other,
                           FurthestAlong(polyhedron, along, VectorXd::Zero(variables)));
      ASSERT_TRUE(found.has_value() && other.point.has_value());
      EXPECT_LE(((rows * *found - bounds).array() / rows.rowwise().norm().array()).maxCoeff(),
                1e-9);
      EXPECT_NEAR(along.dot(*found), along.dot(*other.point), 1e-7);
    }
  }
}

TEST(LinearProgramme, TellsEmptyFromEndless) {
  const MatrixXd half = Eigen::RowVector2d(1, 0);
  ASSERT_OK_AND_ASSIGN(LinearProgramme programme, LinearProgramme::Create(half, VectorXd::Ones(1)));
  ASSERT_OK_AND_ASSIGN(const auto endless, programme.Furthest(Eigen::Vector2d(0, 1)));
  EXPECT_FALSE(endless.has_value());
  ASSERT_OK_AND_ASSIGN(const auto bounded, programme.Furthest(Eigen::Vector2d(2, 0)));
  ASSERT_TRUE(bounded.has_value());
  EXPECT_NEAR((*bounded)[0], 1, 1e-12);

  const MatrixXd between = Eigen::Vector2d(1, -1);
  ASSERT_OK_AND_ASSIGN(LinearProgramme empty,
                       LinearProgramme::Create(between, Eigen::Vector2d(-1, -1)));
  EXPECT_EQ(DetailOf(empty.Furthest(VectorXd::Ones(1)).status()).reason, "POLYHEDRON_EMPTY");
}

TEST(LinearProgramme, BadInputIsRefused) {
  const MatrixXd rows = MatrixXd::Identity(2, 2);
  EXPECT_TRUE(absl::IsInvalidArgument(LinearProgramme::Create(rows, VectorXd::Ones(3)).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(
      LinearProgramme::Create(MatrixXd::Zero(2, 2), VectorXd::Ones(2)).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(
      LinearProgramme::Create(rows, VectorXd::Constant(2, std::numeric_limits<double>::infinity()))
          .status()));
  ASSERT_OK_AND_ASSIGN(LinearProgramme programme, LinearProgramme::Create(rows, VectorXd::Ones(2)));
  EXPECT_TRUE(absl::IsInvalidArgument(programme.Furthest(VectorXd::Ones(3)).status()));
}

TEST(PolyhedronFactors, EachVariableAndRowIsInOne) {
  Polyhedron polyhedron{MatrixXd::Zero(3, 5), Eigen::Vector3d(1, 2, 3), MatrixXd::Zero(1, 5),
                        VectorXd::Constant(1, 4)};
  polyhedron.inequalities(0, 3) = 1;
  polyhedron.inequalities(1, 0) = polyhedron.inequalities(1, 2) = 1;
  polyhedron.inequalities(2, 2) = -1;
  polyhedron.equalities(0, 1) = polyhedron.equalities(0, 3) = 2;
  const std::vector<PolyhedronFactor> factors = FactorsOf(polyhedron);
  ASSERT_EQ(factors.size(), 3u);
  EXPECT_THAT(factors[0].variables, ElementsAre(0, 2));
  EXPECT_THAT(factors[0].inequalities, ElementsAre(1, 2));
  EXPECT_THAT(factors[1].variables, ElementsAre(1, 3));
  EXPECT_THAT(factors[1].inequalities, ElementsAre(0));
  EXPECT_THAT(factors[1].equalities, ElementsAre(0));
  EXPECT_THAT(factors[2].variables, ElementsAre(4));
  const Polyhedron second = PolyhedronOf(polyhedron, factors[1]);
  EXPECT_EQ(second.inequalities, (MatrixXd(1, 2) << 0, 1).finished());
  EXPECT_EQ(second.equalities, (MatrixXd(1, 2) << 2, 2).finished());
  EXPECT_EQ(second.values[0], 4);
}

}  // namespace
}  // namespace mortise::parametric
