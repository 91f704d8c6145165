// Fits that are loose, and round parts that keep their section although triangles cut it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <cmath>
#include <numbers>

#include "common/base/errors.h"
#include "common/cad/faceted_solid.h"
#include "tests/unit/common/cad/surface/fused_parts.h"

namespace mortise::cad {
namespace {

using std::numbers::pi;
using ::testing::AllOf;
using ::testing::HasSubstr;

// A leg of 25 mm radius with a tenon in the bore of the seat, whose shoulder bears on the seat.
TopoDS_Shape LegWithTenon(double tenon) {
  return BRepAlgoAPI_Fuse(Upright(0.1, 0.1, 0, 0.4, 0.025), Upright(0.1, 0.1, 0.3, 0.43, tenon))
      .Shape();
}

// A block with a bore that does not go through it.
TopoDS_Shape BlindBored() {
  return BRepAlgoAPI_Cut(BoxAt(0, 0, 0, 0.2, 0.2, 0.1), Upright(0.1, 0.1, 0.04, 0.2, kBore))
      .Shape();
}

TEST(LooseFits, ATenonWithPlayStaysFreeAboveItsShoulder) {
  for (const double play : {1.5e-4, 2e-4, 5e-4}) {
    SCOPED_TRACE(play);
    const std::vector<Solid> parts = {Named(BoredSeat(), "seat"),
                                      Named(LegWithTenon(kBore - play), "leg")};
    const auto surface = FuseAssembly(parts);
    ASSERT_TRUE(surface.ok()) << surface.status();
    ExpectSound(*surface, parts, 2e-3);
    const double shoulder = pi * (0.025 * 0.025 - kBore * kBore);
    EXPECT_NEAR(Between(*surface, 0, 1).area, shoulder, 0.01 * shoulder);
  }
}

TEST(LooseFits, APinStandsFreeOnTheBottomOfItsBore) {
  for (const double play : {1.5e-4, 2e-4, 5e-4}) {
    SCOPED_TRACE(play);
    const double radius = kBore - play;
    const std::vector<Solid> parts = {Named(BlindBored(), "block"),
                                      Named(Upright(0.1, 0.1, 0.04, 0.25, radius), "pin")};
    const auto surface = FuseAssembly(parts);
    ASSERT_TRUE(surface.ok()) << surface.status();
    ExpectSound(*surface, parts, 2e-3);
    EXPECT_NEAR(Between(*surface, 0, 1).area, pi * radius * radius, 0.01 * pi * radius * radius);
  }
}

// Less play than a tenth of a millimetre is none.
TEST(LooseFits, ATenonThatNearlyFitsIsGlued) {
  const double play = 5e-5;
  const double wall = 2 * pi * kBore * 0.03;
  const std::vector<Solid> parts = {Named(BoredSeat(), "seat"),
                                    Named(LegWithTenon(kBore - play), "leg")};
  const auto surface = FuseAssembly(parts);
  ASSERT_TRUE(surface.ok()) << surface.status();
  ExpectSound(*surface, parts, 0.01);
  EXPECT_NEAR(Between(*surface, 0, 1).area, wall + pi * (0.025 * 0.025 - kBore * kBore),
              0.03 * wall);
  const std::vector<Solid> blind = {Named(BlindBored(), "block"),
                                    Named(Upright(0.1, 0.1, 0.04, 0.25, kBore - play), "pin")};
  const auto standing = FuseAssembly(blind);
  ASSERT_TRUE(standing.ok()) << standing.status();
  ExpectSound(*standing, blind, 0.01);
  EXPECT_NEAR(Between(*standing, 0, 1).area, 2 * pi * kBore * 0.06 + pi * kBore * kBore,
              0.03 * 2 * pi * kBore * 0.06);
}

// A block set back a twentieth of a millimetre from the edge of another is no gap.
TEST(LooseFits, WhatIsSetOffSidewaysIsNoGap) {
  const std::vector<Solid> parts = {Named(BoxAt(0, 0, 0, 0.1, 0.1, 0.05), "below"),
                                    Named(BoxAt(5e-5, 0.01, 0.05, 0.05, 0.05, 0.05), "above"),
                                    Named(Upright(0.08, 0.02, 0.05, 0.3, 0.01), "rod"),
                                    Named(Upright(0.08, 0.02, 0.3, 0.4, 0.01005), "knob")};
  const auto surface = FuseAssembly(parts);
  ASSERT_TRUE(surface.ok()) << surface.status();
  ExpectSound(*surface, parts, 2e-3);
  EXPECT_NEAR(Between(*surface, 0, 1).area, 0.05 * 0.05, 1e-9);
}

// What nearly touches in one place takes no more from thin parts elsewhere than it must.
TEST(LooseFits, OneNearMissDoesNotSwallowThinParts) {
  const std::vector<Solid> parts = {Named(BoxAt(0, 0, 0, 0.1, 0.1, 0.1), "below"),
                                    Named(BoxAt(0, 0, 0.100004, 0.1, 0.1, 0.1), "above"),
                                    Named(BoxAt(0.2, 0, 0, 0.01, 0.01, 0.01), "anvil"),
                                    Named(BoxAt(0.2, 0, 0.01, 0.01, 0.01, 8e-5), "foil")};
  const auto surface = FuseAssembly(parts);
  ASSERT_TRUE(surface.ok()) << surface.status();
  ExpectSound(*surface, parts, 1e-4);
  EXPECT_NEAR(Between(*surface, 0, 1).area, 0.01, 1e-6);
  EXPECT_NEAR(Between(*surface, 2, 3).area, 1e-4, 1e-9);
}

TEST(LooseFits, EveryPenetrationIsNamed) {
  std::vector<Solid> parts = {Named(BoxAt(0, 0, 0, 1, 1, 0.02), "board")};
  for (int i = 0; i < 6; ++i) {
    parts.push_back(Named(Upright(0.1 + 0.15 * i, 0.5, 0.01, 0.1, 0.01), absl::StrCat("peg", i)));
  }
  const std::string message(FuseAssembly(parts).status().message());
  EXPECT_THAT(message, AllOf(HasSubstr("'board' and 'peg0' penetrate"), HasSubstr("'peg3'"),
                             Not(HasSubstr("'peg4'")), HasSubstr("and 2 more pairs")));
}

// A ball that lies in the mouth of a bore touches its rim only.
TEST(LooseFits, ABallOnTheRimOfABoreSharesItsPoints) {
  const double above = std::sqrt(0.02 * 0.02 - kBore * kBore);
  const std::vector<Solid> parts = {
      Named(BoredSeat(), "seat"),
      Named(BRepPrimAPI_MakeSphere(gp_Pnt(0.1, 0.1, 0.43 + above), 0.02).Solid(), "ball")};
  const auto surface = FuseAssembly(parts);
  ASSERT_TRUE(surface.ok()) << surface.status();
  ExpectSound(*surface, parts, 0.01);
  EXPECT_EQ(Between(*surface, 0, 1).faces, 0);
}

// The ball stands where the two triangles of the plate meet.
TEST(LooseFits, ABallMayStandOnTheSideOfATriangle) {
  const std::vector<Solid> parts = {
      Named(BoxAt(-0.1, -0.05, -0.02, 0.2, 0.1, 0.02), "plate"),
      Named(BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 0.03), 0.03).Solid(), "ball")};
  const auto surface = FuseAssembly(parts);
  ASSERT_TRUE(surface.ok()) << surface.status();
  ExpectSound(*surface, parts, 0.01);
  for (const auto& corners : surface->triangles.colwise()) {
    const Eigen::Vector3d a = surface->vertices.col(corners(0));
    const double area =
        (surface->vertices.col(corners(1)) - a).cross(surface->vertices.col(corners(2)) - a).norm();
    EXPECT_GT(area, 1e-9);
  }
}

