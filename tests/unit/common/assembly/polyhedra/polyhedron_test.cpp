// Nearest points of polyhedra: analytic cases, optimality on random ones, and why there is none.
#include "common/assembly/polyhedra/polyhedron.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <functional>
#include <limits>
#include <random>

#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  Vector Normal(Eigen::Index size) {
    return Vector::NullaryExpr(size, [this] { return normal_(engine_); });
  }
  Matrix Normal(Eigen::Index rows, Eigen::Index columns) {
    return Matrix::NullaryExpr(rows, columns, [this] { return normal_(engine_); });
  }
  double Uniform() { return std::uniform_real_distribution<double>()(engine_); }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

// All |x_i| <= 1.
Polyhedron Cube(Eigen::Index variables) {
  Polyhedron cube;
  cube.inequalities.resize(2 * variables, variables);
  cube.inequalities << Matrix::Identity(variables, variables),
      -Matrix::Identity(variables, variables);
  cube.bounds = Vector::Ones(2 * variables);
  cube.equalities.resize(0, variables);
  return cube;
}

// The nearest point of {x >= 0, sum = 1} by sorting (Held, Wolfe and Crowder 1974).
Vector NearestOfSimplex(const Vector& x) {
  Vector sorted = x;
  std::sort(sorted.begin(), sorted.end(), std::greater<>());
  double sum = 0;
  double shift = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    sum += sorted[i];
    const double candidate = (sum - 1) / static_cast<double>(i + 1);
    if (sorted[i] > candidate) shift = candidate;
  }
  return (x.array() - shift).max(0);
}

// Feasible, and no feasible direction leads nearer: x - point is a combination of the active rows
// that pushes outward only.
void ExpectNearest(const Polyhedron& polyhedron, const Vector& x, const Projection& projection) {
  ASSERT_TRUE(projection.point);
  const Vector& point = *projection.point;
  if (polyhedron.bounds.size() > 0) {
    EXPECT_LE((polyhedron.inequalities * point - polyhedron.bounds).maxCoeff(), 1e-8);
  }
  if (polyhedron.values.size() > 0) {
    EXPECT_LE((polyhedron.equalities * point - polyhedron.values).cwiseAbs().maxCoeff(), 1e-8);
  }
  const auto pushing = static_cast<Eigen::Index>(projection.inequalities.size());
  Matrix rows(pushing + static_cast<Eigen::Index>(projection.equalities.size()), x.size());
  Eigen::Index row = 0;
  for (const int i : projection.inequalities) {
    EXPECT_NEAR(polyhedron.inequalities.row(i).dot(point), polyhedron.bounds[i], 1e-8);
    rows.row(row++) = polyhedron.inequalities.row(i);
  }
  for (const int i : projection.equalities) rows.row(row++) = polyhedron.equalities.row(i);
  if (rows.rows() == 0) {
    EXPECT_TRUE(point.isApprox(x));
    return;
  }
  const Vector multipliers = rows.transpose().colPivHouseholderQr().solve(x - point);
  EXPECT_LE((rows.transpose() * multipliers - (x - point)).norm(), 1e-7);
  if (pushing > 0) {
    EXPECT_GE(multipliers.head(pushing).minCoeff(), -1e-7);
  }
}

TEST(Polyhedron, TheNearestPointOfACubeIsClamped) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    const Eigen::Index variables = 1 + round % 12;
    const Vector x = 2 * random.Normal(variables);
    const auto projection = ProjectOnto(Cube(variables), x);
    ASSERT_TRUE(projection.ok()) << projection.status();
    EXPECT_LE((*projection->point - x.cwiseMax(-1).cwiseMin(1)).norm(), 1e-10);
  }
}

TEST(Polyhedron, TheNearestPointOfASimplexIsThePublishedOne) {
  Random random(2);
  for (int round = 0; round < 200; ++round) {
    const Eigen::Index variables = 2 + round % 20;
    Polyhedron simplex;
    simplex.inequalities = -Matrix::Identity(variables, variables);
    simplex.bounds = Vector::Zero(variables);
    simplex.equalities = Matrix::Ones(1, variables);
    simplex.values = Vector::Ones(1);
    const Vector x = random.Normal(variables);
    const auto projection = ProjectOnto(simplex, x);
    ASSERT_TRUE(projection.ok()) << projection.status();
    EXPECT_LE((*projection->point - NearestOfSimplex(x)).norm(), 1e-9);
  }
}

TEST(Polyhedron, NothingFeasibleIsNearer) {
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    const Eigen::Index variables = 1 + round % 15;
    const Eigen::Index held = round % 3 == 0 ? variables / 3 : 0;
    const Vector inside = random.Normal(variables);
    Polyhedron polyhedron;
    polyhedron.inequalities = random.Normal(3 * variables, variables);
    // Some rows twice, some to and fro: what designs are full of.
    polyhedron.inequalities.row(0) = polyhedron.inequalities.row(1);
    polyhedron.inequalities.row(2) = -polyhedron.inequalities.row(1);
    polyhedron.bounds = polyhedron.inequalities * inside;
    for (double& bound : polyhedron.bounds) bound += random.Uniform() < 0.3 ? 0 : random.Uniform();
    polyhedron.equalities = random.Normal(held, variables);
    polyhedron.values = polyhedron.equalities * inside;
    const Vector x = inside + 3 * random.Normal(variables);
    const auto projection = ProjectOnto(polyhedron, x);
    ASSERT_TRUE(projection.ok()) << projection.status();
    ExpectNearest(polyhedron, x, *projection);
    // What is inside stays.
    const auto again = ProjectOnto(polyhedron, *projection->point);
    ASSERT_TRUE(again.ok() && again->point);
    EXPECT_LE((*again->point - *projection->point).norm(), 1e-8);
  }
}

