// Parts that fit into each other go on doing so, whatever sizes people ask for.
#include "common/assembly/relations/fit_relationships.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepAlgoAPI_Common.hxx>
#include <random>

#include "common/assembly/parametric_assembly.h"
#include "common/mesh/shapes/shape_levels.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/model/drawn_parts.h"

namespace mortise::parametric {
namespace {

using cad::BoxAt;
using ::testing::Contains;
using ::testing::Not;

class Drawing {
 public:
  explicit Drawing(std::uint64_t seed) : random_(seed) {}

  // A rail whose tenons stand in mortises of two posts.
  Assembly MortiseAndTenon() {
    const double post = Length(0.035, 0.06), width = Length(0.2, 0.5);
    const double low = Length(0.1, 0.25), rail = Length(0.05, 0.09);
    const double deep = Length(0.4, 0.8) * post, shoulder = Length(0.1, 0.25) * rail;
    const double thick = Length(0.4, 0.7) * post, tenon = Length(0.3, 0.6) * thick;
    const double y = (post - thick) / 2, ty = (post - tenon) / 2;
    const TopoDS_Shape body = BoxAt(post, y, low, width, thick, rail);
    const TopoDS_Shape tongue =
        BoxAt(post - deep, ty, low + shoulder, width + 2 * deep, tenon, rail - 2 * shoulder);
    const auto upright = [&](double x) { return Less(BoxAt(x, 0, 0, post, post, 0.4), tongue); };
    return Named("rail", {Drawn("rail", BRepAlgoAPI_Fuse(body, tongue).Shape()),
                          Drawn("post 1", upright(0)), Drawn("post 2", upright(post + width))});
  }

  // A wheel that turns on its axle between two cheeks.
  Assembly Wheel() {
    const double bore = Length(0.006, 0.015), play = OneIn(2) ? 0 : 0.0005;
    const double radius = Length(0.06, 0.15), height = radius + Length(0, 0.02);
    const gp_Dir along(0, 1, 0);
    const auto rod = [&](double from, double to, double by) {
      return RodAlong(along, gp_Pnt(0, from, height), by, to - from);
    };
    const auto cheek = [&](double y) {
      return Less(BoxAt(-0.025, y, height - 0.03, 0.05, 0.012, radius + 0.06),
                  rod(y - 0.01, y + 0.02, bore));
    };
    return Named("wheel",
                 {Drawn("wheel", Less(rod(-0.02, 0.02, radius), rod(-0.03, 0.03, bore + play))),
                  Drawn("axle", rod(-0.04, 0.05, bore)), Drawn("cheek 1", cheek(-0.034)),
                  Drawn("cheek 2", cheek(0.022)),
                  Boxed("crown", {-0.025, -0.034, height + radius + 0.03}, {0.05, 0.068, 0.02})});
  }

  // A seat on legs that are let into it aslant.
  Assembly Stool() {
    const double slope = Length(0.05, 0.3), thick = Length(0.02, 0.04), high = Length(0.3, 0.5);
    const double radius = Length(0.012, 0.02), from_middle = Length(0.07, 0.1);
    const bool is_through = OneIn(2);
    TopoDS_Shape seat = BoxAt(-0.17, -0.17, high, 0.34, 0.34, thick);
    std::vector<AssemblyPart> parts;
    for (int i = 0; i < 4; ++i) {
      const double x = i % 2 == 0 ? 1 : -1, y = i < 2 ? 1 : -1;
      const TopoDS_Shape leg =
          RodAlong(gp_Dir(slope * x, slope * y, -1),
                   gp_Pnt(from_middle * x, from_middle * y, high + 0.1), radius, 0.8);
      const double top = high + (is_through ? thick : 0);
      parts.push_back(Drawn("leg " + std::to_string(i + 1),
                            BRepAlgoAPI_Common(leg, BoxAt(-1, -1, 0, 2, 2, top)).Shape()));
      if (is_through) seat = Less(seat, leg);
    }
    parts.push_back(Drawn("seat", seat));
    return Named("stool", parts);
  }