// What is round has its volume and its second moments although it has few facets.
TEST(RoundParts, KeepTheirSection) {
  struct Round {
    std::string name;
    TopoDS_Shape shape;
    double volume = 0;  // m³
  };
  const double r = 0.015, length = 0.7;
  const std::vector<Round> rounds = {
      {"leg", Upright(0, 0, 0, length, r), pi * r * r * length},
      {"tube", BRepAlgoAPI_Cut(Upright(0, 0, 0, length, r), Upright(0, 0, -1, 2, 0.8 * r)).Shape(),
       pi * r * r * length * 0.36},
      {"taper", BRepPrimAPI_MakeCone(r, 0.6 * r, length).Solid(),
       pi * length / 3 * r * r * (1 + 0.6 + 0.36)},
      {"point", BRepPrimAPI_MakeCone(r, 0, length).Solid(), pi * length / 3 * r * r},
      {"ball", BRepPrimAPI_MakeSphere(r).Solid(), 4 * pi / 3 * r * r * r},
      {"ring", BRepPrimAPI_MakeTorus(4 * r, r).Solid(), 8 * pi * pi * r * r * r}};
  for (const Round& round : rounds) {
    SCOPED_TRACE(round.name);
    const std::vector<Solid> parts = {Named(round.shape, round.name)};
    const auto surface = FuseAssembly(parts);
    ASSERT_TRUE(surface.ok()) << surface.status();
    EXPECT_NEAR(VolumeOf(*surface, 0), round.volume, 2e-3 * round.volume);
    EXPECT_TRUE(mesh::FindIntersections(surface->vertices, surface->triangles).empty());
    if (round.name != "leg" && round.name != "tube") continue;
    // A prism's inertia about its axis is its length times the section's polar moment.
    const double polar = mesh::ComputeMassProperties(mesh::PartSurface(*surface, 0)).inertia(2, 2);
    const double inner = round.name == "leg" ? 0 : 0.8 * r;
    const double exact = pi / 2 * (std::pow(r, 4) - std::pow(inner, 4)) * length;
    EXPECT_NEAR(polar, exact, 3e-3 * exact);
    EXPECT_LT(surface->triangles.cols(), 250) << "by few facets";
  }
}

