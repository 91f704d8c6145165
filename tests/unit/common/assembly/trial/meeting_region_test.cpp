// What is taken to stand as drawn does.
#include "common/assembly/trial/meeting_region.h"

#include <gtest/gtest.h>

#include <random>

#include "common/assembly/model/linear_design.h"
#include "common/mesh/repair/proximity.h"
#include "common/mesh/shapes/shape_levels.h"
#include "tests/unit/common/assembly/model/drawn_parts.h"

namespace mortise::parametric {
namespace {

using cad::BoxAt;
using cad::Upright;

constexpr double kTolerance = 1e-6;
constexpr double kSame = 1e-9;

// A board of 400 × 300 × 18 mm with a bore of 16 mm at (100, 100), and a rod through it.
class RodInBoard : public ::testing::Test {
 protected:
  RodInBoard()
      : board_(
            Drawn("board", Less(BoxAt(0, 0, 0, 0.4, 0.3, 0.018), Upright(0.1, 0.1, -1, 1, 0.008)))),
        rod_(Drawn("rod", Upright(0.1, 0.1, -0.03, 0.05, 0.008))),
        region_(board_.box, board_.shape.get(), rod_.box, rod_.shape.get(), kTolerance) {}

  // The board longer along x, its bore at `middle` and `wide`.
  StretchedPart Board(double middle, double wide) const {
    const Eigen::Vector3d size(0.7, 0.3, 0.018);
    StretchedPart board{{{0, 0, 0}, size}, size};
    board.stretch.levels[0] = {{0.092 / 0.4 - 0.5, middle - wide / 2 - 0.35},
                               {0.108 / 0.4 - 0.5, middle + wide / 2 - 0.35}};
    return board;
  }
  static StretchedPart Rod(double x, double from, double to) {
    const BoundingBox box{{x - 0.008, 0.092, from}, {x + 0.008, 0.108, to}};
    return {box, box.size()};
  }
  bool StandsAsDrawn(const StretchedPart& board, const StretchedPart& rod) const {
    return region_.StandsAsDrawn(board, rod, kSame);
  }

  const AssemblyPart board_, rod_;
  const MeetingRegion region_;
};

TEST_F(RodInBoard, StandsAsDrawnWhereverTheBoreGoesWithTheRod) {
  EXPECT_TRUE(StandsAsDrawn(Board(0.1, 0.016), Rod(0.1, -0.03, 0.05)));
  EXPECT_TRUE(StandsAsDrawn(Board(0.5, 0.016), Rod(0.5, -0.03, 0.05)));
  EXPECT_TRUE(StandsAsDrawn(Board(0.5, 0.016), Rod(0.5, -0.2, 0.02))) << "another length";
}

TEST_F(RodInBoard, IsLookedAtWhereItDoesNot) {
  EXPECT_FALSE(StandsAsDrawn(Board(0.5, 0.016), Rod(0.5001, -0.03, 0.05))) << "moved";
  EXPECT_FALSE(StandsAsDrawn(Board(0.5, 0.017), Rod(0.5, -0.03, 0.05))) << "too wide a bore";
  EXPECT_FALSE(StandsAsDrawn(Board(0.5, 0.016), Rod(0.5, 0.01, 0.05))) << "not through it";
  EXPECT_FALSE(StandsAsDrawn(Board(0.5, 0.016), Rod(0.5, 0.1, 0.2))) << "above it";
}

// A rod with a groove does not go straight on where the board is.
TEST(MeetingRegion, OfWhatIsNotStraightIsLookedAt) {
  const AssemblyPart board =
      Drawn("board", Less(BoxAt(0, 0, 0, 0.4, 0.3, 0.018), Upright(0.1, 0.1, -1, 1, 0.006)));
  const TopoDS_Shape ring =
      Less(Upright(0.1, 0.1, 0, 0.018, 0.02), Upright(0.1, 0.1, -1, 1, 0.006));
  const AssemblyPart rod = Drawn("rod", Less(Upright(0.1, 0.1, -0.03, 0.05, 0.008), ring));
  const MeetingRegion region(board.box, board.shape.get(), rod.box, rod.shape.get(), kTolerance);
  const StretchedPart as_drawn{board.box, board.box.size()};
  StretchedPart longer{rod.box, rod.box.size()};
  EXPECT_TRUE(region.StandsAsDrawn(as_drawn, longer, kSame));
  longer.box.maximum.z() += 0.05;
  longer.stretch = longer.box.size();
  EXPECT_FALSE(region.StandsAsDrawn(as_drawn, longer, kSame));
}

// The countersink of a screw goes with its head, whatever the board below is.
TEST(MeetingRegion, OfACountersunkScrewStandsAsDrawn) {
  const auto screw = [](double larger) {
    const TopoDS_Shape head = BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(0.1, 0.1, 0.015), gp_Dir(0, 0, 1)),
                                                   0.003 + larger, 0.006 + larger, 0.003)
                                  .Solid();
    return BRepAlgoAPI_Fuse(Upright(0.1, 0.1, -0.03, 0.0151, 0.003 + larger), head).Shape();
  };
  const AssemblyPart board = Drawn("board", Less(BoxAt(0, 0, 0, 0.4, 0.3, 0.018), screw(0.0002)));
  const AssemblyPart fastener = Drawn("screw", screw(0));
  const MeetingRegion region(board.box, board.shape.get(), fastener.box, fastener.shape.get(),
                             kTolerance);
  const auto thick = [&](double from, double level) {
    StretchedPart stretched{board.box, {}};
    stretched.box.minimum.z() = from;
    stretched.stretch = stretched.box.size();
    const double middle = (from + 0.018) / 2;
    stretched.stretch.levels[2] = {{0.015 / 0.018 - 0.5, level - middle}};
    return stretched;
  };
  const StretchedPart as_drawn{fastener.box, fastener.box.size()};
  EXPECT_TRUE(region.StandsAsDrawn(thick(-0.02, 0.015), as_drawn, kSame));
  EXPECT_TRUE(region.StandsAsDrawn(thick(0.01, 0.015), as_drawn, kSame));
  EXPECT_FALSE(region.StandsAsDrawn(thick(-0.02, 0.016), as_drawn, kSame)) << "not as deep";
  EXPECT_FALSE(region.StandsAsDrawn(thick(-0.04, 0.015), as_drawn, kSame)) << "beyond its point";
}