  // Four sides that meet in mitres, and a pane between them.
  Assembly MitredFrame() {
    const double w = Length(0.3, 0.8), h = Length(0.2, 0.6), b = Length(0.03, 0.08);
    return Named("frame",
                 {Drawn("bottom", Plate({{0, 0}, {w, 0}, {w - b, b}, {b, b}}, 0.02)),
                  Drawn("top", Plate({{0, h}, {b, h - b}, {w - b, h - b}, {w, h}}, 0.02)),
                  Drawn("left", Plate({{0, 0}, {b, b}, {b, h - b}, {0, h}}, 0.02)),
                  Drawn("right", Plate({{w, 0}, {w, h}, {w - b, h - b}, {w - b, b}}, 0.02)),
                  Boxed("pane", {b, b, 0.008}, {w - 2 * b, h - 2 * b, 0.004})});
  }

  // A round rod between boards, nearly half of it beyond the edge of the lower one.
  Assembly RodBetweenBoards() {
    const double radius = Length(0.01, 0.03), beyond = -Length(0.1, 0.6) * radius;
    return Named("rod",
                 {Boxed("board", {0, 0, 0}, {0.3, 0.5, 0.02}),
                  Boxed("shelf", {0.1, 0, 0.02 + 2 * radius}, {0.4, 0.5, 0.02}),
                  Drawn("rod", RodAlong(gp_Dir(0, 1, 0), gp_Pnt(0.3 + beyond, 0.05, 0.02 + radius),
                                        radius, 0.4))});
  }

  // Boards on rods that run through them, which are bought, or as thick as one likes; in bores with
  // play or none, some of which are empty.
  Assembly BoardsOnRods() {
    const double w = Length(0.3, 0.8), d = Length(0.2, 0.4), thick = Length(0.012, 0.03);
    const int boards = OneIn(2) ? 2 : 4, rods = OneIn(2) ? 2 : 4;
    const double high = Length(0.25, 0.5), radius = Length(0.005, 0.012);
    const double play = OneIn(2) ? 0 : 0.0005;
    const double dx = Length(0.03, 0.08), dy = Length(0.03, 0.08);
    const bool is_bought = OneIn(2), is_row = OneIn(2);
    const gp_Pnt empty(w / 2 + Length(0, 0.05), d / 2, 0);
    const double empty_radius = Length(0.004, 0.01);
    std::vector<AssemblyPart> parts;
    std::vector<gp_Pnt> at;
    for (int i = 0; i < rods; ++i) {
      at.emplace_back(i % 2 == 0 ? dx : w - dx, i < 2 ? dy : d - dy, 0);
    }
    for (int i = 0; i < boards; ++i) {
      TopoDS_Shape board = BoxAt(0, 0, high * i / (boards - 1), w, d, thick);
      for (const gp_Pnt& foot : at) {
        board = Less(board, cad::Upright(foot.X(), foot.Y(), -1, 2, radius + play));
      }
      board = Less(board, cad::Upright(empty.X(), empty.Y(), -1, 2, empty_radius));
      parts.push_back(Drawn("board " + std::to_string(i + 1), board));
      if (!is_row) continue;
      parts.back().item = parts.front().item;
      parts.back().shape = parts.front().shape;
    }
    for (int i = 0; i < rods; ++i) {
      const gp_Pnt& foot = at[static_cast<std::size_t>(i)];
      parts.push_back(Drawn("rod " + std::to_string(i + 1),
                            cad::Upright(foot.X(), foot.Y(), 0, high + thick, radius)));
      if (is_bought) Fix(parts.back(), {0, 1});
    }
    return Named("boards", parts);
  }

