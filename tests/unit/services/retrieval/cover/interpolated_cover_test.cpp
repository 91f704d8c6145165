// Covers of interpolated manifolds, judged by the manifolds themselves.
#include "services/retrieval/cover/interpolated_cover.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/errors.h"
#include "services/retrieval/cover/cover_error.h"
#include "tests/unit/services/retrieval/cover/known_manifolds.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

TEST(InterpolatedCover, IsWithinDeltaOfTheManifoldItself) {
  const testing::ToyFamily family(3);
  for (const ManifoldFunctions& functions :
       {testing::Paraboloid(), testing::SpherePatch(), family.Functions()}) {
    const FunctionManifold manifold(functions);
    const CoverOptions options{.delta = 0.05, .seed = 3};
    const auto cover = CoverByInterpolation(manifold, options);
    ASSERT_TRUE(cover.ok()) << cover.status();
    EXPECT_EQ(cover->end, CoverEnd::kCovered);
    const ErrorSampling sampling{.count = 500, .seed = 9};
    EXPECT_LE(Quantile(CoverageErrors(manifold, cover->primitives, sampling).value(), 0.99), 0.05);
    EXPECT_LE(Quantile(FittingErrors(manifold, cover->primitives, sampling).value(), 0.99), 0.05);
  }
}

TEST(InterpolatedCover, EvaluatesLittleOfTheManifold) {
  const FunctionManifold manifold(testing::Paraboloid());
  const CoverOptions options{.delta = 0.05, .seed = 3};
  const Cover interpolated = CoverByInterpolation(manifold, options).value();
  const Cover direct = CoverManifold(manifold, options).value();
  EXPECT_LT(interpolated.evaluations, direct.evaluations / 10);
  EXPECT_LT(interpolated.cost, 2 * direct.cost);
}

// A helix of three turns. Rays from the middle of one parameter end in no more than two points.
TEST(InterpolatedCover, EvaluatesLittleOfOneParameter) {
  const FunctionManifold helix(testing::Over(
      VectorXd::Zero(1), VectorXd::Ones(1), 3, [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
        return Eigen::Vector3d(std::cos(20 * q[0]), std::sin(20 * q[0]), q[0]);
      }));
  const Cover cover = CoverByInterpolation(helix, {.delta = 0.02, .seed = 3}).value();
  EXPECT_EQ(cover.end, CoverEnd::kCovered);
  EXPECT_LT(cover.evaluations, 250);
  const ErrorSampling sampling{.count = 500, .seed = 9};
  EXPECT_LE(Quantile(CoverageErrors(helix, cover.primitives, sampling).value(), 0.99), 0.02);
}

TEST(InterpolatedCover, KeepsCentresAndAxesInTheSpaceOfTheDescriptor) {
  const FunctionManifold manifold(testing::Sheet());
  const auto cover = CoverByInterpolation(manifold, {.delta = 0.05, .seed = 1});
  ASSERT_TRUE(cover.ok()) << cover.status();
  for (const Primitive& primitive : cover->primitives) {
    ASSERT_EQ(primitive.center.size(), manifold.dimension());
    EXPECT_LT((primitive.center - manifold.Evaluate(primitive.parameters).value()).norm(), 0.0125);
    const Eigen::Index axes = primitive.axes.cols();
    EXPECT_TRUE((primitive.axes.transpose() * primitive.axes)
                    .isApprox(Eigen::MatrixXd::Identity(axes, axes), 1e-9));
  }
}

TEST(InterpolatedCover, IsTheSameOnAnyNumberOfThreads) {
  const FunctionManifold manifold(testing::SpherePatch());
  CoverOptions options{.delta = 0.1, .seed = 4};
  const Cover one = CoverByInterpolation(manifold, options).value();
  options.threads = 3;
  const Cover three = CoverByInterpolation(manifold, options).value();
  ASSERT_EQ(one.primitives.size(), three.primitives.size());
  EXPECT_EQ(one.evaluations, three.evaluations);
  for (std::size_t i = 0; i < one.primitives.size(); ++i) {
    EXPECT_EQ(one.primitives[i].center, three.primitives[i].center);
    EXPECT_EQ(one.primitives[i].radii, three.primitives[i].radii);
  }
}

// Two sheets that lie apart.
TEST(InterpolatedCover, CoversStructuresApart) {
  ManifoldFunctions functions = testing::Sheet();
  functions.evaluate = [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
    return VectorXd(Eigen::Vector3d(q[0], q[1], q[0] > 0.5 ? 5 : 0));
  };
  functions.dimension = 3;
  functions.structure = [](const VectorXd& q) { return q[0] > 0.5 ? 7 : 2; };
  const FunctionManifold manifold(functions);
  const Cover cover = CoverByInterpolation(manifold, {.delta = 0.05, .seed = 1}).value();
  EXPECT_LT(cover.evaluations, 500);
  const auto errors = CoverageErrors(manifold, cover.primitives, {.count = 300, .seed = 2});
  EXPECT_LE(Quantile(errors.value(), 0.99), 0.05);
}

