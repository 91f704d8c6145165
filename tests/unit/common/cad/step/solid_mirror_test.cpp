// Which solids are their own mirror images.
#include "common/cad/step/solid_mirror.h"

#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>
#include <functional>
#include <gp_Ax1.hxx>
#include <gp_Trsf.hxx>
#include <numbers>

#include "tests/unit/common/cad/step/step_samples.h"

namespace mortise::cad {
namespace {

constexpr double kPi = std::numbers::pi;

// A bar of square section that is turned at each height, both as shares of the whole, by `turn`
// radians.
TopoDS_Shape Bar(const std::function<double(double)>& turn, double radius = 0.01) {
  constexpr int kSections = 16;
  BRepOffsetAPI_ThruSections loft(Standard_True, Standard_False, 1e-7);
  loft.CheckCompatibility(Standard_False);
  for (int i = 0; i <= kSections; ++i) {
    const double height = static_cast<double>(i) / kSections;
    BRepBuilderAPI_MakePolygon section;
    for (int corner = 0; corner < 4; ++corner) {
      const double angle = turn(height) + corner * kPi / 2;
      section.Add(gp_Pnt(radius * std::cos(angle), radius * std::sin(angle), 0.1 * height));
    }
    section.Close();
    loft.AddWire(section.Wire());
  }
  loft.Build();
  return TopExp_Explorer(loft.Shape(), TopAbs_SOLID).Current();
}

TopoDS_Shape Turned(const TopoDS_Shape& solid) {
  gp_Trsf turn;
  turn.SetRotation(gp_Ax1(gp_Pnt(0.01, 0.02, 0.03), gp_Dir(1, 2, 3)), 0.7);
  return BRepBuilderAPI_Transform(solid, turn, Standard_True).Shape();
}

TEST(OwnMirror, IsNoneOfTwistedBars) {
  // Whose corners, and the middles of whose edges and faces, are where those of a mirror image are.
  for (const double degrees : {90, 180, 360}) {
    const TopoDS_Shape bar = Bar([&](double height) { return height * degrees * kPi / 180; });
    EXPECT_FALSE(OwnMirror(bar)) << degrees;
    EXPECT_FALSE(OwnMirror(Turned(bar))) << degrees;
  }
}

TEST(OwnMirror, IsNoneOfBarsWhoseEdgesBendTwice) {
  // Straight at the ends and in the middle, turned one way below and the other way above it: as
  // point-symmetric as a mirror image, in all but where the faces run.
  for (const double bends : {1, 2, 3}) {
    const TopoDS_Shape bar =
        Bar([&](double height) { return 0.2 * std::sin(2 * kPi * bends * height) + height * kPi; });
    EXPECT_FALSE(OwnMirror(bar)) << bends;
  }
}

TEST(OwnMirror, IsFoundOfWhatHasOne) {
  const auto straight = [](double) { return 0.3; };
  const auto there_and_back = [](double height) { return 0.5 * std::sin(kPi * height); };
  const std::vector<TopoDS_Shape> solids = {Bar(straight),
                                            Bar(there_and_back),
                                            BRepPrimAPI_MakeCylinder(0.02, 0.06).Solid(),
                                            BRepPrimAPI_MakeCylinder(0.02, 0.06, 2.0).Solid(),
                                            BRepPrimAPI_MakeCone(0.03, 0.005, 0.06).Solid(),
                                            BRepPrimAPI_MakeSphere(0.02).Solid(),
                                            BRepPrimAPI_MakeTorus(0.015, 0.005).Solid(),
                                            BRepPrimAPI_MakeTorus(0.015, 0.005, 1.2).Solid()};
  for (std::size_t i = 0; i < solids.size(); ++i) {
    EXPECT_TRUE(OwnMirror(solids[i])) << i;
    EXPECT_TRUE(OwnMirror(Turned(solids[i]))) << i;
  }
}

}  // namespace
}  // namespace mortise::cad