  // A bought bracket held to a board by bought bolts through both, and to a post by others.
  Assembly BoltedBracket() {
    const double w = Length(0.2, 0.6), d = Length(0.15, 0.3), thick = Length(0.018, 0.03);
    const double apart = Length(0.04, 0.07), radius = Length(0.003, 0.005);
    const double play = OneIn(2) ? 0 : 0.0003, x = Length(0.02, 0.04);
    TopoDS_Shape board = BoxAt(0, 0, 0, w, d, thick);
    TopoDS_Shape flange = BoxAt(0, d / 2 - 0.02, thick, x + apart + 0.02, 0.04, 0.004);
    std::vector<AssemblyPart> bolts;
    for (int i = 0; i < 2; ++i) {
      const TopoDS_Shape bore = cad::Upright(x + i * apart, d / 2, -1, 1, radius + play);
      board = Less(board, bore);
      flange = Less(flange, bore);
      bolts.push_back(Drawn("bolt " + std::to_string(i + 1),
                            cad::Upright(x + i * apart, d / 2, 0, thick + 0.004, radius)));
      Fix(bolts.back(), {0, 1});
    }
    std::vector<AssemblyPart> parts = {Drawn("board", board), Drawn("bracket", flange)};
    Fix(parts.back(), {0, 1, 2});
    parts.insert(parts.end(), bolts.begin(), bolts.end());
    return Named("bracket", parts);
  }

  // A rail whose tenons, with shoulders all round, stand in mortises of two bought posts.
  Assembly BoughtPosts() {
    Assembly drawn = MortiseAndTenon();
    Fix(drawn.parts[1], {0, 1});
    Fix(drawn.parts[2], {0, 1});
    if (OneIn(2)) Fix(drawn.parts[0], {1, 2});
    return drawn;
  }

  // A stop on a board, held by bought bolts through slots of the one and bores of the other.
  Assembly SlottedStop() {
    const double w = Length(0.2, 0.6), d = Length(0.15, 0.3), thick = Length(0.012, 0.03);
    const double radius = Length(0.003, 0.006), play = OneIn(2) ? 0 : 0.0004;
    const double travel = Length(0.02, 0.04), at = OneIn(3) ? 0 : Length(0, 1) * travel;
    const bool is_along_x = OneIn(2);
    TopoDS_Shape board = BoxAt(0, 0, 0, w, d, thick);
    TopoDS_Shape stop = BoxAt(0, 0, thick, 0.15, 0.12, 0.006);
    std::vector<AssemblyPart> bolts;
    for (int i = 0; i < 2; ++i) {
      const double x = is_along_x ? 0.04 : 0.03 + 0.08 * i, y = is_along_x ? 0.03 + 0.05 * i : 0.04;
      const gp_Pnt from(x, y, 0), bolt = from.Translated(AlongSlot(at, is_along_x));
      stop = Less(stop, cad::Oblong(from, from.Translated(AlongSlot(travel, is_along_x)),
                                    radius + play, 1));
      board = Less(board, cad::Upright(bolt.X(), bolt.Y(), -1, 1, radius + play));
      bolts.push_back(Drawn("bolt " + std::to_string(i + 1),
                            cad::Upright(bolt.X(), bolt.Y(), 0, thick + 0.006, radius)));
      Fix(bolts.back(), {0, 1});
    }
    std::vector<AssemblyPart> parts = {Drawn("board", board), Drawn("stop", stop)};
    parts.insert(parts.end(), bolts.begin(), bolts.end());
    return Named("stop", parts);
  }

  // A strip on a plate, held by bought screws in two rows, whose heads are let into the strip.
  Assembly Countersunk() {
    const double w = Length(0.3, 0.6), d = Length(0.1, 0.2), thick = Length(0.015, 0.03);
    const double strip = Length(0.012, 0.02), radius = Length(0.002, 0.004);
    const double play = OneIn(2) ? 0 : 0.0003, top = thick + strip, deep = 0.6 * thick;
    TopoDS_Shape lower = BoxAt(0, 0, 0, w, d, thick);
    TopoDS_Shape upper = BoxAt(0.02, 0.02, thick, w - 0.04, d - 0.04, strip);
    std::vector<AssemblyPart> screws;
    for (int i = 0; i < 4; ++i) {
      const double x = i % 2 == 0 ? 0.05 : w - 0.07, y = i < 2 ? 0.035 : d - 0.04;
      const auto head = [&](double larger) {
        return BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(x, y, top - radius), gp_Dir(0, 0, 1)),
                                    radius + larger, 2 * radius + larger, radius)
            .Solid();
      };
      upper = Less(Less(upper, cad::Upright(x, y, 0, 1, radius + play)), head(play));
      lower = Less(lower, cad::Upright(x, y, thick - deep, 1, radius + play));
      screws.push_back(
          Drawn("screw " + std::to_string(i + 1),
                BRepAlgoAPI_Fuse(cad::Upright(x, y, thick - deep, top - radius, radius), head(0))
                    .Shape()));
      Fix(screws.back(), {0, 1, 2});
    }
    std::vector<AssemblyPart> parts = {Drawn("plate", lower), Drawn("strip", upper)};
    parts.insert(parts.end(), screws.begin(), screws.end());
    return Named("strip", parts);
  }

