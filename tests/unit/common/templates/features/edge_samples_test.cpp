#include "common/templates/features/edge_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "common/base/errors.h"
#include "tests/unit/common/templates/features/feature_texts.h"

namespace mortise::cad {
namespace {

using Points = std::map<std::string, Eigen::Vector3d>;

mesh::ControlVariables VariablesOf(const std::string& features, double spacing) {
  const auto model = SolidOf("", features);
  EXPECT_TRUE(model.ok()) << model.status();
  if (!model.ok()) return {};
  auto variables = FindControlVariables(*model, spacing);
  EXPECT_TRUE(variables.ok()) << variables.status();
  return variables.ok() ? *variables : mesh::ControlVariables();
}

Points PointsOf(const mesh::ControlVariables& variables) {
  Points points;
  for (const auto& point : variables.points) {
    EXPECT_TRUE(points.emplace(point.name, point.position).second) << point.name;
  }
  return points;
}

// A block of this size with a bore through it.
std::string BoredBlock(double length, double bore) {
  return absl::StrCat(
      "features { name: 's' sketch { profiles { name: 'outline' rectangle { width: '", length,
      "' height: '0.06' } } profiles { name: 'bore' hole_of: 'outline' circle { radius: '", bore,
      "' } } } } features { name: 'block' extrude { sketch: 's' to: '0.02' } }");
}

TEST(EdgeSamplesTest, GiveABlockItsVerticesAndEdges) {
  const mesh::ControlVariables whole = VariablesOf(BlockText(), 1);
  EXPECT_EQ(whole.points.size(), 8U);
  EXPECT_EQ(whole.paths.size(), 12U);
  // Edges of 0.1, 0.06 and 0.02 m in pieces of at most 0.03: 4, 2 and 1 of each four.
  const mesh::ControlVariables pieces = VariablesOf(BlockText(), 0.03);
  EXPECT_EQ(pieces.points.size(), 8U + 4 * (3 + 1));
  EXPECT_EQ(pieces.paths.size(), 4U * (4 + 2 + 1));
  for (const auto& path : pieces.paths) {
    const Eigen::Vector3d from = pieces.points[static_cast<std::size_t>(path.from)].position;
    const Eigen::Vector3d to = pieces.points[static_cast<std::size_t>(path.to)].position;
    EXPECT_LT((path.way.col(0) - from).norm(), 1e-12);
    EXPECT_LT((path.way.rightCols(1) - to).norm(), 1e-12);
    EXPECT_LE((to - from).norm(), 0.03 + 1e-12);
  }
}

// Samples halve, so that those of a shorter edge are among those of a longer one, at the same
// share.
TEST(EdgeSamplesTest, KeepTheirNamesWhenParametersChange) {
  const Points before = PointsOf(VariablesOf(BoredBlock(0.1, 0.008), 0.03));
  const Points after = PointsOf(VariablesOf(BoredBlock(0.15, 0.02), 0.03));
  EXPECT_GE(before.size(), 8U + 2 * 4);
  for (const auto& [name, place] : before) {
    const auto match = after.find(name);
    ASSERT_NE(match, after.end()) << name;
    const bool is_of_bore = name.find("bore") != std::string::npos;
    const Eigen::Vector3d stretch =
        is_of_bore ? Eigen::Vector3d(2.5, 2.5, 1) : Eigen::Vector3d(1.5, 1, 1);
    EXPECT_LT((place.cwiseProduct(stretch) - match->second).norm(), 1e-9) << name;
  }
}

TEST(EdgeSamplesTest, LeaveSeamsOutAndCountCirclesFromTheirBeginning) {
  const mesh::ControlVariables variables = VariablesOf(
      "features { name: 's' sketch { profiles { name: 'disc' circle { radius: '0.01' } } } } "
      "features { name: 'rod' extrude { sketch: 's' to: '0.05' } }",
      1);
  EXPECT_EQ(variables.points.size(), 8U);  // four on each circle, none on the seam between
  EXPECT_EQ(variables.paths.size(), 8U);
  for (const auto& point : variables.points) {
    EXPECT_NEAR(point.position.head<2>().norm(), 0.01, 1e-12);
    EXPECT_TRUE(point.position.z() < 1e-12 || point.position.z() > 0.05 - 1e-12);
  }
}

// A slot that cuts an edge in two changes what the edge's name is made of: it is another edge then.
TEST(EdgeSamplesTest, GiveOtherNamesToWhatIsSplit) {
  const std::string slot =
      BlockText() +
      "features { name: 'slot_sketch' sketch { profiles { name: 'slot' rectangle { width: '0.02' "
      "height: '0.2' } } } } features { name: 'slot' extrude { sketch: 'slot_sketch' from: '0.01' "
      "to: '0.03' operation: CUT } }";
  const auto whole = VariablesOf(BlockText(), 1);
  const auto model = SolidOf("", slot);
  if (!model.ok()) GTEST_FAIL() << model.status();
  const auto cut = FindControlVariables(*model, 1);
  ASSERT_TRUE(cut.ok()) << cut.status();
  const Points before = PointsOf(whole), after = PointsOf(*cut);
  // The four vertices below are what they were; of the edges above, two were split.
  int kept = 0;
  for (const auto& [name, place] : before) {
    const auto match = after.find(name);
    if (match == after.end()) continue;
    EXPECT_LT((match->second - place).norm(), 1e-9) << name;
    ++kept;
  }
  EXPECT_GE(kept, 4);
  std::set<std::string> edges;
  for (const auto& path : cut->paths) edges.insert(path.edge);
  EXPECT_GT(edges.size(), 12U);
}

TEST(EdgeSamplesTest, RefuseSpacingsThatAreNone) {
  const auto model = SolidOf("", BlockText());
  ASSERT_TRUE(model.ok()) << model.status();
  for (const double spacing : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(DetailOf(FindControlVariables(*model, spacing).status()).field, "spacing");
  }
  EXPECT_EQ(FindControlVariables(*model, 1e-8).status().code(),
            absl::StatusCode::kResourceExhausted);
}

}  // namespace
}  // namespace mortise::cad
