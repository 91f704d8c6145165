// What fits into a shape does not hold its size: the shape is stretched in pieces.
#include "common/assembly/relations/feature_anchors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <tuple>

#include "common/assembly/parametric_assembly.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/model/drawn_parts.h"

namespace mortise::parametric {
namespace {

using cad::BoxAt;
using cad::Upright;
using ::testing::IsEmpty;

constexpr double kRadius = 0.008;  // of rods, m
constexpr double kThick = 0.018;   // of boards, m

AssemblyPart Bought(AssemblyPart part) {
  const Eigen::Vector3d size = part.box.size();
  for (std::size_t axis = 0; axis < 3; ++axis) part.limits[axis] = {size[axis], size[axis]};
  return part;
}

AssemblyPart Rod(const std::string& name, double x, double y, double radius = kRadius) {
  return Drawn(name, Upright(x, y, -0.05, kThick + 0.05, radius));
}

// A board of 400 × 300 mm with bores at these places.
AssemblyPart Board(const std::vector<std::pair<double, double>>& bores, double radius = kRadius) {
  TopoDS_Shape board = BoxAt(0, 0, 0, 0.4, 0.3, kThick);
  for (const auto& [x, y] : bores) board = Less(board, Upright(x, y, -1, 1, radius));
  return Drawn("board", board);
}

// The part's size along an axis, and where a bore of it begins and ends there, from its box's
// lower side.
struct Bore {
  double size = 0;
  double begins = 0, ends = 0;
};
Bore BoreOf(const PlacedPart& part, int axis, std::size_t index = 0) {
  const std::vector<mesh::LevelPlace>& levels = part.stretch.levels[static_cast<std::size_t>(axis)];
  EXPECT_GE(levels.size(), 2 * index + 2);
  if (levels.size() < 2 * index + 2) return {};
  const double size = part.box.size()[axis];
  return {size, levels[2 * index].place + size / 2, levels[2 * index + 1].place + size / 2};
}

double VolumeOf(const ParametricAssembly& made, const PlacedPart& part) {
  return mesh::VolumeIn(*made.ShapeOf(part), part.stretch);
}

void ExpectSound(const ParametricAssembly& made) {
  ASSERT_OK_AND_ASSIGN(std::vector<Eigen::VectorXd> designs, made.Sample(20, 1));
  ASSERT_OK_AND_ASSIGN(const auto corners, made.feasible_set().Corners(20, 2));
  designs.insert(designs.end(), corners.begin(), corners.end());
  for (const Eigen::VectorXd& q : designs) {
    ASSERT_OK_AND_ASSIGN(const std::vector<ContactFault> faults, made.FaultsAt(q));
    for (const ContactFault& fault : faults) ADD_FAILURE() << Describe(fault);
  }
}

// A bought rod of 16 mm leaves the board both its sizes; its bore stays round and at its share.
TEST(FeatureAnchors, LetABoardGrowAroundARod) {
  ASSERT_OK_AND_ASSIGN(const auto made,
                       ParametricAssembly::Create(
                           Named("rack", {Board({{0.1, 0.1}}), Bought(Rod("rod", 0.1, 0.1))})));
  EXPECT_THAT(made.HeldSizes(), IsEmpty());
  ASSERT_OK_AND_ASSIGN(
      const Adjustment larger,
      made.Adjust(made.drawn(), {{{"board", Axis::kX}, 0.7}, {{"board", Axis::kY}, 0.2}},
                  DemandPolicy::kStrict));
  const PlacedPart board = made.PartsAt(larger.q).front();
  const Bore along_x = BoreOf(board, 0), along_y = BoreOf(board, 1);
  EXPECT_NEAR(along_x.size, 0.7, 1e-9);
  EXPECT_NEAR(along_x.begins, 0.7 / 4 - kRadius, 1e-9);
  EXPECT_NEAR(along_x.ends, 0.7 / 4 + kRadius, 1e-9);
  EXPECT_NEAR(along_y.begins, 0.2 / 3 - kRadius, 1e-9);
  EXPECT_NEAR(along_y.ends, 0.2 / 3 + kRadius, 1e-9);
  const double volume = (0.7 * 0.2 - std::numbers::pi * kRadius * kRadius) * kThick;
  EXPECT_NEAR(VolumeOf(made, board) / volume, 1, 1e-6);
  ExpectSound(made);
}

// A bracket whose bolts are 60 mm apart does not hold the board that they run through.
TEST(FeatureAnchors, LetABoardGrowUnderABracket) {
  TopoDS_Shape bracket = BoxAt(0.08, 0.08, kThick, 0.1, 0.04, 0.003);
  for (const double x : {0.1, 0.16}) bracket = Less(bracket, Upright(x, 0.1, -1, 1, kRadius));
  ASSERT_OK_AND_ASSIGN(
      const auto made,
      ParametricAssembly::Create(
          Named("shelf", {Board({{0.1, 0.1}, {0.16, 0.1}}), Bought(Drawn("bracket", bracket)),
                          Bought(Rod("bolt 1", 0.1, 0.1)), Bought(Rod("bolt 2", 0.16, 0.1))})));
  ASSERT_OK_AND_ASSIGN(
      const Adjustment larger,
      made.Adjust(made.drawn(), {{{"board", Axis::kX}, 0.7}}, DemandPolicy::kStrict));
  const PlacedPart board = made.PartsAt(larger.q).front();
  const Bore first = BoreOf(board, 0, 0), second = BoreOf(board, 0, 1);
  EXPECT_NEAR(second.begins - first.begins, 0.06, 1e-9);
  EXPECT_NEAR(first.ends - first.begins, 2 * kRadius, 1e-9);
  EXPECT_NEAR(second.ends - second.begins, 2 * kRadius, 1e-9);
  ExpectSound(made);
}

// Two alike boards may get thicker together about a bought tenon that is let into both.
TEST(FeatureAnchors, LetBoardsGrowAboutALooseTenon) {
  const TopoDS_Shape tenon =
      cad::Oblong(gp_Pnt(0.1, 0.03, 0.025), gp_Pnt(0.14, 0.03, 0.025), 0.005, 0.03);
  AssemblyPart lower = Drawn("board", Less(BoxAt(0, 0, 0, 0.5, 0.06, 0.04), tenon));
  AssemblyPart upper = Drawn("board", Less(BoxAt(0, 0, 0.04, 0.5, 0.06, 0.04), tenon));
  upper.name = "upper";
  ASSERT_OK_AND_ASSIGN(
      const auto made,
      ParametricAssembly::Create(Named("boards", {lower, upper, Bought(Drawn("tenon", tenon))})));
  EXPECT_THAT(made.HeldSizes(), IsEmpty());
  ASSERT_OK(
      made.Adjust(made.drawn(), {{{"board", Axis::kZ}, 0.05}}, DemandPolicy::kStrict).status());
  ExpectSound(made);
}

// With 0.4 mm of play all round: as bolts have it.
TEST(FeatureAnchors, KeepThePlayOfBolts) {
  constexpr double kPlay = 0.0004;
  ASSERT_OK_AND_ASSIGN(
      const auto made,
      ParametricAssembly::Create(
          Named("board", {Board({{0.1, 0.1}, {0.3, 0.2}}, kRadius + kPlay),
                          Bought(Rod("bolt 1", 0.1, 0.1)), Bought(Rod("bolt 2", 0.3, 0.2)),
                          Boxed("nut 1", {0.08, 0.08, kThick}, {0.04, 0.04, 0.01}),
                          Boxed("nut 2", {0.28, 0.18, kThick}, {0.04, 0.04, 0.01})})));
  ASSERT_OK_AND_ASSIGN(
      const Adjustment larger,
      made.Adjust(made.drawn(), {{{"board", Axis::kX}, 0.6}}, DemandPolicy::kStrict));
  const std::vector<PlacedPart> parts = made.PartsAt(larger.q);
  for (const std::size_t index : {0U, 1U}) {
    const Bore bore = BoreOf(parts[0], 0, index);
    EXPECT_NEAR(bore.ends - bore.begins, 2 * (kRadius + kPlay), 1e-9);
    EXPECT_NEAR(parts[1 + index].box.minimum.x() - parts[0].box.minimum.x() - bore.begins, kPlay,
                1e-9);
  }
}

TEST(FeatureAnchors, KeepEmptyBoresAsWideAsDrawn) {
  ASSERT_OK_AND_ASSIGN(const auto made,
                       ParametricAssembly::Create(
                           Named("board", {Board({{0.1, 0.1}, {0.3, 0.25}}),
                                           Boxed("box", {0, 0, kThick}, {0.05, 0.05, 0.05})})));
  ASSERT_OK_AND_ASSIGN(
      const Adjustment larger,
      made.Adjust(made.drawn(), {{{"board", Axis::kX}, 0.8}, {{"board", Axis::kY}, 0.2}},
                  DemandPolicy::kStrict));
  const PlacedPart board = made.PartsAt(larger.q).front();
  for (const int axis : {0, 1}) {
    for (const std::size_t index : {0U, 1U}) {
      const Bore bore = BoreOf(board, axis, index);
      EXPECT_NEAR(bore.ends - bore.begins, 2 * kRadius, 1e-9);
    }
  }
  EXPECT_NEAR(BoreOf(board, 0, 1).begins, 0.8 * 3 / 4 - kRadius, 1e-9);
  const double volume = (0.8 * 0.2 - 2 * std::numbers::pi * kRadius * kRadius) * kThick;
  EXPECT_NEAR(VolumeOf(made, board) / volume, 1, 1e-6);
}

// A rod of no item stays round, and its bore as wide as it.
TEST(FeatureAnchors, FollowARodThatGrows) {
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(Named(
                                            "rack", {Board({{0.1, 0.1}}), Rod("rod", 0.1, 0.1)})));
  ASSERT_OK_AND_ASSIGN(
      const Adjustment thicker,
      made.Adjust(made.drawn(), {{{"rod", Axis::kX}, 0.024}}, DemandPolicy::kStrict));
  const std::vector<PlacedPart> parts = made.PartsAt(thicker.q);
  EXPECT_NEAR(parts[1].box.size().y(), 0.024, 1e-9);
  for (const int axis : {0, 1}) {
    const Bore bore = BoreOf(parts[0], axis);
    EXPECT_NEAR(bore.ends - bore.begins, 0.024, 1e-9);
    EXPECT_NEAR(bore.size, axis == 0 ? 0.4 : 0.3, 1e-9) << "the board stays as it is";
  }
  ExpectSound(made);
}

// A rail with tenons of 30 mm in bought posts of 60 × 60: its length is free, and the tenons stay
// as long as the mortises are deep.
TEST(FeatureAnchors, LetARailGrowBetweenPosts) {
  const TopoDS_Shape tongue = BoxAt(0.03, 0.02, 0.12, 0.46, 0.02, 0.06);
  const TopoDS_Shape rail =
      BRepAlgoAPI_Fuse(BoxAt(0.06, 0.01, 0.1, 0.4, 0.04, 0.1), tongue).Shape();
  const auto post = [&](const std::string& name, double x) {
    AssemblyPart part = Drawn(name, Less(BoxAt(x, 0, 0, 0.06, 0.06, 0.3), tongue));
    for (const std::size_t axis : {0U, 1U}) part.limits[axis] = {0.06, 0.06};
    return part;
  };
  ASSERT_OK_AND_ASSIGN(const auto made,
                       ParametricAssembly::Create(Named(
                           "frame", {Drawn("rail", rail), post("left", 0), post("right", 0.46)})));
  ASSERT_OK_AND_ASSIGN(
      const Adjustment longer,
      made.Adjust(made.drawn(), {{{"rail", Axis::kX}, 0.8}}, DemandPolicy::kStrict));
  const std::vector<PlacedPart> parts = made.PartsAt(longer.q);
  const Bore body = BoreOf(parts[0], 0);
  EXPECT_NEAR(body.begins, 0.03, 1e-9);
  EXPECT_NEAR(body.size - body.ends, 0.03, 1e-9);
  EXPECT_NEAR(parts[2].box.minimum.x() - parts[1].box.maximum.x(), 0.8 - 0.06, 1e-9);
  ExpectSound(made);
}

// Three equal boards in a row, on two rods: the row is one element, whose bores follow all the
// same.
TEST(FeatureAnchors, AreThoseOfAllBoardsInARow) {
  const TopoDS_Shape board =
      Less(Less(BoxAt(0, 0, 0, 0.4, 0.3, kThick), Upright(0.1, 0.1, -1, 1, kRadius)),
           Upright(0.3, 0.2, -1, 1, kRadius));
  const AssemblyPart lowest = Drawn("board 1", board);
  std::vector<AssemblyPart> parts = {lowest, lowest, lowest};
  for (int i = 1; i < 3; ++i) {
    AssemblyPart& part = parts[static_cast<std::size_t>(i)];
    part.name = "board " + std::to_string(i + 1);
    part.box.minimum.z() += 0.3 * i;
    part.box.maximum.z() += 0.3 * i;
  }
  for (const auto& [name, x, y] : {std::tuple("rod 1", 0.1, 0.1), std::tuple("rod 2", 0.3, 0.2)}) {
    parts.push_back(Bought(Drawn(name, Upright(x, y, -0.05, 0.7, kRadius))));
  }
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(Named("rack", parts)));
  EXPECT_EQ(made.elements().size(), 3U);
  EXPECT_THAT(made.HeldSizes(), IsEmpty());
  ASSERT_OK_AND_ASSIGN(
      const Adjustment larger,
      made.Adjust(made.drawn(), {{{"board 1", Axis::kX}, 0.8}, {{"board 1", Axis::kY}, 0.5}},
                  DemandPolicy::kStrict));
  for (const PlacedPart& part : made.PartsAt(larger.q)) {
    if (part.element != 0) continue;
    const Bore along_x = BoreOf(part, 0, 1);
    EXPECT_NEAR(along_x.begins, 0.6 - kRadius, 1e-9);
    EXPECT_NEAR(along_x.ends, 0.6 + kRadius, 1e-9);
  }
  ExpectSound(made);
}