  // Two boards one on the other, with a loose tenon with round ends, bought or not, let into both.
  Assembly LooseTenon() {
    const double w = Length(0.1, 0.5), d = Length(0.06, 0.2), thick = Length(0.03, 0.05);
    const double radius = Length(0.003, 0.006), deep = Length(0.3, 0.45) * thick;
    const gp_Pnt from(Length(0.02, 0.05), d / 2, thick - deep);
    const gp_Pnt to = from.Translated(gp_Vec(Length(0.01, 0.03), 0, 0));
    const TopoDS_Shape tenon = cad::Oblong(from, to, radius, 2 * deep);
    AssemblyPart drawn = Drawn("tenon", tenon);
    if (OneIn(2)) Fix(drawn, {0, 1, 2});
    return Named("boards", {Drawn("lower", Less(BoxAt(0, 0, 0, w, d, thick), tenon)),
                            Drawn("upper", Less(BoxAt(0, 0, thick, w, d, thick), tenon)), drawn});
  }

  // A wheel, bought or not, on a bought shaft that turns in two blocks on a plate, at any angle.
  Assembly TurningWheel() {
    const double radius = Length(0.05, 0.1), shaft = Length(0.006, 0.012);
    const double above = OneIn(2) ? 0 : Length(0.001, 0.02), thick = Length(0.012, 0.03);
    const double turned = Length(0.3, 1.2), height = thick + above + radius;
    const gp_Dir along(0, 1, 0);
    const auto rod = [&](double from, double to, double by) {
      return RodAlong(along, gp_Pnt(0.2, from, height), by, to - from);
    };
    const auto block = [&](double y) {
      return Less(BoxAt(0.16, y, thick, 0.08, 0.02, height - thick + 0.03),
                  rod(y - 0.01, y + 0.03, shaft));
    };
    Assembly drawn =
        Named("wheel", {Boxed("plate", {0, 0, 0}, {0.4, 0.2, thick}),
                        Drawn("wheel", Less(rod(0.08, 0.12, radius), rod(0.07, 0.13, shaft))),
                        Drawn("shaft", rod(0.03, 0.17, shaft)), Drawn("block 1", block(0.04)),
                        Drawn("block 2", block(0.14))});
    Fix(drawn.parts[2], {0, 1, 2});
    drawn.groups.push_back({"turning", 0});
    drawn.parts[1].group = drawn.parts[2].group = 1;
    Joint bearing;
    bearing.name = "bearing";
    bearing.kind = JointKind::kHinge;
    bearing.group = 1;
    bearing.center = {0.2, 0.1, height};
    bearing.axis = Eigen::Vector3d::UnitY();
    bearing.upper = 3;
    bearing.rest_poses = {{"turned", {0, turned, 0}}};
    drawn.joints = {bearing};
    return drawn;
  }

