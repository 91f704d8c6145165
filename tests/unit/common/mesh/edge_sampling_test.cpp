#include "common/mesh/edge_sampling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace mortise::mesh {
namespace {

using ::testing::ElementsAre;

// A line from the origin along x, with points at these places on it.
NamedEdge LineAlongX(const std::vector<double>& places) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, std::ssize(places));
  for (std::size_t i = 0; i < places.size(); ++i) {
    points(0, static_cast<Eigen::Index>(i)) = places[i];
  }
  NamedEdge edge;
  edge.name = "line";
  edge.way = WayAlong(points, edge.length);
  return edge;
}

std::set<std::string> NamesOf(const ControlVariables& variables) {
  std::set<std::string> names;
  for (const auto& point : variables.points) names.insert(point.name);
  return names;
}

TEST(EdgeSamplingTest, SamplesOfAShortEdgeAreAmongThoseOfALongOne) {
  ControlVariables of_short, of_long;
  ASSERT_EQ(SampleEdge(LineAlongX({0, 0.2}), 0.1, of_short), absl::OkStatus());
  ASSERT_EQ(SampleEdge(LineAlongX({0, 0.13, 0.35}), 0.1, of_long), absl::OkStatus());
  EXPECT_THAT(NamesOf(of_short), ElementsAre("line at 1/2"));
  EXPECT_THAT(NamesOf(of_long), ElementsAre("line at 1/2", "line at 1/4", "line at 3/4"));
  for (const auto& point : of_long.points) {
    if (point.name == "line at 3/4") {
      EXPECT_NEAR(point.position.x(), 0.75 * 0.35, 1e-15);
    }
  }
}

TEST(EdgeSamplingTest, PathsJoinPointsThatAreThere) {
  ControlVariables variables;
  variables.points.push_back({"end", {0.2, 0, 0}, 4});
  NamedEdge edge = LineAlongX({0, 0.05, 0.1, 0.2});
  edge.to = 0;
  ASSERT_EQ(SampleEdge(edge, 0.1, variables), absl::OkStatus());
  ASSERT_EQ(variables.paths.size(), 1u);  // nobody knows where it begins
  const ControlVariables::Path& path = variables.paths[0];
  EXPECT_EQ(path.edge, "line");
  EXPECT_EQ(path.to, 0);
  EXPECT_EQ(variables.points[static_cast<std::size_t>(path.from)].name, "line at 1/2");
  ASSERT_EQ(path.way.cols(), 2) << "what lies on a straight line is left out";
  EXPECT_NEAR(path.way(0, 0), 0.1, 1e-15);
  EXPECT_NEAR(path.way(0, 1), 0.2, 1e-15);
}

TEST(EdgeSamplingTest, ClosedEdgesHaveFourPiecesThatFollowTheirBends) {
  const int corners = 40;
  Eigen::Matrix3Xd circle(3, corners + 1);
  for (int i = 0; i <= corners; ++i) {
    const double angle = 2 * M_PI * (i % corners) / corners;
    circle.col(i) << std::cos(angle), std::sin(angle), 0;
  }
  NamedEdge edge;
  edge.name = "bore";
  edge.is_closed = true;
  edge.way = WayAlong(circle, edge.length);
  ControlVariables variables;
  ASSERT_EQ(SampleEdge(edge, 100, variables), absl::OkStatus());
  ASSERT_EQ(variables.points.size(), 4u);
  ASSERT_EQ(variables.paths.size(), 4u);
  EXPECT_LT((variables.points[1].position - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  for (const auto& path : variables.paths) {
    EXPECT_EQ(path.way.cols(), 11);
    EXPECT_LT((path.way.colwise().norm().array() - 1).abs().maxCoeff(), 1e-12);
  }
}

TEST(EdgeSamplingTest, EdgesWithoutLengthHaveNoPointsAndTooManyAreRefused) {
  ControlVariables variables;
  EXPECT_EQ(SampleEdge(LineAlongX({0, 0}), 0.1, variables), absl::OkStatus());
  EXPECT_TRUE(absl::IsResourceExhausted(SampleEdge(LineAlongX({0, 1}), 1e-9, variables)));
  EXPECT_TRUE(variables.points.empty());
  EXPECT_TRUE(variables.paths.empty());
}

}  // namespace
}  // namespace mortise::mesh