// Bought dowels in blind bores between two sides and a shelf: the shelf's length is free, and the
// bores stay as deep as the dowels are long.
TEST(FeatureAnchors, LetAShelfGrowBetweenDowels) {
  const auto dowel = [](double x) {
    return RodAlong(gp_Dir(1, 0, 0), gp_Pnt(x, 0.1, 0.2), 0.004, 0.03);
  };
  const auto side = [&](const std::string& name, double x, double at) {
    AssemblyPart part = Drawn(name, Less(BoxAt(x, 0, 0, 0.018, 0.2, 0.4), dowel(at)));
    part.limits[0] = {0.018, 0.018};
    return part;
  };
  TopoDS_Shape shelf = BoxAt(0.018, 0, 0.191, 0.4, 0.2, 0.018);
  for (const double x : {0.006, 0.4}) shelf = Less(shelf, dowel(x));
  ASSERT_OK_AND_ASSIGN(const auto made,
                       ParametricAssembly::Create(Named(
                           "shelf", {side("left", 0, 0.006), side("right", 0.418, 0.4),
                                     Drawn("shelf", shelf), Bought(Drawn("dowel 1", dowel(0.006))),
                                     Bought(Drawn("dowel 2", dowel(0.4)))})));
  ASSERT_OK_AND_ASSIGN(
      const Adjustment longer,
      made.Adjust(made.drawn(), {{{"shelf", Axis::kX}, 0.7}}, DemandPolicy::kStrict));
  const Bore bottoms = BoreOf(made.PartsAt(longer.q)[2], 0);
  EXPECT_NEAR(bottoms.begins, 0.018, 1e-9);
  EXPECT_NEAR(bottoms.size - bottoms.ends, 0.012 + 0.006, 1e-9);
  ExpectSound(made);
}

