// How far polyhedra go, against one linear programme for each end and against known shapes.
#include "common/assembly/polyhedra/polyhedron_extents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "common/assembly/polyhedra/linear_programme.h"
#include "common/base/errors.h"
#include "tests/support/status_assertions.h"

namespace mortise::parametric {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd NormalRows(Eigen::Index rows, Eigen::Index columns, std::mt19937& random) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// Whatever a polyhedron looks like, and whether directions lie along its rows or across them.
TEST(PolyhedronExtents, AreThoseOfOneLinearProgrammeForEachEnd) {
  std::mt19937 random(3);
  for (int round = 0; round < 60; ++round) {
    const Eigen::Index variables = 2 + round % 9;
    MatrixXd rows(5 * variables, variables);
    rows << NormalRows(3 * variables, variables, random), MatrixXd::Identity(variables, variables),
        -MatrixXd::Identity(variables, variables);
    const VectorXd bounds = NormalRows(rows.rows(), 1, random).cwiseAbs();
    MatrixXd directions(3 * variables, variables);
    directions << 2.5 * MatrixXd::Identity(variables, variables), rows.topRows(variables),
        NormalRows(variables, variables, random);
    ASSERT_OK_AND_ASSIGN(const Extents extents, ExtentsAlong(rows, bounds, directions));
    ASSERT_OK_AND_ASSIGN(LinearProgramme programme, LinearProgramme::Create(rows, bounds));
    for (Eigen::Index i = 0; i < directions.rows(); ++i) {
      const VectorXd direction = directions.row(i).transpose();
      ASSERT_OK_AND_ASSIGN(const auto to, programme.Furthest(direction));
      ASSERT_OK_AND_ASSIGN(const auto fro, programme.Furthest(-direction));
      EXPECT_NEAR(extents.greatest[i], direction.dot(*to), 1e-8) << "round " << round;
      EXPECT_NEAR(extents.least[i], direction.dot(*fro), 1e-8) << "round " << round;
    }
  }
}

// Boards between 1 and 2 wide, all together no more than n + 1 wide: each can have its largest
// width, though never two of them, and its smallest.
TEST(PolyhedronExtents, ReachLimitsThatHinderEachOther) {
  constexpr Eigen::Index kBoards = 40;
  MatrixXd rows(2 * kBoards + 1, kBoards);
  rows << MatrixXd::Identity(kBoards, kBoards), -MatrixXd::Identity(kBoards, kBoards),
      Eigen::RowVectorXd::Ones(kBoards);
  VectorXd bounds(2 * kBoards + 1);
  bounds << VectorXd::Constant(kBoards, 2), VectorXd::Constant(kBoards, -1), kBoards + 1;
  ASSERT_OK_AND_ASSIGN(const Extents extents,
                       ExtentsAlong(rows, bounds, MatrixXd::Identity(kBoards, kBoards)));
  EXPECT_EQ(extents.greatest, VectorXd::Constant(kBoards, 2));
  EXPECT_EQ(extents.least, VectorXd::Constant(kBoards, 1));

  // One board less to spare: the limit that none reaches is not its end.
  bounds[2 * kBoards] = kBoards + 0.25;
  ASSERT_OK_AND_ASSIGN(const Extents closer,
                       ExtentsAlong(rows, bounds, MatrixXd::Identity(kBoards, kBoards)));
  EXPECT_TRUE(closer.greatest.isApprox(VectorXd::Constant(kBoards, 1.25), 1e-9));
  EXPECT_EQ(closer.least, VectorXd::Constant(kBoards, 1));
}

// Along the diagonals of the octahedron |x| + |y| + |z| <= 1 and its axes.
TEST(PolyhedronExtents, OfAnOctahedron) {
  MatrixXd rows(8, 3);
  for (int corner = 0; corner < 8; ++corner) {
    rows.row(corner) << (corner & 1 ? 1 : -1), (corner & 2 ? 1 : -1), (corner & 4 ? 1 : -1);
  }
  MatrixXd directions(3, 3);
  directions << 1, 1, 1, 0, 3, 0, 1, -1, 0;
  ASSERT_OK_AND_ASSIGN(const Extents extents, ExtentsAlong(rows, VectorXd::Ones(8), directions));
  EXPECT_TRUE(extents.greatest.isApprox(Eigen::Vector3d(1, 3, 1), 1e-9));
  EXPECT_TRUE(extents.least.isApprox(-Eigen::Vector3d(1, 3, 1), 1e-9));
}

TEST(PolyhedronExtents, AreInfiniteWhereAPolyhedronIsOpen) {
  MatrixXd rows(3, 2);  // a strip along x, closed at its left
  rows << 0, 1, 0, -1, -1, 0;
  ASSERT_OK_AND_ASSIGN(const Extents extents,
                       ExtentsAlong(rows, VectorXd::Ones(3), MatrixXd::Identity(2, 2)));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(extents.greatest, Eigen::Vector2d(kInfinity, 1));
  EXPECT_EQ(extents.least, Eigen::Vector2d(-1, -1));
}

TEST(PolyhedronExtents, OfNoPolyhedronAndAlongNoDirectionAreErrors) {
  MatrixXd rows(2, 1);
  rows << 1, -1;
  const VectorXd apart = VectorXd::Constant(2, -1);
  EXPECT_EQ(DetailOf(ExtentsAlong(rows, apart, MatrixXd::Ones(1, 1)).status()).reason,
            "POLYHEDRON_EMPTY");
  const VectorXd bounds = VectorXd::Ones(2);
  for (const MatrixXd& directions : {MatrixXd(MatrixXd::Zero(1, 1)), MatrixXd(MatrixXd::Ones(1, 2)),
                                     MatrixXd(MatrixXd::Constant(1, 1, std::nan("")))}) {
    EXPECT_EQ(DetailOf(ExtentsAlong(rows, bounds, directions).status()).field, "directions");
  }
  ASSERT_OK_AND_ASSIGN(const Extents none, ExtentsAlong(rows, bounds, MatrixXd(0, 1)));
  EXPECT_EQ(none.greatest.size(), 0);
}

}  // namespace
}  // namespace mortise::parametric
