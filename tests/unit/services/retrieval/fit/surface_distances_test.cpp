#include "services/retrieval/fit/surface_distances.h"

#include <gtest/gtest.h>

#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

TEST(SurfaceDistancesTest, MeasuresToFacesEdgesAndCorners) {
  const SurfaceDistances box(Box({0, 0, 0}, {1, 1, 1}));
  Eigen::Matrix3Xd points(3, 4);
  points.col(0) << 0.5, 0.5, 0.5;
  points.col(1) << 0.5, 0.5, 3;
  points.col(2) << 4, 0.5, -4;
  points.col(3) << 2, 2, 2;
  const Eigen::VectorXd distances = box.From(points);
  EXPECT_NEAR(distances[0], 0.5, 1e-12);
  EXPECT_NEAR(distances[1], 2, 1e-12);
  EXPECT_NEAR(distances[2], 5, 1e-12);
  EXPECT_NEAR(distances[3], std::sqrt(3), 1e-12);
}

TEST(SurfaceDistancesTest, SummarizesDistances) {
  const DistanceSummary summary = Summarize(Eigen::VectorXd::LinSpaced(100, 1, 100));
  EXPECT_NEAR(summary.root_mean_square, std::sqrt(101.0 * 201 / 6), 1e-9);
  EXPECT_EQ(summary.percentile_95, 95);
  EXPECT_EQ(Summarize({}).percentile_95, 0);
}

}  // namespace
}  // namespace mortise::retrieval