// A peg of 80 mm in a blind bore that is as deep as it reaches into the board.
TEST(MeetingRegion, OfAPegInABlindBoreStandsAsDrawn) {
  const TopoDS_Shape bore = RodAlong(gp_Dir(0, 1, 0), gp_Pnt(0.1, -0.066, 0.05), 0.006, 0.08);
  const AssemblyPart board = Drawn("board", Less(BoxAt(0, 0, 0, 0.3, 0.019, 0.09), bore));
  const AssemblyPart peg = Drawn("peg", bore);
  const MeetingRegion region(board.box, board.shape.get(), peg.box, peg.shape.get(), kTolerance);
  const StretchedPart as_drawn{board.box, board.box.size()};
  const auto peg_from_to = [&](double from, double to) {
    StretchedPart stretched{peg.box, {}};
    stretched.box.minimum.y() = from;
    stretched.box.maximum.y() = to;
    stretched.stretch = stretched.box.size();
    return stretched;
  };
  EXPECT_TRUE(region.StandsAsDrawn(as_drawn, peg_from_to(-0.03, 0.014), kSame));
  EXPECT_FALSE(region.StandsAsDrawn(as_drawn, peg_from_to(-0.066, 0.015), kSame)) << "into wood";
  EXPECT_FALSE(region.StandsAsDrawn(as_drawn, peg_from_to(-0.066, 0.013), kSame)) << "not at it";
}

// A pin through a tube reaches beyond it, however long it is.
TEST(MeetingRegion, OfAPinThroughATubeStandsAsDrawn) {
  const TopoDS_Shape bore = RodAlong(gp_Dir(0, 1, 0), gp_Pnt(0.1, -0.1, 0), 0.004, 0.2);
  const TopoDS_Shape tube = Less(RodAlong(gp_Dir(1, 0, 0), gp_Pnt(0, 0, 0), 0.015, 0.3),
                                 RodAlong(gp_Dir(1, 0, 0), gp_Pnt(-1, 0, 0), 0.013, 2));
  const AssemblyPart bored = Drawn("tube", Less(tube, bore));
  const AssemblyPart pin =
      Drawn("pin", RodAlong(gp_Dir(0, 1, 0), gp_Pnt(0.1, -0.02, 0), 0.004, 0.04));
  const MeetingRegion region(bored.box, bored.shape.get(), pin.box, pin.shape.get(), kTolerance);
  const StretchedPart as_drawn{bored.box, bored.box.size()};
  const auto pin_to = [&](double end) {
    StretchedPart stretched{pin.box, {}};
    stretched.box.maximum.y() = end;
    stretched.stretch = stretched.box.size();
    return stretched;
  };
  EXPECT_TRUE(region.StandsAsDrawn(as_drawn, pin_to(0.05), kSame));
  EXPECT_TRUE(region.StandsAsDrawn(as_drawn, pin_to(0.016), kSame));
  EXPECT_FALSE(region.StandsAsDrawn(as_drawn, pin_to(0.01), kSame)) << "it ends in the tube";
}

TEST(MeetingRegion, IsNoneBetweenWhatIsApart) {
  const BoundingBox one{{0, 0, 0}, {1, 1, 1}}, other{{2, 0, 0}, {3, 1, 1}};
  const MeetingRegion region(one, nullptr, other, nullptr, kTolerance);
  EXPECT_FALSE(region.StandsAsDrawn({one, one.size()}, {other, other.size()}, kSame));
}

// Whatever is done to a rod and its board: what is said to stand as drawn is neither apart nor in
// each other by more than as drawn.
TEST_F(RodInBoard, IsRightAboutRandomStretches) {
  std::mt19937_64 random(7);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const mesh::DrawnShape divided =
      mesh::DividedAt(*board_.shape, {{0, 0.092 / 0.4 - 0.5, true}, {0, 0.108 / 0.4 - 0.5, true}});
  const double missed = 2 * mesh::DeflectionIn(*board_.shape, board_.box.size());
  int stand = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const double middle = between(0.05, 0.65);
    const StretchedPart board = Board(middle, trial % 3 == 0 ? 0.02 : 0.016);
    const double from = between(-0.05, 0.03);
    const StretchedPart rod =
        Rod(middle + (trial % 4 == 0 ? between(-0.02, 0.02) : 0), from, from + between(0.001, 0.1));
    if (!StandsAsDrawn(board, rod)) continue;
    ++stand;
    const mesh::ProbedSurface a(SurfaceIn(divided, board.box.center(), board.stretch));
    const mesh::ProbedSurface b(SurfaceIn(*rod_.shape, rod.box.center(), rod.stretch));
    EXPECT_NEAR(mesh::ProbedSurface::Separation(a, b, 1), 0, missed);
  }
  EXPECT_GE(stand, 10);
}

}  // namespace
}  // namespace mortise::parametric