// A blind bore of 40 mm in the end of a rail, with a dowel that is not as long: it stays as deep.
TEST(FeatureAnchors, KeepBlindBoresAsDeepAsDrawn) {
  const auto bore = [](double length) {
    return RodAlong(gp_Dir(1, 0, 0), gp_Pnt(-0.01, 0.02, 0.02), 0.005, 0.01 + length);
  };
  ASSERT_OK_AND_ASSIGN(
      const auto made,
      ParametricAssembly::Create(
          Named("rail", {Drawn("rail", Less(BoxAt(0, 0, 0, 0.5, 0.04, 0.04), bore(0.04))),
                         Bought(Drawn("dowel", bore(0.035)))})));
  ASSERT_OK_AND_ASSIGN(
      const Adjustment longer,
      made.Adjust(made.drawn(), {{{"rail", Axis::kX}, 0.9}}, DemandPolicy::kStrict));
  const PlacedPart rail = made.PartsAt(longer.q).front();
  ASSERT_EQ(rail.stretch.levels[0].size(), 1U);
  EXPECT_NEAR(rail.stretch.levels[0][0].place + 0.45, 0.04, 1e-9);
}

// Pegs in a row in one board are taken one by one: a bore for each is there as drawn.
TEST(FeatureAnchors, AreOnePegAfterTheOther) {
  std::vector<std::pair<double, double>> places;
  std::vector<AssemblyPart> parts;
  for (int i = 0; i < 4; ++i) {
    places.emplace_back(0.05 + 0.1 * i, 0.1);
    parts.push_back(Bought(Rod("peg " + std::to_string(i + 1), 0.05 + 0.1 * i, 0.1)));
    parts.back().item = "items/peg";
    parts.back().shape = parts.front().shape;
  }
  parts.push_back(Board(places));
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(Named("rack", parts)));
  EXPECT_EQ(made.elements().size(), 5U);
  EXPECT_THAT(made.HeldSizes(), IsEmpty());
  ExpectSound(made);
}

