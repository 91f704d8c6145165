// Sampling and furthest points of polyhedra, against those whose moments and corners are known.
#include "common/assembly/polyhedra/hit_and_run.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "common/assembly/polyhedra/polyhedron.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// -half_size <= x <= half_size.
Polyhedron BoxOf(const VectorXd& half_size) {
  const Eigen::Index n = half_size.size();
  Polyhedron box{MatrixXd(2 * n, n), VectorXd(2 * n), MatrixXd(0, n), VectorXd(0)};
  box.inequalities << MatrixXd::Identity(n, n), -MatrixXd::Identity(n, n);
  box.bounds << half_size, half_size;
  return box;
}

MatrixXd RandomRotation(Eigen::Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MatrixXd entries(n, n);
  for (double& entry : entries.reshaped()) entry = normal(random);
  return MatrixXd(entries.householderQr().householderQ());
}

MatrixXd Samples(const Polyhedron& polyhedron, int count, unsigned seed) {
  const auto samples = SamplePolyhedron(polyhedron.inequalities, polyhedron.bounds, count, seed);
  EXPECT_TRUE(samples.ok()) << samples.status();
  MatrixXd columns(polyhedron.inequalities.cols(), count);
  for (int i = 0; i < count; ++i) columns.col(i) = (*samples)[static_cast<std::size_t>(i)];
  return columns;
}

// A box ten thousand times as long as thick, turned anyhow: mean 0 and variance a third of the half
// size squared along each of its axes, and both ends are reached.
TEST(HitAndRun, SpreadsEvenlyInLongThinBoxes) {
  VectorXd half_size(5);
  half_size << 100, 1, 0.1, 10, 0.01;
  Polyhedron box = BoxOf(half_size);
  const MatrixXd rotation = RandomRotation(5, 3);
  box.inequalities *= rotation.transpose();
  constexpr int kCount = 2000;
  const MatrixXd along = rotation.transpose() * Samples(box, kCount, 1);
  for (int axis = 0; axis < 5; ++axis) {
    const VectorXd scaled = along.row(axis) / half_size[axis];
    EXPECT_LE(scaled.cwiseAbs().maxCoeff(), 1 + 1e-6);
    // Six standard errors of independent samples, twice.
    EXPECT_NEAR(scaled.mean(), 0, 12 * std::sqrt(1.0 / 3 / kCount));
    EXPECT_NEAR(scaled.squaredNorm() / kCount, 1.0 / 3, 0.08);
    EXPECT_GT(scaled.maxCoeff(), 0.95);
    EXPECT_LT(scaled.minCoeff(), -0.95);
  }
}

// Prisms between two far corners, narrow across and wider in the middle: every axis ends at one of
// the two, which must not make a line of what has room in all directions.
TEST(HitAndRun, ReachesWhatTheEndsOfTheAxesDoNotShow) {
  for (Eigen::Index variables = 2; variables <= 6; ++variables) {
    // Along the diagonal from -1 to 1; in each direction across it less than 1 - |diagonal|, times
    // a tenth.
    const VectorXd diagonal = VectorXd::Ones(variables).normalized();
    MatrixXd frame = RandomRotation(variables, 7);
    frame.col(0) = diagonal;
    frame = MatrixXd(frame.householderQr().householderQ());
    Polyhedron rhombus{MatrixXd(4 * (variables - 1), variables),
                       VectorXd::Ones(4 * (variables - 1)), MatrixXd(0, variables), VectorXd(0)};
    for (Eigen::Index i = 1; i < variables; ++i) {
      for (int side = 0; side < 4; ++side) {
        rhombus.inequalities.row(4 * (i - 1) + side) =
            (side % 2 == 0 ? 1 : -1) * diagonal.transpose() +
            (side < 2 ? 10 : -10) * frame.col(i).transpose();
      }
    }
    const MatrixXd across = frame.rightCols(variables - 1).transpose() * Samples(rhombus, 400, 5);
    for (Eigen::Index i = 0; i < across.rows(); ++i) {
      EXPECT_GT(across.row(i).maxCoeff(), 0.04) << variables;
      EXPECT_LT(across.row(i).minCoeff(), -0.04) << variables;
    }
  }
}

