// Covers of manifolds with known answers: their size, their errors, and their cost.
#include "services/retrieval/cover/manifold_cover.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/retrieval/cover/cover_error.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/retrieval/cover/known_manifolds.h"

namespace mortise::retrieval {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

CoverOptions Options(double delta, CoverKind kind = CoverKind::kMixed) {
  return {.delta = delta, .seed = 11, .rejections = 500, .kind = kind};
}

Cover CoverOf(const ManifoldFunctions& functions, const CoverOptions& options) {
  const FunctionManifold manifold(functions);
  auto cover = CoverManifold(manifold, options);
  EXPECT_OK(cover);
  return cover.ok() ? *std::move(cover) : Cover{};
}

int TangentsOf(const Cover& cover) {
  return static_cast<int>(
      std::count_if(cover.primitives.begin(), cover.primitives.end(),
                    [](const Primitive& each) { return each.axes.cols() > 0; }));
}

// The 99th percentiles of both errors are at most δ, as the thesis asks.
void ExpectWithinDelta(const ManifoldFunctions& functions, const Cover& cover, double delta) {
  const FunctionManifold manifold(functions);
  const ErrorSampling sampling{.count = 1000, .seed = 23};
  ASSERT_OK_AND_ASSIGN(const auto coverage, CoverageErrors(manifold, cover.primitives, sampling));
  ASSERT_OK_AND_ASSIGN(const auto fitting, FittingErrors(manifold, cover.primitives, sampling));
  EXPECT_LE(Quantile(coverage, 0.99), delta);
  EXPECT_LE(Quantile(fitting, 0.99), delta);
}

TEST(ManifoldCover, OfALineIsAFewTangents) {
  const Cover cover = CoverOf(testing::Line(1), Options(0.01));
  EXPECT_EQ(cover.end, CoverEnd::kCovered);
  EXPECT_GE(TangentsOf(cover), 1);
  EXPECT_LE(cover.cost, 12);  // points alone take more than 50
  ExpectWithinDelta(testing::Line(1), cover, 0.01);
}

TEST(ManifoldCover, OfAShortLineIsAPoint) {
  const Cover cover = CoverOf(testing::Line(1), Options(1));
  EXPECT_EQ(cover.cost, 1);
  EXPECT_EQ(TangentsOf(cover), 0);
}

TEST(ManifoldCover, PointsOfACircleAreAtLeastDeltaApartAndEnough) {
  const double delta = 0.1;
  const Cover cover = CoverOf(testing::Circle(), Options(delta, CoverKind::kPoints));
  // Each covers an arc of 2δ to either side together; neighbours are further than δ apart.
  EXPECT_GE(cover.cost, std::ceil(2 * std::numbers::pi / (2 * 1.01 * delta)));
  EXPECT_LE(cover.cost, std::floor(2 * std::numbers::pi / delta));
  for (const Primitive& a : cover.primitives) {
    for (const Primitive& b : cover.primitives) {
      if (&a != &b) {
        EXPECT_GT((a.center - b.center).norm(), delta);
      }
    }
  }
}

TEST(ManifoldCover, OfACircleNeedsTangentsAsItsCurvatureAsks) {
  for (const double delta : {0.1, 0.01, 0.001}) {
    const Cover cover = CoverOf(testing::Circle(), Options(delta, CoverKind::kTangents));
    // A tangent covers √(2δ) to either side; at random places at most twice as many are needed.
    const double least = std::numbers::pi / std::sqrt(2 * delta);
    EXPECT_GE(cover.primitives.size(), std::floor(0.95 * least)) << delta;
    EXPECT_LE(cover.primitives.size(), 2.5 * least + 2) << delta;
    ExpectWithinDelta(testing::Circle(), cover, delta);
  }
}

TEST(ManifoldCover, CostGrowsAsDeltaToThePowerThatTheKindHas) {
  const auto cost = [](double delta, CoverKind kind) {
    return static_cast<double>(CoverOf(testing::Circle(), Options(delta, kind)).cost);
  };
  EXPECT_NEAR(cost(0.001, CoverKind::kPoints) / cost(0.1, CoverKind::kPoints), 100, 30);
  EXPECT_NEAR(cost(0.0001, CoverKind::kTangents) / cost(0.01, CoverKind::kTangents), 10, 3);
}

TEST(ManifoldCover, ErrorsStayWithinDelta) {
  for (const auto& functions : {testing::Paraboloid(), testing::SpherePatch(), testing::Sheet(),
                                testing::Cylinder(), testing::Proportions()}) {
    for (const double delta : {0.2, 0.05}) {
      const Cover cover = CoverOf(functions, Options(delta));
      EXPECT_EQ(cover.end, CoverEnd::kCovered);
      ExpectWithinDelta(functions, cover, delta);
    }
  }
}

TEST(ManifoldCover, OfAFlatSheetIsFewTangents) {
  const Cover cover = CoverOf(testing::Sheet(), Options(0.02));
  const Cover points = CoverOf(testing::Sheet(), Options(0.02, CoverKind::kPoints));
  EXPECT_LE(cover.cost * 5, points.cost);
}

TEST(ManifoldCover, OfAThinRodUsesTheAxisThatPays) {
  // A rod of radius 0.2 and length 4: across it a tangent reaches little further than a point.
  const ManifoldFunctions rod = testing::Over(
      Vector2d(0, 0), Vector2d(3, 4), 3, [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
        return VectorXd(Eigen::Vector3d(0.2 * std::cos(q[0]), 0.2 * std::sin(q[0]), q[1]));
      });
  CoverOptions options = Options(0.2);
  options.race = false;
  const Cover cover = CoverOf(rod, options);
  const auto single = std::count_if(cover.primitives.begin(), cover.primitives.end(),
                                    [](const Primitive& each) { return each.axes.cols() == 1; });
  EXPECT_GT(single, 0);
  options.kind = CoverKind::kTangents;
  EXPECT_LE(cover.cost, CoverOf(rod, options).cost);
}

TEST(ManifoldCover, RedundantParametersCostNoAxes) {
  const Cover cover = CoverOf(testing::Proportions(), Options(0.02));
  EXPECT_GT(TangentsOf(cover), 0);
  for (const Primitive& primitive : cover.primitives) EXPECT_LE(primitive.axes.cols(), 2);
}

TEST(ManifoldCover, MixtureIsNeverDearerThanEitherKindAlone) {
  double best_ratio = 0;
  for (const auto& functions :
       {testing::Paraboloid(), testing::SpherePatch(), testing::Sheet(), testing::Cylinder()}) {
    for (const double delta : {0.4, 0.1, 0.02}) {
      const long mixed = CoverOf(functions, Options(delta)).cost;
      const long points = CoverOf(functions, Options(delta, CoverKind::kPoints)).cost;
      const long tangents = CoverOf(functions, Options(delta, CoverKind::kTangents)).cost;
      EXPECT_LE(mixed, std::min(points, tangents)) << delta;
      best_ratio = std::max(
          best_ratio, static_cast<double>(std::max(points, tangents)) / static_cast<double>(mixed));
    }
  }
  EXPECT_GE(best_ratio, 2);
}

TEST(ManifoldCover, KeepsWithinConstraintsThatCutTheBox) {
  ManifoldFunctions functions = testing::Sheet();
  functions.cuts.normals = Eigen::RowVector2d(1, 2);
  functions.cuts.bounds = VectorXd::Constant(1, 1);
  const auto sheet = functions.evaluate;
  functions.evaluate = [sheet](const VectorXd& q) -> absl::StatusOr<VectorXd> {
    if (q[0] + 2 * q[1] > 1 + 1e-9) return absl::InternalError("outside of the cut");
    return sheet(q);
  };
  const Cover cover = CoverOf(functions, Options(0.02));
  EXPECT_EQ(cover.failures, 0);
  ExpectWithinDelta(functions, cover, 0.02);
}

TEST(ManifoldCover, CoversStructuresApart) {
  // The same line twice, once for each structure.
  ManifoldFunctions functions = testing::Over(VectorXd::Constant(1, -1), VectorXd::Ones(1), 2,
                                              [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
                                                return VectorXd(Vector2d(std::abs(q[0]), 0));
                                              });
  functions.structure = [](const VectorXd& q) { return q[0] < 0 ? 1 : 2; };
  const Cover cover = CoverOf(functions, Options(0.01));
  int ones = 0, twos = 0;
  for (const Primitive& primitive : cover.primitives) {
    ones += primitive.structure == 1 ? 1 : 0;
    twos += primitive.structure == 2 ? 1 : 0;
    EXPECT_EQ(primitive.structure, primitive.parameters[0] < 0 ? 1 : 2);
  }
  EXPECT_GT(ones, 0);
  EXPECT_GT(twos, 0);
  ExpectWithinDelta(functions, cover, 0.01);
}

TEST(ManifoldCover, CountsAndLeavesOutWhatCannotBeEvaluated) {
  ManifoldFunctions functions = testing::Paraboloid();
  const auto paraboloid = functions.evaluate;
  functions.evaluate = [paraboloid](const VectorXd& q) -> absl::StatusOr<VectorXd> {
    if (q[0] > 0.3) return absl::InternalError("the shelf meets the top");
    return paraboloid(q);
  };
  const Cover cover = CoverOf(functions, Options(0.05));
  EXPECT_GT(cover.failures, 0);
  ASSERT_EQ(cover.failure_messages.size(), 1u);
  EXPECT_EQ(cover.failure_messages[0], "the shelf meets the top");
  for (const Primitive& primitive : cover.primitives) EXPECT_LE(primitive.parameters[0], 0.3);
  ExpectWithinDelta(functions, cover, 0.05);
}

TEST(ManifoldCover, RefusesAFamilyThatNeverEvaluates) {
  const FunctionManifold manifold(testing::Over(
      VectorXd::Zero(1), VectorXd::Ones(1), 2,
      [](const VectorXd&) -> absl::StatusOr<VectorXd> { return absl::InternalError("broken"); }));
  const auto cover = CoverManifold(manifold, Options(0.1));
  EXPECT_EQ(cover.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_NE(cover.status().message().find("broken"), std::string::npos);
}

TEST(ManifoldCover, OfASingleDesignIsOnePoint) {
  for (const Eigen::Index parameters : {0, 2}) {
    const VectorXd fixed = VectorXd::Ones(parameters);
    const Cover cover = CoverOf(testing::Over(fixed, fixed, 2,
                                              [](const VectorXd&) -> absl::StatusOr<VectorXd> {
                                                return VectorXd(Vector2d(1, 2));
                                              }),
                                Options(0.1));
    EXPECT_EQ(cover.cost, 1);
    EXPECT_EQ(cover.end, CoverEnd::kCovered);
  }
}

TEST(ManifoldCover, IsTheSameToTheBitWithAnyNumberOfThreads) {
  const testing::ToyFamily family(3);
  for (const auto& functions : {testing::Paraboloid(), family.Functions()}) {
    CoverOptions options = Options(0.02);
    const Cover first = CoverOf(functions, options);
    for (const int threads : {2, 4}) {
      options.threads = threads;
      const Cover other = CoverOf(functions, options);
      ASSERT_EQ(other.primitives.size(), first.primitives.size());
      EXPECT_EQ(other.evaluations, first.evaluations);
      for (std::size_t i = 0; i < first.primitives.size(); ++i) {
        EXPECT_EQ(other.primitives[i].parameters, first.primitives[i].parameters);
        EXPECT_EQ(other.primitives[i].center, first.primitives[i].center);
        EXPECT_EQ(other.primitives[i].axes, first.primitives[i].axes);
        EXPECT_EQ(other.primitives[i].radii, first.primitives[i].radii);
      }
    }
  }
}

TEST(ManifoldCover, OfAFamilyWithAD2DescriptorKeepsItsPromises) {
  const testing::ToyFamily family(3);
  const Cover cover = CoverOf(family.Functions(), Options(0.02));
  for (const Primitive& primitive : cover.primitives) EXPECT_LE(primitive.axes.cols(), 2);
  ExpectWithinDelta(family.Functions(), cover, 0.02);
}

TEST(ManifoldCover, EndsAtItsLimitsAndSaysSo) {
  CoverOptions options = Options(0.001, CoverKind::kPoints);
  options.most_primitives = 20;
  const Cover few = CoverOf(testing::Paraboloid(), options);
  EXPECT_EQ(few.end, CoverEnd::kPrimitiveLimit);
  EXPECT_EQ(few.primitives.size(), 20u);
  options = Options(0.001, CoverKind::kPoints);
  options.most_evaluations = 300;
  const Cover brief = CoverOf(testing::Paraboloid(), options);
  EXPECT_EQ(brief.end, CoverEnd::kEvaluationLimit);
  EXPECT_LT(brief.evaluations, 1000);
}

TEST(ManifoldCover, StopsWhenAskedTo) {
  std::stop_source source;
  const FunctionManifold manifold(testing::Paraboloid());
  CoverOptions options = Options(0.001);
  options.stop = source.get_token();
  int calls = 0;
  options.progress = [&](const CoverProgress& progress) {
    EXPECT_GT(progress.evaluations, 0);
    EXPECT_GT(progress.primitives, 0);
    if (++calls == 2) source.request_stop();
  };
  EXPECT_EQ(CoverManifold(manifold, options).status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(calls, 2);
}

TEST(ManifoldCover, RefusesOptionsOutOfRange) {
  const FunctionManifold manifold(testing::Paraboloid());
  for (const CoverOptions& options :
       {Options(0), Options(-1), Options(std::nan("")), CoverOptions{.delta = 1, .rejections = 0},
        CoverOptions{.delta = 1, .threads = 0}, CoverOptions{.delta = 1, .most_primitives = 0},
        CoverOptions{.delta = 1, .most_evaluations = 0}}) {
    EXPECT_EQ(CoverManifold(manifold, options).status().code(), absl::StatusCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace mortise::retrieval
