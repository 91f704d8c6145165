#include "services/retrieval/fit/fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "common/base/errors.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"
#include "tests/unit/services/retrieval/fit/scans.h"

namespace mortise::retrieval {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

// Boxes of any three sizes, with a corner at the origin.
FitFamily Boxes() {
  FitFamily family;
  family.surfaces.lower = Vector3d(0.5, 0.2, 0.1);
  family.surfaces.upper = Vector3d(1.5, 0.8, 0.6);
  family.surfaces.surface = [](const VectorXd& q) { return Box(Vector3d::Zero(), q.head<3>()); };
  return family;
}

FitFamily Chairs() {
  FitFamily family;
  family.surfaces.lower = Eigen::Vector4d(0.35, 0.35, 0.35, 0.3);
  family.surfaces.upper = Eigen::Vector4d(0.6, 0.6, 0.55, 0.6);
  family.surfaces.surface = [](const VectorXd& q) {
    return Chair(Eigen::Vector4d(q[0], q[1], q[2], q[3]));
  };
  return family;
}

VectorXd MiddleOf(const FitFamily& family) {
  return 0.5 * (family.surfaces.lower + family.surfaces.upper);
}

absl::StatusOr<FittedDesign> Fit(const mesh::SurfaceMesh& surface, const FitFamily& family,
                                 const FitOptions& options = {}) {
  MORTISE_ASSIGN_OR_RETURN(const FitQuery query, FitQuery::Create(surface));
  return FitDesign(query, family, {{MiddleOf(family)}}, options);
}

double ErrorOf(const FittedDesign& fitted, const FitFamily& family, const VectorXd& truth) {
  return (fitted.q - truth)
      .cwiseQuotient(family.surfaces.upper - family.surfaces.lower)
      .cwiseAbs()
      .maxCoeff();
}

const Eigen::Vector4d kChair(0.42, 0.53, 0.4, 0.5);

TEST(FitTest, FindsTheSizesOfABox) {
  const FitFamily family = Boxes();
  for (const Vector3d& sizes : {Vector3d(0.7, 0.3, 0.15), Vector3d(1.4, 0.75, 0.5)}) {
    const auto fitted = Fit(*family.surfaces.surface(sizes), family);
    ASSERT_TRUE(fitted.ok()) << fitted.status();
    EXPECT_LT((fitted->q - sizes).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT(fitted->remaining.root_mean_square, 1e-6);
    EXPECT_LT(fitted->beyond.percentile_95, 1e-6);
    EXPECT_TRUE(fitted->converged);
    EXPECT_EQ(fitted->pose.scale, 1);
  }
}

TEST(FitTest, FindsTheThicknessOfBoardsOfAnExactMesh) {
  FitFamily family;
  family.surfaces.lower = Eigen::Vector2d(0.6, 0.012);
  family.surfaces.upper = Eigen::Vector2d(1.6, 0.04);
  family.surfaces.surface = [](const VectorXd& q) { return testing::Shelf(q[0], q[1]); };
  for (const Eigen::Vector2d& truth : {Eigen::Vector2d(1.3, 0.018), Eigen::Vector2d(0.7, 0.03)}) {
    const auto fitted =
        Fit(testing::Placed(testing::Shelf(truth[0], truth[1]), 1.57, {1, 2, 3}), family);
    ASSERT_TRUE(fitted.ok()) << fitted.status();
    EXPECT_LT(ErrorOf(*fitted, family, truth), 1e-3);
    EXPECT_LT(fitted->beyond.percentile_95, 1e-4);
  }
}

TEST(FitTest, SeesThroughTurnsAndTranslations) {
  const FitFamily family = Chairs();
  for (const double turn : {0.0, 0.5, 1.0, 1.5, 1.93}) {
    const Vector3d offset(100 * turn, -3, 7);
    const auto fitted =
        Fit(testing::Placed(Chair(kChair), turn * std::numbers::pi, offset), family);
    ASSERT_TRUE(fitted.ok()) << fitted.status();
    EXPECT_LT(ErrorOf(*fitted, family, kChair), 1e-3) << turn;
    EXPECT_NEAR(std::remainder(fitted->pose.turn + turn * std::numbers::pi, 2 * std::numbers::pi),
                0, 1e-3);
    EXPECT_LT((fitted->pose.ToDesign(offset) - Vector3d::Zero()).norm(), 1e-3);
  }
}

TEST(FitTest, IsNotLedAstrayByNoiseAndHoles) {
  const FitFamily family = Chairs();
  Random random(4);
  mesh::SurfaceMesh scan = testing::Refined(Chair(kChair), 0.03);
  testing::AddNoise(scan, 0.003 * testing::DiagonalOf(scan), random);
  testing::CutHoles(scan, 0.2, 5, random);
  const auto fitted = Fit(testing::Placed(scan, std::numbers::pi / 2, {1, 2, 3}), family);
  ASSERT_TRUE(fitted.ok()) << fitted.status();
  EXPECT_LT(ErrorOf(*fitted, family, kChair), 0.01);
  EXPECT_LT(fitted->remaining.root_mean_square, 0.005 * testing::DiagonalOf(scan));
}

// With noise a fit is done when more steps change nothing that the noise lets anybody know.
TEST(FitTest, HasConvergedWhenMoreStepsChangeNothing) {
  const FitFamily family = Chairs();
  for (const double noise : {0.0, 0.003, 0.01}) {
    Random random(4);
    mesh::SurfaceMesh scan = testing::Refined(Chair(kChair), 0.03);
    testing::AddNoise(scan, noise * testing::DiagonalOf(scan), random);
    std::vector<FittedDesign> after;  // so many rounds and one
    for (int rounds = 1; rounds <= 9; ++rounds) {
      const auto fitted = Fit(scan, family, {.fine_rounds = rounds});
      ASSERT_TRUE(fitted.ok()) << fitted.status();
      after.push_back(*fitted);
    }
    for (const FittedDesign& fitted : after) {
      if (!fitted.converged) continue;
      EXPECT_LT(ErrorOf(fitted, family, after.back().q), 1e-5) << noise;
    }
    EXPECT_TRUE(after.back().converged) << noise;
    // The first round still moves what the coarse alignment has found by more than noise would.
    EXPECT_EQ(after.front().converged, noise == 0) << noise;
  }
}

TEST(FitTest, TellsTheScaleWhereItIsFree) {
  const FitFamily family = Chairs();  // whose boards are of one thickness
  mesh::SurfaceMesh millimetres = Chair(kChair);
  millimetres.vertices *= 1000;
  const auto fitted = Fit(millimetres, family, {.scale_is_free = true});
  ASSERT_TRUE(fitted.ok()) << fitted.status();
  EXPECT_NEAR(fitted->pose.scale, 1e-3, 1e-5);
  EXPECT_LT(ErrorOf(*fitted, family, kChair), 0.02);
  EXPECT_LT(fitted->remaining.root_mean_square, 1e-3);
}

TEST(FitTest, TakesTheBestOfItsStarts) {
  const FitFamily family = Chairs();
  const auto query = FitQuery::Create(Chair(kChair));
  ASSERT_TRUE(query.ok());
  const auto fitted = FitDesign(
      *query, family,
      {{family.surfaces.upper}, {Eigen::Vector4d(9, 9, 9, 9)}, {family.surfaces.lower}}, {});
  ASSERT_TRUE(fitted.ok()) << fitted.status();
  EXPECT_LT(ErrorOf(*fitted, family, kChair), 1e-4);
}

// Of the boxes only those can be made whose first two sizes are not too large together.
TEST(FitTest, KeepsToWhatIsFeasible) {
  FitFamily family = Boxes();
  const auto make = family.surfaces.surface;
  family.surfaces.surface = [make](const VectorXd& q) -> absl::StatusOr<mesh::SurfaceMesh> {
    if (q[0] + q[1] > 1.5 + 1e-9) return InvalidField("q", "is too large");
    return make(q);
  };
  const mesh::SurfaceMesh large = *make(Vector3d(1.2, 0.5, 0.3));
  const auto shortened = Fit(large, family);
  ASSERT_TRUE(shortened.ok()) << shortened.status();
  EXPECT_LE(shortened->q[0] + shortened->q[1], 1.5 + 1e-9);
  EXPECT_NEAR(shortened->q[2], 0.3, 0.02);

  family.cuts = {Eigen::RowVector3d(1, 1, 0), VectorXd::Constant(1, 1.5)};
  const auto nearest = Fit(large, family);
  ASSERT_TRUE(nearest.ok()) << nearest.status();
  EXPECT_LE(nearest->q[0] + nearest->q[1], 1.5 + 1e-9);
  EXPECT_GT(nearest->q[0] + nearest->q[1], 1.5 - 1e-3);
  EXPECT_NEAR(nearest->q[2], 0.3, 1e-3);
  EXPECT_GT(nearest->beyond.root_mean_square + nearest->remaining.root_mean_square, 0.01);
}

// Time is counted in designs here.
TEST(FitTest, EndsWithWhatItHasWhenTheTimeIsOut) {
  FitFamily family = Chairs();
  int made = 0, allowed = 0;
  family.surfaces.surface = [&made, make = family.surfaces.surface](const VectorXd& q) {
    ++made;
    return make(q);
  };
  const FitOptions options{.is_out_of_time = [&] { return made >= allowed; }};
  std::vector<bool> ended;  // with a design
  for (allowed = 0; allowed < 40; ++allowed) {
    made = 0;
    const auto fitted = Fit(Chair(kChair), family, options);
    EXPECT_LE(made, allowed);
    ended.push_back(fitted.ok());
    if (!fitted.ok()) {
      EXPECT_TRUE(absl::IsDeadlineExceeded(fitted.status())) << fitted.status();
      continue;
    }
    EXPECT_LT(ErrorOf(*fitted, family, kChair), 0.02) << allowed;
  }
  EXPECT_FALSE(ended.front());
  EXPECT_TRUE(ended.back());
  EXPECT_TRUE(std::is_sorted(ended.begin(), ended.end()));
}

TEST(FitTest, TellsWhyThereIsNone) {
  FitFamily family = Boxes();
  const auto query = FitQuery::Create(Box({0, 0, 0}, {1, 0.5, 0.2}));
  ASSERT_TRUE(query.ok());
  EXPECT_EQ(DetailOf(FitDesign(*query, family, {}, {}).status()).field, "starts");
  EXPECT_EQ(DetailOf(FitDesign(*query, family, {{VectorXd::Ones(2)}}, {}).status()).field,
            "starts[0]");
  const FitOptions given_up{.is_given_up = [] { return true; }};
  EXPECT_TRUE(
      absl::IsCancelled(FitDesign(*query, family, {{MiddleOf(family)}}, given_up).status()));
  family.surfaces.surface = [](const VectorXd&) -> absl::StatusOr<mesh::SurfaceMesh> {
    return InvalidField("parts[2]", "has no extent");
  };
  EXPECT_EQ(DetailOf(FitDesign(*query, family, {{MiddleOf(family)}}, {}).status()).field,
            "parts[2]");
}

TEST(FitTest, TakesSurfacesThatAreHardlyAny) {
  const FitFamily family = Boxes();
  mesh::SurfaceMesh triangle{Eigen::Matrix3Xd(3, 3), Eigen::Matrix3Xi(3, 1)};
  triangle.vertices << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  triangle.triangles << 0, 1, 2;
  mesh::SurfaceMesh flat = Box({0, 0, 0}, {1, 0.5, 0});
  for (const mesh::SurfaceMesh& surface : {triangle, flat}) {
    for (const bool free : {false, true}) {
      const auto fitted = Fit(surface, family, {.scale_is_free = free});
      ASSERT_TRUE(fitted.ok()) << fitted.status();
      EXPECT_TRUE(fitted->q.allFinite());
      EXPECT_TRUE(std::isfinite(fitted->remaining.root_mean_square));
      EXPECT_TRUE((fitted->q.array() >= family.surfaces.lower.array()).all());
      EXPECT_TRUE((fitted->q.array() <= family.surfaces.upper.array()).all());
    }
  }
}

TEST(FitTest, RefusesWhatIsNoSurface) {
  mesh::SurfaceMesh surface = Box({0, 0, 0}, {1, 1, 1});
  surface.vertices.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(DetailOf(FitQuery::Create(surface).status()).field, "query");
  surface.vertices.setZero();
  EXPECT_EQ(DetailOf(FitQuery::Create(surface).status()).field, "query");
  surface = Box({0, 0, 0}, {1, 1, 1});
  surface.triangles(0, 0) = 8;
  EXPECT_EQ(DetailOf(FitQuery::Create(surface).status()).field, "query");
  surface.triangles.resize(3, 0);
  EXPECT_EQ(DetailOf(FitQuery::Create(surface).status()).field, "query");
}

TEST(FitTest, PassesOverTrianglesThatAreNotFinite) {
  const FitFamily family = Boxes();
  mesh::SurfaceMesh box = Box({0, 0, 0}, {1, 0.5, 0.2});
  box.vertices.conservativeResize(3, 9);
  box.vertices.col(8).setConstant(std::numeric_limits<double>::infinity());
  box.triangles.conservativeResize(3, 13);
  box.triangles.col(12) << 0, 1, 8;
  const auto fitted = Fit(box, family);
  ASSERT_TRUE(fitted.ok()) << fitted.status();
  EXPECT_LT((fitted->q - Vector3d(1, 0.5, 0.2)).norm(), 1e-5);
}

TEST(FitTest, IsTheSameOnAnyNumberOfThreads) {
  const FitFamily family = Chairs();
  const auto one = Fit(Chair(kChair), family, {.threads = 1});
  const auto four = Fit(Chair(kChair), family, {.threads = 4});
  ASSERT_TRUE(one.ok() && four.ok());
  EXPECT_EQ(one->q, four->q);
  EXPECT_EQ(one->pose.turn, four->pose.turn);
  EXPECT_EQ(one->remaining.root_mean_square, four->remaining.root_mean_square);
}

// As solids are: with other triangles each time.
TEST(FitTest, FollowsFacesWhoseTrianglesChange) {
  FitFamily family = Boxes();
  family.surfaces.surface = [make = family.surfaces.surface](const VectorXd& q) {
    const int splits = static_cast<int>(std::floor(q.sum() * 1e4)) % 2;
    mesh::SurfaceMesh surface = *make(q);
    return absl::StatusOr<mesh::SurfaceMesh>(splits == 0 ? surface : Split(surface));
  };
  const Vector3d sizes(0.9, 0.7, 0.2);
  const auto fitted = Fit(Box({0, 0, 0}, sizes), family);
  ASSERT_TRUE(fitted.ok()) << fitted.status();
  EXPECT_LT((fitted->q - sizes).cwiseAbs().maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace mortise::retrieval
