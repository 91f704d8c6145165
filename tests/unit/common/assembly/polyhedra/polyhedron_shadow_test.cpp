// Shadows of polyhedra, against known ones and against linear programmes for single points.
#include "common/assembly/polyhedra/polyhedron_shadow.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "common/assembly/polyhedra/hit_and_run.h"
#include "common/assembly/polyhedra/linear_programme.h"
#include "common/assembly/polyhedra/polyhedron.h"
#include "common/base/errors.h"
#include "tests/support/status_assertions.h"

namespace mortise::parametric {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd RandomFormRows(Index rows, Index columns, std::mt19937& random) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

struct ShadowCase {
  MatrixXd inequalities;
  VectorXd bounds;
  MatrixXd forms;
};

// A bounded polyhedron around 0, and forms of its points.
ShadowCase RandomShadowCase(Index variables, Index forms, std::mt19937& random) {
  ShadowCase made;
  made.inequalities.resize(5 * variables, variables);
  made.inequalities << RandomFormRows(3 * variables, variables, random),
      MatrixXd::Identity(variables, variables), -MatrixXd::Identity(variables, variables);
  made.bounds = RandomFormRows(5 * variables, 1, random).cwiseAbs().array() + 0.1;
  made.forms = RandomFormRows(forms, variables, random);
  return made;
}

// Whether some point has these values,.
bool HasPointWithForms(const ShadowCase& of, const VectorXd& values) {
  const Polyhedron polyhedron{of.inequalities, of.bounds, of.forms, values};
  return ProjectOnto(polyhedron, VectorXd::Zero(of.forms.cols()))->point.has_value();
}

TEST(PolyhedronShadow, OfACubeAlongItsDiagonalIsAHexagon) {
  MatrixXd rows(6, 3);
  rows << MatrixXd::Identity(3, 3), -MatrixXd::Identity(3, 3);
  MatrixXd forms(2, 3);
  forms << 1, -1, 0, 1, 1, -2;
  ASSERT_OK_AND_ASSIGN(const PolyhedronShadow shadow, ShadowOf(rows, VectorXd::Ones(6), forms));
  // Corners of the cube are corners of the hexagon, or its middle.
  for (const double x : {-1.0, 1.0}) {
    const VectorXd corner = forms * Eigen::Vector3d(x, -x, x);
    const VectorXd excess = shadow.inequalities * corner - shadow.bounds;
    EXPECT_NEAR(excess.maxCoeff(), 0, 1e-9);
    EXPECT_GT((shadow.inequalities * (1.001 * corner) - shadow.bounds).maxCoeff(), 1e-4);
  }
  const VectorXd beyond = forms * Eigen::Vector3d(1, -1, 0) * 1.001;
  EXPECT_GT((shadow.inequalities * beyond - shadow.bounds).maxCoeff(), 1e-4);
}

TEST(PolyhedronShadow, HasTheShadowsOfAllPoints) {
  std::mt19937 random(3);
  for (int round = 0; round < 10; ++round) {
    const ShadowCase of = RandomShadowCase(6, 2 + round % 3, random);
    ASSERT_OK_AND_ASSIGN(const PolyhedronShadow shadow,
                         ShadowOf(of.inequalities, of.bounds, of.forms));
    ASSERT_OK_AND_ASSIGN(LinearProgramme programme,
                         LinearProgramme::Create(of.inequalities, of.bounds));
    for (int i = 0; i < 50; ++i) {
      ASSERT_OK_AND_ASSIGN(const auto corner, programme.Furthest(RandomFormRows(6, 1, random)));
      EXPECT_LT((shadow.inequalities * (of.forms * *corner) - shadow.bounds).maxCoeff(), 1e-7);
    }
  }
}

TEST(PolyhedronShadow, HasHardlyAnythingElse) {
  std::mt19937 random(4);
  for (int round = 0; round < 10; ++round) {
    const ShadowCase of = RandomShadowCase(7, 2 + round % 4, random);
    ASSERT_OK_AND_ASSIGN(const PolyhedronShadow shadow,
                         ShadowOf(of.inequalities, of.bounds, of.forms));
    ASSERT_OK_AND_ASSIGN(const auto samples,
                         SamplePolyhedron(shadow.inequalities, shadow.bounds, 200, 1));
    int outside = 0;
    for (const VectorXd& values : samples) outside += HasPointWithForms(of, values) ? 0 : 1;
    EXPECT_LE(outside, 1) << "round " << round;
  }
}

TEST(PolyhedronShadow, TouchesThePolyhedronWithEachInequality) {
  std::mt19937 random(5);
  const ShadowCase of = RandomShadowCase(8, 3, random);
  ASSERT_OK_AND_ASSIGN(const PolyhedronShadow shadow,
                       ShadowOf(of.inequalities, of.bounds, of.forms));
  ASSERT_OK_AND_ASSIGN(LinearProgramme programme,
                       LinearProgramme::Create(of.inequalities, of.bounds));
  for (Index i = 0; i < shadow.bounds.size(); ++i) {
    const VectorXd along = of.forms.transpose() * shadow.inequalities.row(i).transpose();
    ASSERT_OK_AND_ASSIGN(const auto furthest, programme.Furthest(along));
    EXPECT_NEAR(along.dot(*furthest), shadow.bounds[i], 1e-7);
  }
}

// The third form is the sum of the others, and the fourth says the same as the first.
TEST(PolyhedronShadow, HoldsTogetherFormsThatDependOnEachOther) {
  std::mt19937 random(6);
  ShadowCase of = RandomShadowCase(5, 4, random);
  of.forms.row(2) = of.forms.row(0) + of.forms.row(1);
  of.forms.row(3) = 2 * of.forms.row(0);
  ASSERT_OK_AND_ASSIGN(const PolyhedronShadow shadow,
                       ShadowOf(of.inequalities, of.bounds, of.forms));
  ASSERT_OK_AND_ASSIGN(const auto samples,
                       SamplePolyhedron(shadow.inequalities, shadow.bounds, 50, 1));
  for (const VectorXd& values : samples) {
    EXPECT_NEAR(values[2], values[0] + values[1], 1e-6);
    EXPECT_NEAR(values[3], 2 * values[0], 1e-6);
  }
}

TEST(PolyhedronShadow, RefusesWhatHasNoEndAndWhatMakesNoSense) {
  const MatrixXd rows = -MatrixXd::Identity(2, 2);
  EXPECT_EQ(DetailOf(ShadowOf(rows, VectorXd::Zero(2), MatrixXd::Ones(1, 2)).status()).reason,
            "POLYHEDRON_UNBOUNDED");
  EXPECT_TRUE(
      absl::IsInvalidArgument(ShadowOf(rows, VectorXd::Zero(2), MatrixXd::Zero(1, 2)).status()));
  EXPECT_TRUE(
      absl::IsInvalidArgument(ShadowOf(rows, VectorXd::Zero(3), MatrixXd::Ones(1, 2)).status()));
}

}  // namespace
}  // namespace mortise::parametric