// Of the simplex x >= 0, sum x <= 1 in n variables the mean is 1 / (n + 1) for each.
TEST(HitAndRun, FindsTheMeanOfASimplex) {
  constexpr Eigen::Index kVariables = 8;
  Polyhedron simplex{MatrixXd(kVariables + 1, kVariables), VectorXd::Zero(kVariables + 1),
                     MatrixXd(0, kVariables), VectorXd(0)};
  simplex.inequalities << -MatrixXd::Identity(kVariables, kVariables),
      Eigen::RowVectorXd::Ones(kVariables);
  simplex.bounds[kVariables] = 1;
  const MatrixXd samples = Samples(simplex, 4000, 2);
  for (Eigen::Index i = 0; i < kVariables; ++i) {
    EXPECT_NEAR(samples.row(i).mean(), 1.0 / (kVariables + 1), 0.01);
  }
}

// Two inequalities that are an equality together leave a line; starting on it, or on a corner, must
// not keep the walk there.
TEST(HitAndRun, WalksWithinFlatPolyhedra) {
  Polyhedron flat = BoxOf(Eigen::Vector3d(1, 1, 1));
  flat.inequalities.conservativeResize(8, Eigen::NoChange);
  flat.bounds.conservativeResize(8);
  flat.inequalities.row(6) << 1, 1, 0;
  flat.inequalities.row(7) << -1, -1, 0;
  flat.bounds.tail(2).setZero();
  const MatrixXd samples = Samples(flat, 500, 3);
  EXPECT_LT((samples.row(0) + samples.row(1)).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_GT(samples.row(0).maxCoeff() - samples.row(0).minCoeff(), 1.8);
  EXPECT_GT(samples.row(2).maxCoeff() - samples.row(2).minCoeff(), 1.8);
}

TEST(HitAndRun, ASinglePointIsItsOnlySample) {
  const MatrixXd samples = Samples(BoxOf(VectorXd::Zero(2)), 5, 1);
  EXPECT_LT(samples.cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(Samples(BoxOf(VectorXd(0)), 3, 1).size(), 0);
}

TEST(HitAndRun, ASeedGivesTheSamePoints) {
  const Polyhedron box = BoxOf(Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(Samples(box, 20, 4), Samples(box, 20, 4));
  EXPECT_NE(Samples(box, 20, 4), Samples(box, 20, 5));
}

TEST(HitAndRun, RefusesWhatHasNoEnd) {
  const Polyhedron box = BoxOf(Eigen::Vector2d(1, 1));
  const auto open = SamplePolyhedron(box.inequalities.topRows(3), box.bounds.head(3), 1, 1);
  EXPECT_EQ(DetailOf(open.status()).reason, "POLYHEDRON_UNBOUNDED");
}

// A square and a triangle that know nothing of each other: each is as it would be alone, and where
// one is says nothing about the other.
TEST(HitAndRun, FactorsAreIndependent) {
  Polyhedron product{MatrixXd::Zero(7, 4), VectorXd::Zero(7), MatrixXd(0, 4), VectorXd(0)};
  // x0 and x2 within ±1; x1, x3 >= 0 and x1 + x3 <= 1.
  product.inequalities(0, 0) = product.inequalities(1, 2) = 1;
  product.inequalities(2, 0) = product.inequalities(3, 2) = -1;
  product.inequalities(4, 1) = product.inequalities(5, 3) = -1;
  product.inequalities(6, 1) = product.inequalities(6, 3) = 1;
  product.bounds << 1, 1, 1, 1, 0, 0, 1;
  constexpr int kCount = 4000;
  const MatrixXd samples = Samples(product, kCount, 6);
  EXPECT_LE((product.inequalities * samples).rowwise().maxCoeff().coeff(6), 1 + 1e-9);
  EXPECT_NEAR(samples.row(1).mean(), 1.0 / 3, 0.02);
  EXPECT_NEAR(samples.row(3).mean(), 1.0 / 3, 0.02);
  const MatrixXd centered = samples.colwise() - samples.rowwise().mean();
  const MatrixXd covariance = centered * centered.transpose() / kCount;
  EXPECT_NEAR(covariance(0, 0), 1.0 / 3, 0.03);
  EXPECT_NEAR(covariance(1, 3), -1.0 / 36, 0.005);
  for (const auto& [a, b] : {std::pair{0, 1}, {0, 3}, {2, 1}, {2, 3}, {0, 2}}) {
    EXPECT_NEAR(covariance(a, b), 0, 0.02) << a << " and " << b;
  }
}

// Of a box that lies anyhow among many directions a line leads a small part of the way only: what
// comes next must still tell nothing of what was before.
TEST(HitAndRun, SamplesTellNothingOfEachOther) {
  Polyhedron box = BoxOf(VectorXd::Ones(40));
  const MatrixXd rotation = RandomRotation(40, 8);
  box.inequalities *= rotation.transpose();
  constexpr int kCount = 1000;
  const MatrixXd along = rotation.transpose() * Samples(box, kCount, 7);
  const MatrixXd now = along.leftCols(kCount - 1);
  const MatrixXd next = along.rightCols(kCount - 1);
  const double together = now.cwiseProduct(next).mean();
  EXPECT_NEAR(together / along.array().square().mean(), 0, 0.05);
  EXPECT_NEAR(along.array().square().mean(), 1.0 / 3, 0.01);
}

// ---- Furthest points ----------------------------------------------------------------------------

// The largest product over all corners: intersections of three planes that are inside.
double LargestOverCorners(const Polyhedron& polyhedron, const Eigen::Vector3d& direction) {
  double largest = -std::numeric_limits<double>::infinity();
  const Eigen::Index m = polyhedron.inequalities.rows();
  for (Eigen::Index i = 0; i < m; ++i) {
    for (Eigen::Index j = i + 1; j < m; ++j) {
      for (Eigen::Index k = j + 1; k < m; ++k) {
        Eigen::Matrix3d planes;
        planes << polyhedron.inequalities.row(i), polyhedron.inequalities.row(j),
            polyhedron.inequalities.row(k);
        if (std::abs(planes.determinant()) < 1e-9) continue;
        const Eigen::Vector3d corner =
            planes.inverse() *
            Eigen::Vector3d(polyhedron.bounds[i], polyhedron.bounds[j], polyhedron.bounds[k]);
        if ((polyhedron.inequalities * corner - polyhedron.bounds).maxCoeff() > 1e-9) continue;
        largest = std::max(largest, direction.dot(corner));
      }
    }
  }
  return largest;
}

TEST(FurthestAlong, FindsTheFurthestCorner) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 60; ++round) {
    Polyhedron cut = BoxOf(Eigen::Vector3d(5, 5, 5));
    cut.inequalities.conservativeResize(14, Eigen::NoChange);
    cut.bounds.conservativeResize(14);
    for (Eigen::Index row = 6; row < 14; ++row) {
      cut.inequalities.row(row) << normal(random), normal(random), normal(random);
      cut.bounds[row] = std::abs(normal(random));
    }
    const Eigen::Vector3d direction(normal(random), normal(random), normal(random));
    const auto found = FurthestAlong(cut, direction, Eigen::Vector3d::Zero());
    ASSERT_TRUE(found.ok()) << found.status();
    ASSERT_TRUE(found->point.has_value());
    EXPECT_LT((cut.inequalities * *found->point - cut.bounds).maxCoeff(), 1e-8);
    EXPECT_NEAR(direction.dot(*found->point), LargestOverCorners(cut, direction), 1e-8);
  }
}

TEST(FurthestAlong, TellsEmptyFromEndless) {
  Polyhedron half{Eigen::RowVector2d(1, 0), VectorXd::Ones(1), MatrixXd(0, 2), VectorXd(0)};
  const auto endless = FurthestAlong(half, Eigen::Vector2d(0, 1), Eigen::Vector2d::Zero());
  ASSERT_TRUE(endless.ok()) << endless.status();
  EXPECT_FALSE(endless->point.has_value());
  EXPECT_TRUE(endless->inequalities.empty());
  const auto bounded = FurthestAlong(half, Eigen::Vector2d(2, 0), Eigen::Vector2d(-7, 3));
  EXPECT_NEAR((*bounded->point)[0], 1, 1e-9);

  Polyhedron empty{MatrixXd(2, 1), VectorXd(2), MatrixXd(0, 1), VectorXd(0)};
  empty.inequalities << 1, -1;
  empty.bounds << -1, -1;
  const auto none = FurthestAlong(empty, VectorXd::Ones(1), VectorXd::Zero(1));
  ASSERT_TRUE(none.ok()) << none.status();
  EXPECT_FALSE(none->point.has_value());
  EXPECT_EQ(none->inequalities, (std::vector<int>{0, 1}));
}

}  // namespace
}  // namespace mortise::parametric