// A manifold with a cliff that no structure tells of, and one that fails in its half.
TEST(InterpolatedCover, IsTheDirectOneWhereInterpolationWillNotDo) {
  ManifoldFunctions functions = testing::Sheet();
  functions.dimension = 1;
  functions.evaluate = [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
    return VectorXd::Constant(1, std::sin(300 * q[0]) > 0 ? 1.0 : 0.0);
  };
  const CoverOptions options{.delta = 0.05, .seed = 1, .rejections = 300};
  const FunctionManifold cliffs(functions);
  const Cover rough = CoverByInterpolation(cliffs, options).value();
  EXPECT_EQ(rough.cost, CoverManifold(cliffs, options)->cost);
  functions.evaluate = [](const VectorXd& q) -> absl::StatusOr<VectorXd> {
    if (q[0] > 0.5) return PreconditionFailed("NO_DESIGN", "it is too wide");
    return VectorXd::Constant(1, q[0]);
  };
  const FunctionManifold failing(functions);
  const Cover half = CoverByInterpolation(failing, options).value();
  EXPECT_GT(half.failures, 0);
  for (const Primitive& primitive : half.primitives) EXPECT_LE(primitive.parameters[0], 0.5);
}

// Noise, as of designs that are meshed anew each time: no number of points takes it away, and the
// cover leaves room for it.
TEST(InterpolatedCover, MakesNoMoreDesignsWhereTheyBringLittle) {
  constexpr double kDelta = 0.1;
  ManifoldFunctions functions = testing::Paraboloid();
  functions.evaluate = [whole = functions.evaluate](const VectorXd& q) -> absl::StatusOr<VectorXd> {
    const double phase = 1e5 * q[0] + 3e4 * q[1];
    const Eigen::Vector3d noise(std::sin(phase), std::sin(2 * phase), std::sin(3 * phase));
    return VectorXd(*whole(q) + 0.15 * kDelta * noise);
  };
  const FunctionManifold manifold(functions);
  const Cover cover = CoverByInterpolation(manifold, {.delta = kDelta, .seed = 3}).value();
  EXPECT_LE(cover.evaluations, 400);
  EXPECT_GT(cover.interpolation_error, 0.2 * kDelta);
  EXPECT_LE(cover.interpolation_error, 0.5 * kDelta);
  EXPECT_EQ(cover.end, CoverEnd::kCovered);
  const ErrorSampling sampling{.count = 500, .seed = 9};
  EXPECT_LE(Quantile(CoverageErrors(manifold, cover.primitives, sampling).value(), 0.99), kDelta);
}

// Few designs of a corner cannot be made: what interpolates does not know it.
TEST(InterpolatedCover, HasNoDesignThatCannotBeMade) {
  ManifoldFunctions functions = testing::Paraboloid();
  const Eigen::VectorXd corner = functions.lower + 0.88 * (functions.upper - functions.lower);
  functions.evaluate = [whole = functions.evaluate,
                        corner](const Eigen::VectorXd& q) -> absl::StatusOr<Eigen::VectorXd> {
    if ((q.array() > corner.array()).all()) return absl::FailedPreconditionError("too large");
    return whole(q);
  };
  const FunctionManifold manifold(functions);
  const auto cover = CoverByInterpolation(manifold, {.delta = 0.02, .seed = 3});
  ASSERT_TRUE(cover.ok()) << cover.status();
  ASSERT_GT(cover->primitives.size(), 20u);
  EXPECT_GT(cover->failures, 0);
  for (const Primitive& each : cover->primitives) {
    EXPECT_TRUE(functions.evaluate(each.parameters).ok()) << each.parameters.transpose();
  }
}

TEST(InterpolatedCover, KeepsToItsEvaluations) {
  const testing::ToyFamily family(3);
  long made = 0;
  ManifoldFunctions functions = family.Functions();
  functions.evaluate = [whole = functions.evaluate, &made](const Eigen::VectorXd& q) {
    ++made;
    return whole(q);
  };
  const FunctionManifold manifold(functions);
  // So small a δ that what interpolates is never good enough.
  const CoverOptions options{.delta = 1e-5, .seed = 3, .most_evaluations = 400};
  const auto cover = CoverByInterpolation(manifold, options);
  ASSERT_TRUE(cover.ok()) << cover.status();
  EXPECT_EQ(cover->end, CoverEnd::kEvaluationLimit);
  EXPECT_EQ(cover->evaluations, made);
  EXPECT_LT(made, 800);  // with the last batch of samples
}

}  // namespace
}  // namespace mortise::retrieval