  // A hook that turns about its heel until it closes round a pin, which may touch it.
  Assembly Latch() {
    const double arm = Length(0.05, 0.09), thick = Length(0.006, 0.012);
    const double radius = Length(0.004, 0.008), play = OneIn(2) ? 0 : 0.001;
    const double closed = Length(1.9, 2.9), from_arms = thick + radius + play;
    const Eigen::Vector2d pin = Eigen::Rotation2Dd(closed) * Eigen::Vector2d(from_arms, from_arms);
    const AssemblyPart hook = Drawn(
        "hook", Plate({{0, 0}, {arm, 0}, {arm, thick}, {thick, thick}, {thick, arm}, {0, arm}},
                      Length(0.01, 0.02)));
    Assembly latch =
        Named("latch",
              {Boxed("plate", {-0.1, -0.1, -0.02}, {0.25, 0.25, 0.02}), hook,
               Drawn("pin", RodAlong(gp_Dir(0, 0, 1), gp_Pnt(pin.x(), pin.y(), 0), radius, 0.03))});
    latch.groups.push_back({"turning", 0});
    latch.parts[1].group = 1;
    Joint heel;
    heel.name = "heel";
    heel.kind = JointKind::kHinge;
    heel.group = 1;
    heel.axis = Eigen::Vector3d::UnitZ();
    heel.upper = 3;
    heel.rest_poses = {{"closed", {0, 0, closed}}};
    latch.joints = {heel};
    return latch;
  }

 private:
  static void Fix(AssemblyPart& part, const std::vector<int>& axes) {
    for (const int axis : axes) {
      const double size = part.box.size()[axis];
      part.limits[static_cast<std::size_t>(axis)] = {size, size};
    }
  }

  static gp_Vec AlongSlot(double length, bool is_along_x) {
    return is_along_x ? gp_Vec(length, 0, 0) : gp_Vec(0, length, 0);
  }

  bool OneIn(int count) { return std::uniform_int_distribution<int>(1, count)(random_) == 1; }
  // To the tenth of a millimetre.
  double Length(double low, double high) {
    return std::round(1e4 * std::uniform_real_distribution<double>(low, high)(random_)) / 1e4;
  }

  std::mt19937_64 random_;
};

struct Kind {
  std::string name;
  Assembly (Drawing::*draw)();
  int least_freedom = 3;  // it can be resized along every axis
};

class Fits : public ::testing::TestWithParam<Kind> {};

TEST_P(Fits, KeepWhateverIsAskedFor) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    Drawing drawing(seed);
    const Assembly drawn = (drawing.*GetParam().draw)();
    ASSERT_THAT(ValidateAssembly(drawn), ::testing::IsEmpty());
    ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(drawn));
    EXPECT_GE(made.feasible_set().degrees_of_freedom(), GetParam().least_freedom);
    ASSERT_OK_AND_ASSIGN(std::vector<Eigen::VectorXd> designs, made.Sample(40, seed));
    ASSERT_OK_AND_ASSIGN(const auto corners, made.feasible_set().Corners(40, seed + 100));
    designs.insert(designs.end(), corners.begin(), corners.end());
    for (const Eigen::VectorXd& q : designs) {
      ASSERT_OK_AND_ASSIGN(const std::vector<ContactFault> faults, made.FaultsAt(q));
      for (const ContactFault& fault : faults) ADD_FAILURE() << Describe(fault);
      if (!faults.empty()) return;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    AllKinds, Fits,
    ::testing::Values(Kind{"Tenon", &Drawing::MortiseAndTenon}, Kind{"Wheel", &Drawing::Wheel},
                      Kind{"Stool", &Drawing::Stool}, Kind{"Mitre", &Drawing::MitredFrame},
                      Kind{"Rod", &Drawing::RodBetweenBoards}, Kind{"Latch", &Drawing::Latch},
                      Kind{"Boards", &Drawing::BoardsOnRods},
                      Kind{"Bracket", &Drawing::BoltedBracket},
                      Kind{"Slots", &Drawing::SlottedStop, 4},
                      Kind{"Countersinks", &Drawing::Countersunk, 3},
                      Kind{"LooseTenon", &Drawing::LooseTenon, 3},
                      Kind{"TurningWheel", &Drawing::TurningWheel, 4},
                      Kind{"BoughtPosts", &Drawing::BoughtPosts, 2}),
    [](const auto& kind) { return kind.param.name; });

