// Connections: what is found in a design.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "tests/unit/common/assembly/connections/connection_assemblies.h"

namespace mortise::parametric {
namespace {

std::string Names(const ParametricAssembly& design, const std::vector<int>& elements) {
  std::string names;
  for (const int element : elements) {
    names += design.elements()[static_cast<std::size_t>(element)].name + ";";
  }
  return names;
}

TEST(Connections, HoldThePrincipalsThePatchAndWhatIsBetween) {
  const ParametricAssembly boards = ParametrizedDesign(DowelledBoards());
  const ElementConnection& connection = Only(boards);
  EXPECT_EQ(Names(boards, connection.principals), "bottom;wall;");
  EXPECT_EQ(Names(boards, connection.connecting), "dowel 1;");
  EXPECT_EQ(connection.name, "'bottom' with 'wall'");
  ASSERT_EQ(connection.patches.size(), 1U);
  const ConnectionPatch& patch = connection.patches.front();
  EXPECT_EQ(patch.kind, PatchKind::kContact);
  EXPECT_EQ(patch.normal, Axis::kZ);
  ASSERT_EQ(patch.pieces.size(), 1U);
  ExpectBox(patch.pieces.front(), {0, 0.04, 0.02}, {0.6, 0.06, 0.02});
  EXPECT_NEAR(patch.area, 0.6 * 0.02, 1e-12);
}

TEST(Connections, AreOneForTheSamePrincipalsAndTakeInWhatTouches) {
  const ParametricAssembly corner = ParametrizedDesign(BoltedCorner());
  const ElementConnection& connection = Only(corner);
  EXPECT_EQ(Names(corner, connection.principals), "sill;post;");
  EXPECT_EQ(Names(corner, connection.connecting), "screw front;screw back;bracket;bolt;washer;");
  EXPECT_EQ(corner.assembly().groups[static_cast<std::size_t>(connection.group)].name, "frame");
}

TEST(Connections, OfAllBoardsThatTouchInARow) {
  const ParametricAssembly chest = ParametrizedDesign(ChestWithLid());
  std::set<std::string> names;
  for (const ElementConnection& connection : chest.connections()) {
    EXPECT_TRUE(connection.connecting.empty());
    EXPECT_EQ(connection.hard.empty(), connection.joints.empty()) << "or where the hinge is";
    EXPECT_FALSE(connection.patches.front().pieces.empty());
    names.insert(connection.name);
  }
  EXPECT_TRUE(names.contains("'shelf 1' with 'left side'")) << "a row of shelves and a side";
  EXPECT_TRUE(names.contains("'left side' with 'lid board'"));
  EXPECT_EQ(names.size(), 6U) << "two sides with bottom, lid and shelves";
}

TEST(Connections, SayWhatIsHardAndWhatIsSoft) {
  const ParametricAssembly boards = ParametrizedDesign(DowelledBoards());
  std::set<std::string> hard;
  for (const Relationship& relationship : Only(boards).hard) {
    hard.insert(relationship.description);
    EXPECT_NE(relationship.description.find("dowel 1"), std::string::npos)
        << "principals among themselves are not its affair";
  }
  EXPECT_TRUE(hard.contains("'dowel 1' z size fixed at 0.03 m"));
  EXPECT_TRUE(hard.contains("'bottom' z maximum before 'dowel 1' z maximum")) << "it reaches in";
  EXPECT_TRUE(
      hard.contains("'dowel 1' y centre level with y centre of the contact of 'bottom' and 'wall'"))
      << "both boards are centred there, so what they share is";
  EXPECT_TRUE(hard.contains("'dowel 1' y minimum inside the contact of 'bottom' and 'wall'"));
  EXPECT_EQ(Only(boards).soft.size(), 6U) << "both ends along each axis";
}

// A patch between single parts is theirs, not that of the boxes around rows of them.
TEST(Connections, PatchesAreOfParts) {
  Element row;
  row.pattern.emplace();
  row.pattern->directions[0] = {3, {0.2, 0, 0}, 0};
  row.pattern->part_size = {0.1, 0.1, 0.02};
  Element rail;
  const ConnectionPatch patch = FindPatch(row, {{0, 0, 0}, {0.5, 0.1, 0.02}}, rail,
                                          {{-1, 0.05, 0.02}, {0.25, 0.2, 0.1}}, 1e-9, 1e-9);
  ASSERT_EQ(patch.pieces.size(), 2U);
  ExpectBox(patch.pieces[0], {0, 0.05, 0.02}, {0.1, 0.1, 0.02});
  ExpectBox(patch.pieces[1], {0.2, 0.05, 0.02}, {0.25, 0.1, 0.02});
  ExpectBox(patch.region, {0, 0.05, 0.02}, {0.25, 0.1, 0.02});
  EXPECT_NEAR(patch.area, 0.05 * 0.15, 1e-12);
}

TEST(Connections, PartsThatMeetInAnEdgeDoNotTouch) {
  const Element board;
  const BoundingBox box{{0, 0, 0}, {1, 1, 1}};
  const auto kind = [&](const Eigen::Vector3d& minimum) {
    const BoundingBox other{minimum, minimum + Eigen::Vector3d::Ones()};
    return FindPatch(board, box, board, other, 1e-6, 1e-6).kind;
  };
  EXPECT_EQ(kind({1, 0.5, 0}), PatchKind::kContact);
  EXPECT_EQ(kind({1 + 5e-7, 0.5, 0}), PatchKind::kContact);
  EXPECT_EQ(kind({0.9, 0.5, 0}), PatchKind::kContact) << "a tenon";
  EXPECT_EQ(kind({1, 1, 0}), PatchKind::kGap) << "an edge";
  EXPECT_EQ(kind({1, 1, 1}), PatchKind::kGap) << "a corner";
  EXPECT_EQ(kind({1.1, 0, 0}), PatchKind::kGap);
}

}  // namespace
}  // namespace mortise::parametric