TEST(Polyhedron, AnEmptyOneSaysWhichRowsConflict) {
  // x <= 1, y <= 1, x + y >= 3 conflict; y >= -5 has no part in it.
  Polyhedron polyhedron;
  polyhedron.inequalities = Matrix{{1, 0}, {0, -1}, {0, 1}, {-1, -1}};
  polyhedron.bounds = Vector{{1, 5, 1, -3}};
  polyhedron.equalities.resize(0, 2);
  auto projection = ProjectOnto(polyhedron, Vector::Zero(2));
  ASSERT_TRUE(projection.ok()) << projection.status();
  EXPECT_FALSE(projection->point);
  EXPECT_THAT(projection->inequalities, ElementsAre(0, 2, 3));
  EXPECT_THAT(projection->equalities, IsEmpty());

  polyhedron = Cube(3);
  polyhedron.equalities = Matrix{{0, 1, 0}, {1, 0, 1}};
  polyhedron.values = Vector{{0.5, 2.5}};
  projection = ProjectOnto(polyhedron, Vector::Zero(3));
  ASSERT_TRUE(projection.ok()) << projection.status();
  EXPECT_FALSE(projection->point);
  EXPECT_THAT(projection->inequalities, ElementsAre(0, 2));
  EXPECT_THAT(projection->equalities, ElementsAre(1));

  polyhedron.equalities = Matrix{{0, 1, 0}, {0, 2, 0}};
  projection = ProjectOnto(polyhedron, Vector::Zero(3));
  ASSERT_TRUE(projection.ok()) << projection.status();
  EXPECT_FALSE(projection->point);
  EXPECT_THAT(projection->equalities, ElementsAre(0, 1));
}

TEST(Polyhedron, RandomEmptyOnesAreRecognised) {
  Random random(4);
  for (int round = 0; round < 100; ++round) {
    const Eigen::Index variables = 2 + round % 8;
    // Normals that balance, with bounds whose weighted sum is negative: empty by Farkas' lemma.
    Polyhedron polyhedron;
    polyhedron.inequalities = random.Normal(variables + 4, variables);
    const Vector weights = random.Normal(variables + 3).cwiseAbs();
    polyhedron.inequalities.row(variables + 3) =
        -weights.transpose() * polyhedron.inequalities.topRows(variables + 3);
    polyhedron.bounds = random.Normal(variables + 4);
    polyhedron.bounds[variables + 3] = -weights.dot(polyhedron.bounds.head(variables + 3)) - 0.1;
    polyhedron.equalities.resize(0, variables);
    const auto projection = ProjectOnto(polyhedron, random.Normal(variables));
    ASSERT_TRUE(projection.ok()) << projection.status();
    EXPECT_FALSE(projection->point);
    EXPECT_FALSE(projection->inequalities.empty());
    // The rows it names are empty by themselves.
    Polyhedron named = polyhedron;
    const auto count = static_cast<Eigen::Index>(projection->inequalities.size());
    named.inequalities.resize(count, variables);
    named.bounds.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const int row = projection->inequalities[static_cast<std::size_t>(i)];
      named.inequalities.row(i) = polyhedron.inequalities.row(row);
      named.bounds[i] = polyhedron.bounds[row];
    }
    EXPECT_FALSE(ProjectOnto(named, Vector::Zero(variables))->point);
  }
}

TEST(Polyhedron, FindsDirectionsWithoutEnd) {
  Random random(5);
  EXPECT_FALSE(UnboundedDirection(Cube(4).inequalities)->has_value());
  EXPECT_FALSE(UnboundedDirection(Matrix(0, 0))->has_value());
  EXPECT_TRUE(UnboundedDirection(Matrix(0, 2))->has_value());
  for (int round = 0; round < 200; ++round) {
    const Eigen::Index variables = 1 + round % 10;
    Matrix rows = random.Normal(3 * variables, variables);
    const Vector way = random.Normal(variables).normalized();
    // Open along `way` in every other round: no row rises along it.
    const bool open = round % 2 == 0;
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      if (open && rows.row(i).dot(way) > 0) rows.row(i) *= -1;
    }
    if (!open) {
      rows.conservativeResize(rows.rows() + 1, Eigen::NoChange);
      const Vector weights = random.Normal(rows.rows() - 1).cwiseAbs();
      rows.bottomRows(1) = -weights.transpose() * rows.topRows(rows.rows() - 1);
    }
    const auto direction = UnboundedDirection(rows);
    ASSERT_TRUE(direction.ok()) << direction.status();
    ASSERT_EQ(direction->has_value(), open) << round;
    if (open) {
      EXPECT_NEAR((*direction)->norm(), 1, 1e-9);
      EXPECT_LE((rows * **direction).maxCoeff(), 1e-7);
    }
  }
}

TEST(Polyhedron, BadInputIsRefused) {
  Polyhedron cube = Cube(2);
  EXPECT_TRUE(absl::IsInvalidArgument(ProjectOnto(cube, Vector::Zero(3)).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(
      ProjectOnto(cube, Vector{{0, std::numeric_limits<double>::quiet_NaN()}}).status()));
  cube.inequalities.row(0).setZero();
  EXPECT_TRUE(absl::IsInvalidArgument(ProjectOnto(cube, Vector::Zero(2)).status()));
}

}  // namespace
}  // namespace mortise::parametric