// Along z, with its seam at an angle: triangles begin there, and miss the sides by as much as they
// like in between.
TopoDS_Shape RodFrom(double angle, double radius, double from, double to) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(1.5, 0.5, from), gp_Dir(0, 0, 1),
                                         gp_Dir(std::cos(angle), std::sin(angle), 0)),
                                  radius, to - from)
      .Solid();
}

AssemblyPart BoredPlate(const std::string& name, double bottom, double seam) {
  return Drawn(name, Less(BoxAt(0, 0, bottom, 3, 1, 0.04), RodFrom(seam, 0.43, -1, 1)));
}

// However coarse its triangles are, a bore is as wide as the rod in it, and as thick as that can
// be.
TEST(FitsOfBores, AreAsExactAsWhatFits) {
  const Assembly drawn =
      Named("rod", {BoredPlate("plate", 0, 0.3), Drawn("rod", RodFrom(1.1, 0.43, 0, 0.04))});
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(drawn));
  ASSERT_OK_AND_ASSIGN(
      const Adjustment larger,
      made.Adjust(made.drawn(), {{{"plate", Axis::kY}, 2}, {{"rod", Axis::kX}, 1.72}},
                  DemandPolicy::kStrict));
  EXPECT_NEAR(larger.q[SizeVariable(1, Axis::kY)], 1.72, 1e-9) << "it stays round";
  const std::vector<PlacedPart> parts = made.PartsAt(larger.q);
  for (const std::size_t axis : {0U, 1U}) {
    const std::vector<mesh::LevelPlace>& sides = parts[0].stretch.levels[axis];
    ASSERT_EQ(sides.size(), 2U);
    EXPECT_NEAR(sides[1].place - sides[0].place, 1.72, 1e-9);
  }
  ASSERT_OK_AND_ASSIGN(const MeasureRange range, made.RangeOf({"rod", Axis::kX}));
  EXPECT_NEAR(range.minimum, 0.43, 1e-9);
  EXPECT_NEAR(range.maximum, 1.72, 1e-9);
}

// Bores of two plates on one rod, whose triangles miss it differently.
TEST(FitsOfBores, OnOneRodCanAllBeResized) {
  const Assembly drawn =
      Named("stack", {BoredPlate("plate", 0, 0.3), BoredPlate("cover", 0.04, 0.8),
                      Drawn("rod", RodFrom(1.1, 0.43, 0, 0.08))});
  ASSERT_OK_AND_ASSIGN(const auto made, ParametricAssembly::Create(drawn));
  for (const Axis axis : {Axis::kX, Axis::kY}) {
    ASSERT_OK_AND_ASSIGN(const MeasureRange range, made.RangeOf({"rod", axis}));
    EXPECT_NEAR(range.minimum, 0.43, 1e-9);
    EXPECT_NEAR(range.maximum, 1.72, 1e-9);
  }
}

// By hand: a block of 100 × 60 × 40 mm with a bore of 20 mm along z, its axis at (30, 40).
TEST(ShapeLevels, AreTheSidesOfABore) {
  const AssemblyPart block =
      Drawn("block", Less(BoxAt(0, 0, 0, 0.1, 0.06, 0.04), cad::Upright(0.03, 0.04, -1, 1, 0.01)));
  std::vector<std::vector<double>> levels(3);
  for (const mesh::ShapeLevel& level : mesh::LevelsOf(*block.shape)) {
    levels[static_cast<std::size_t>(level.axis)].push_back((level.fraction + 0.5) *
                                                           block.box.size()[level.axis]);
  }
  const double missed = mesh::DeflectionIn(*block.shape, block.box.size());
  EXPECT_LT(missed, 1e-4);
  EXPECT_THAT(levels[0],
              ::testing::Pointwise(::testing::DoubleNear(missed), std::vector<double>{0.02, 0.04}));
  EXPECT_THAT(levels[1],
              ::testing::Pointwise(::testing::DoubleNear(missed), std::vector<double>{0.03, 0.05}));
  EXPECT_THAT(levels[2], ::testing::IsEmpty());
}