// What lies across bores that overlap is one piece, which goes by the larger thing in it.
TEST(FeatureAnchors, KeepBoresThatOverlapTogether) {
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(
                                            Named("board", {Board({{0.1, 0.1}, {0.11, 0.2}}),
                                                            Bought(Rod("rod 1", 0.1, 0.1)),
                                                            Bought(Rod("rod 2", 0.11, 0.2))})));
  EXPECT_THAT(made.HeldSizes(), IsEmpty());
  ASSERT_OK_AND_ASSIGN(
      const Adjustment larger,
      made.Adjust(made.drawn(), {{{"board", Axis::kX}, 0.7}}, DemandPolicy::kStrict));
  const std::vector<PlacedPart> parts = made.PartsAt(larger.q);
  EXPECT_NEAR(parts[2].box.minimum.x() - parts[1].box.minimum.x(), 0.01, 1e-9);
  ExpectSound(made);
}

// At infinitely many parameters nobody asks for, as at these, shapes are stretched as a whole.
TEST(FeatureAnchors, GiveWayWhereADesignIsNone) {
  ASSERT_OK_AND_ASSIGN(const auto made,
                       ParametricAssembly::Create(
                           Named("rack", {Board({{0.1, 0.1}}), Bought(Rod("rod", 0.1, 0.1))})));
  Eigen::VectorXd q = made.drawn();
  q[CenterVariable(1, Axis::kX)] += 1;
  const std::vector<PlacedPart> parts = made.PartsAt(q);
  EXPECT_TRUE(parts[0].stretch.IsInProportion(0));
  EXPECT_FALSE(parts[0].stretch.IsInProportion(1));
}

}  // namespace
}  // namespace mortise::parametric