// Bores beside each other with a wall thinner than what chords cut off, and a wall round a bore
// that is thinner still: points that would cross it stay.
TEST(RoundParts, MoveNoTrianglesIntoEachOther) {
  for (const double wall : {6e-4, 3e-4, 1.5e-4}) {
    SCOPED_TRACE(wall);
    const double apart = 2 * kBore + wall;
    const TopoDS_Shape plate = BRepAlgoAPI_Cut(BRepAlgoAPI_Cut(BoxAt(0, 0, 0, 0.2, 0.2, 0.03),
                                                               Upright(0.07, 0.1, -1, 1, kBore))
                                                   .Shape(),
                                               Upright(0.07 + apart, 0.1, -1, 1, kBore))
                                   .Shape();
    const TopoDS_Shape edge = BRepAlgoAPI_Cut(BoxAt(0.1 - kBore - wall, 0, 0.03, 0.2, 0.2, 0.03),
                                              Upright(0.1, 0.1, -1, 1, kBore))
                                  .Shape();
    const std::vector<Solid> parts = {Named(plate, "plate"), Named(edge, "edge")};
    const auto surface = FuseAssembly(parts);
    ASSERT_TRUE(surface.ok()) << surface.status();
    ExpectSound(*surface, parts, 2e-3);
  }
}

mesh::SurfaceMesh Tetrahedron(double size) {
  mesh::SurfaceMesh surface;
  surface.vertices = size * Eigen::Matrix3Xd::Identity(3, 4);
  surface.triangles.resize(3, 4);
  surface.triangles << 0, 0, 1, 0, 1, 3, 3, 2, 2, 1, 2, 3;
  return surface;
}

TEST(FacetedSolid, RefusesWhatBoundsNoSolid) {
  const Eigen::VectorXi faces = Eigen::VectorXi::Zero(4);
  EXPECT_TRUE(FacetedSolid(Tetrahedron(0.1), faces, {"side"}, "piece").ok());
  mesh::SurfaceMesh open = Tetrahedron(0.1);
  open.triangles.conservativeResize(3, 3);
  const absl::Status torn = FacetedSolid(open, faces.head(3), {"side"}, "piece").status();
  EXPECT_EQ(DetailOf(torn).field, "shape");
  EXPECT_THAT(std::string(torn.message()), HasSubstr("open"));
  mesh::SurfaceMesh sharp = Tetrahedron(0.1);
  sharp.vertices.col(3) = sharp.vertices.col(0) + Eigen::Vector3d(0, 0, 5e-8);
  const absl::Status tiny = FacetedSolid(sharp, faces, {"side"}, "piece").status();
  EXPECT_EQ(DetailOf(tiny).field, "shape");
  EXPECT_THAT(std::string(tiny.message()), AllOf(HasSubstr("edge"), HasSubstr("100")));
}

}  // namespace
}  // namespace mortise::cad