TEST(ShapeLevels, AreStepsAndSummits) {
  const TopoDS_Shape step =
      BRepAlgoAPI_Fuse(BoxAt(0, 0, 0, 0.1, 0.05, 0.02), BoxAt(0, 0, 0.02, 0.04, 0.05, 0.03))
          .Shape();
  const AssemblyPart part = Drawn("step", step);
  std::vector<std::pair<int, double>> levels;
  for (const mesh::ShapeLevel& level : mesh::LevelsOf(*part.shape)) {
    levels.emplace_back(level.axis, std::round(1e9 * level.fraction) / 1e9);
  }
  EXPECT_THAT(levels, ::testing::ElementsAre(std::pair(0, -0.1), std::pair(2, -0.1)));
}

// The smaller part's size and the distance of the centres are what they are of the larger's size.
TEST(StretchTogether, KeepsSizesAndPlacesInProportion) {
  const Assembly drawn =
      Named("two", {Boxed("a", {0, 0, 0}, {1, 2, 3}), Boxed("b", {0.5, 1, 1}, {0.2, 0.3, 6})});
  const std::vector<Element> elements = MakeElements(drawn, 1e-6);
  const std::vector<Relationship> together = StretchTogether(Pose(), drawn, elements, {{"", 0, 1}});
  ASSERT_EQ(together.size(), 6U);
  Eigen::VectorXd q = DrawnParameters(drawn, elements);
  for (const Relationship& one : together) EXPECT_NEAR(one.form.At(q), 0, 1e-12);
  const Eigen::Array3d factor(2, 0.5, 3), shift(7, 8, 9);
  for (int part = 0; part < 4; ++part) q.segment<3>(3 * part).array() *= factor;
  for (int part = 0; part < 2; ++part) q.segment<3>(6 * part).array() += shift;
  for (const Relationship& one : together) EXPECT_NEAR(one.form.At(q), 0, 1e-12);
  q[SizeVariable(0, Axis::kY)] *= 1.1;
  std::vector<std::string> broken;
  for (const Relationship& one : together) {
    if (std::abs(one.form.At(q)) > 1e-9) broken.push_back(one.description);
  }
  EXPECT_THAT(broken, Contains("'b' stretches along y with 'a'"));
  EXPECT_THAT(broken, Not(Contains("'b' stretches along x with 'a'")));
}

// Turned by half a right angle, only a scaling of both keeps how they meet.
TEST(StretchTogether, ScalesWhatAPoseTurnsAslant) {
  Assembly drawn =
      Named("two", {Boxed("a", {0, 0, 0}, {1, 2, 3}), Boxed("b", {0.5, 1, 1}, {0.2, 0.3, 6})});
  drawn.groups.push_back({"turned", 0});
  drawn.parts[1].group = 1;
  Joint hinge;
  hinge.name = "hinge";
  hinge.kind = JointKind::kHinge;
  hinge.group = 1;
  hinge.center = {0.1, 0.2, 0.3};
  hinge.axis = Eigen::Vector3d::UnitZ();
  hinge.upper = 1;
  hinge.rest_poses = {{"turned", {0, 0, std::atan(1)}}};
  drawn.joints = {hinge};
  const std::vector<Element> elements = MakeElements(drawn, 1e-6);
  const std::vector<Pose> poses = PosesOf(drawn);
  ASSERT_EQ(poses.size(), 2U);
  const std::vector<Relationship> together =
      StretchTogether(poses[1], drawn, elements, {{poses[1].name, 0, 1}});
  ASSERT_EQ(together.size(), 8U);
  Eigen::VectorXd q = DrawnParameters(drawn, elements);
  const auto are_kept = [&] {
    return std::all_of(together.begin(), together.end(),
                       [&](const Relationship& one) { return std::abs(one.form.At(q)) <= 1e-12; });
  };
  EXPECT_TRUE(are_kept());
  q *= 1.7;
  EXPECT_TRUE(are_kept());
  q[SizeVariable(0, Axis::kY)] *= 1.1;
  EXPECT_FALSE(are_kept());
  EXPECT_THAT(StretchTogether(poses[0], drawn, elements, {{poses[1].name, 0, 1}}),
              ::testing::IsEmpty());
}

}  // namespace
}  // namespace mortise::parametric
