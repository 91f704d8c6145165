#include "common/fields/control_variables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "tests/unit/common/fields/two_tetrahedra.h"

namespace mortise::fields {
namespace {

mesh::ControlVariables VariablesOf(const DesignFields& design) {
  EXPECT_EQ(Check(design), absl::OkStatus());
  auto variables = ControlVariablesOf(design);
  EXPECT_TRUE(variables.ok()) << variables.status();
  return variables.ok() ? *variables : mesh::ControlVariables();
}

const mesh::ControlVariables::Point& PointOf(const mesh::ControlVariables& variables,
                                             const std::string& name) {
  const auto found =
      std::ranges::find(variables.points, name, &mesh::ControlVariables::Point::name);
  if (found != variables.points.end()) return *found;
  ADD_FAILURE() << "there is no point " << name;
  return variables.points.front();
}

void ExpectNamesOfTheirOwn(const mesh::ControlVariables& variables) {
  std::set<std::string> names;
  for (const auto& point : variables.points) {
    EXPECT_TRUE(names.insert(point.name).second) << point.name;
  }
}

TEST(ControlVariablesTest, PointsAndWaysAreThoseOfTheFile) {
  DesignFields design = TwoTetrahedra();
  design.paths.clear();
  design.control_points[0].position.x() = 1e-7;  // as rounded in the file; the node is what counts
  const mesh::ControlVariables variables = VariablesOf(design);
  ASSERT_EQ(variables.points.size(), 2u);
  EXPECT_EQ(variables.points[0].position, design.nodes.col(0));
  EXPECT_EQ(variables.points[0].vertex, 0);
  EXPECT_EQ(variables.points[1].position, design.control_points[1].position);
  EXPECT_EQ(variables.points[1].vertex, -1);
  ASSERT_EQ(variables.paths.size(), 2u);
  EXPECT_EQ(variables.paths[1].edge, "E2");
  EXPECT_EQ(variables.paths[1].from, 1);
  EXPECT_EQ(variables.paths[1].to, 0);
  EXPECT_EQ(variables.paths[0].way, design.ways[0].positions);
}

TEST(ControlVariablesTest, PathsByNodesAreCutAtPointsAndSampled) {
  DesignFields design = TwoTetrahedra();
  design.ways.clear();
  design.control_points = {{"V1", {}, 0}, {"V3", {}, 3}};
  design.paths = {{"closed", {0, 1, 3, 2, 0}}, {"open", {1, 4}}};
  const mesh::ControlVariables variables = VariablesOf(design);
  ExpectNamesOfTheirOwn(variables);
  const double size = design.nodes(0, 1);
  EXPECT_EQ(PointOf(variables, "open from").vertex, 1);
  EXPECT_EQ(PointOf(variables, "open to").vertex, 4);
  const auto half = PointOf(variables, "open from open from to open to at 1/2").position;
  EXPECT_LT((half - (design.nodes.col(1) + design.nodes.col(4)) / 2).norm(), 1e-12 * size);
  EXPECT_EQ(PointOf(variables, "closed from V3 to V1 at 1/2").vertex, -1);
  for (const auto& path : variables.paths) {
    EXPECT_TRUE(path.edge == "open" || path.edge == "closed") << path.edge;
    EXPECT_LT(
        (path.way.col(0) - variables.points[static_cast<std::size_t>(path.from)].position).norm(),
        1e-12 * size);
    EXPECT_LT(
        (path.way.rightCols<1>() - variables.points[static_cast<std::size_t>(path.to)].position)
            .norm(),
        1e-12 * size);
  }
}

TEST(ControlVariablesTest, MoreThanADesignMayHaveAreNone) {
  mesh::ControlVariables variables;
  variables.points.resize(2);
  variables.points[0].name = "V1";
  variables.points[1].name = "V2";
  variables.paths.resize(kMaximumControls, {"E", 0, 1, Eigen::Matrix3Xd::Zero(3, 2)});
  DesignFields design = TwoTetrahedra();
  SetControlVariables(variables, design);
  EXPECT_EQ(std::ssize(design.ways), kMaximumControls);
  variables.paths.push_back(variables.paths.front());
  SetControlVariables(variables, design);
  EXPECT_TRUE(design.ways.empty());
  EXPECT_TRUE(design.control_points.empty());
}

// A file may have anything: the same way twice, or names as samples get.
TEST(ControlVariablesTest, NoTwoPointsHaveOneName) {
  DesignFields design = TwoTetrahedra();
  design.paths.push_back({"E3", {0, 1, 0, 1, 0, 1}});
  design.paths.push_back({"E4", {1, 4}});
  design.control_points.push_back({"E4 from V5 to V6 at 1/2", {}, -1});
  design.control_points.push_back({"V5", {}, 1});
  design.control_points.push_back({"V6", {}, 4});
  design.control_points.push_back({"also V6", {}, 4});
  design.control_points.push_back({"E1 from", {}, -1});
  ExpectNamesOfTheirOwn(VariablesOf(design));
}

TEST(ControlVariablesTest, RegionsGiveThemWhereTheFileHasNone) {
  DesignFields design = TwoTetrahedra();
  design.control_points.clear();
  design.paths.clear();
  design.ways.clear();
  design.regions = {{"left", {0}}, {"low", {1}}, {"back", {2}}};
  const mesh::ControlVariables variables = VariablesOf(design);
  ExpectNamesOfTheirOwn(variables);
  const auto& origin = PointOf(variables, "back = leg | left = leg | leg = low");
  EXPECT_EQ(origin.vertex, 0);
  EXPECT_GE(variables.paths.size(), 6u);
}

}  // namespace
}  // namespace mortise::fields
