// Fusing parts of any shape: what touches is glued, curved or not, exactly drawn or nearly so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepPrimAPI_MakeSphere.hxx>
#include <cmath>
#include <numbers>

#include "common/base/errors.h"
#include "common/cad/stretch/solid_shape.h"
#include "tests/unit/common/cad/surface/fused_parts.h"

namespace mortise::cad {
namespace {

using std::numbers::pi;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(FusedSolids, ATurnedLegFillsItsBore) {
  const std::vector<Solid> parts = {Named(BoredSeat(), "seat"),
                                    Named(Upright(0.1, 0.1, 0, 0.43, kBore), "leg")};
  const auto surface = FuseAssembly(parts);
  ASSERT_TRUE(surface.ok()) << surface.status();
  ExpectSound(*surface, parts, 2e-3);
  const Interface wall = Between(*surface, 0, 1);
  EXPECT_GE(wall.faces, 1);
  EXPECT_NEAR(wall.area, 2 * pi * kBore * 0.03, 0.02 * wall.area);
}

TEST(FusedSolids, OnePartIsItself) {
  const std::vector<Solid> parts = {Named(BoredSeat(), "seat")};
  const auto surface = FuseAssembly(parts);
  ASSERT_TRUE(surface.ok()) << surface.status();
  ExpectSound(*surface, parts, 1e-3);
  EXPECT_EQ(surface->faces.size(), 7u);
  EXPECT_EQ(surface->faces[0].origins.size(), 1u);
}

TEST(FusedSolids, FacesThatOverlapInPartAreOneThere) {
  const std::vector<Solid> parts = {Named(BoxAt(0, 0, 0, 0.1, 0.1, 0.1), "a"),
                                    Named(BoxAt(0.05, 0.03, 0.1, 0.1, 0.1, 0.02), "b"),
                                    Named(Upright(0.05, 0.05, 0.12, 0.2, 0.02), "c")};
  const auto surface = FuseAssembly(parts);
  ASSERT_TRUE(surface.ok()) << surface.status();
  ExpectSound(*surface, parts, 2e-3);
  EXPECT_NEAR(Between(*surface, 0, 1).area, 0.05 * 0.07, 1e-12);
  EXPECT_NEAR(Between(*surface, 1, 2).area, pi * 0.02 * 0.02 / 2, 1e-5) << "half of it stands on b";
}

// Where only a line or a point touches nothing is glued, and nothing crosses.
TEST(FusedSolids, LinesAndPointsAreNoFaces) {
  const TopoDS_Shape plate = BoxAt(-0.1, -0.1, -0.02, 0.3, 0.2, 0.02);
  const TopoDS_Shape roll =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, 0.03), gp_Dir(1, 0, 0)), 0.03, 0.1).Solid();
  const TopoDS_Shape ball = BRepPrimAPI_MakeSphere(gp_Pnt(0.15, 0, 0.03), 0.03).Solid();
  for (const TopoDS_Shape& round : {roll, ball}) {
    const std::vector<Solid> parts = {Named(plate, "plate"), Named(round, "round")};
    const auto surface = FuseAssembly(parts);
    ASSERT_TRUE(surface.ok()) << surface.status();
    ExpectSound(*surface, parts, 0.01);
    EXPECT_EQ(Between(*surface, 0, 1).faces, 0);
  }
}

// Drawings miss by less than a tenth of a millimetre either way.
TEST(FusedSolids, WhatNearlyTouchesIsGlued) {
  for (const double miss : {-8e-5, -2e-5, -3e-7, 3e-7, 2e-5, 8e-5}) {
    SCOPED_TRACE(miss);
    const std::vector<Solid> blocks = {
        Named(BoxAt(0, 0, 0, 0.1, 0.1, 0.1), "below"),
        Named(BoxAt(0.02, 0.02, 0.1 + miss, 0.05, 0.2, 0.1), "above")};
    const auto stacked = FuseAssembly(blocks);
    ASSERT_TRUE(stacked.ok()) << stacked.status();
    ExpectSound(*stacked, blocks, 2e-3);
    EXPECT_NEAR(Between(*stacked, 0, 1).area, 0.05 * 0.08, 1e-4 * 0.1);

    const std::vector<Solid> standing = {Named(BoxAt(0, 0, 0.4, 0.4, 0.4, 0.03), "seat"),
                                         Named(Upright(0.1, 0.1, 0, 0.4 - miss, 0.02), "leg")};
    const auto stool = FuseAssembly(standing);
    ASSERT_TRUE(stool.ok()) << stool.status();
    ExpectSound(*stool, standing, 0.05);
    EXPECT_NEAR(Between(*stool, 0, 1).area, pi * 0.02 * 0.02, 0.05 * pi * 0.02 * 0.02);

    const std::vector<Solid> bored = {Named(BoredSeat(), "seat"),
                                      Named(Upright(0.1, 0.1, 0, 0.43, kBore - miss), "leg")};
    const auto fitted = FuseAssembly(bored);
    ASSERT_TRUE(fitted.ok()) << fitted.status();
    ExpectSound(*fitted, bored, 0.05);
    EXPECT_NEAR(Between(*fitted, 0, 1).area, 2 * pi * kBore * 0.03, 0.03 * 2 * pi * kBore * 0.03);
  }
}

TEST(FusedSolids, WhatPenetratesIsNamed) {
  const auto deep = FuseAssembly({Named(BoxAt(0, 0, 0.4, 0.4, 0.4, 0.03), "seat"),
                                  Named(BoxAt(1, 1, 1, 0.1, 0.1, 0.1), "far"),
                                  Named(Upright(0.1, 0.1, 0, 0.401, 0.02), "leg")});
  EXPECT_EQ(deep.status().code(), absl::StatusCode::kInvalidArgument) << deep.status();
  EXPECT_THAT(std::string(deep.status().message()),
              AllOf(HasSubstr("'seat' and 'leg'"), HasSubstr("mm"), Not(HasSubstr("far"))));
  const auto tight = FuseAssembly(
      {Named(BoredSeat(0.0155), "seat"), Named(Upright(0.1, 0.1, 0, 0.43, kBore), "leg")});
  EXPECT_EQ(tight.status().code(), absl::StatusCode::kInvalidArgument) << tight.status();
  const auto inside = FuseAssembly({Named(BoxAt(0, 0, 0, 0.4, 0.4, 0.3), "block"),
                                    Named(Upright(0.1, 0.1, 0.1, 0.2, kBore), "core")});
  EXPECT_THAT(std::string(inside.status().message()), HasSubstr("'block' and 'core'"));
}

// A play that triangles of the usual size would cross.
TEST(FusedSolids, NarrowPlayStaysFree) {
  for (const double play : {1.5e-4, 4e-4, 1e-3}) {
    SCOPED_TRACE(play);
    const std::vector<Solid> parts = {Named(BoredSeat(), "seat"),
                                      Named(Upright(0.1, 0.1, 0, 0.5, kBore - play), "pin")};
    const auto surface = FuseAssembly(parts);
    ASSERT_TRUE(surface.ok()) << surface.status();
    ExpectSound(*surface, parts, 2e-3);
    EXPECT_EQ(Between(*surface, 0, 1).faces, 0);
  }
}

// At other sizes bores and legs are elliptic, and still fit; faces keep their names.
TEST(FusedSolids, StretchedPartsStillFit) {
  const Solid seat = Named(BoredSeat(), "seat");
  const auto shape = ShapeOfSolid(seat, Eigen::Matrix3d::Identity(), {0, 0, 0.4}, {0.4, 0.4, 0.43});
  ASSERT_TRUE(shape.ok()) << shape.status();
  const Solid leg = Named(Upright(0.1, 0.1, 0, 0.43, kBore), "leg");
  const auto turned = ShapeOfSolid(leg, Eigen::Matrix3d::Identity(), {0.1 - kBore, 0.1 - kBore, 0},
                                   {0.1 + kBore, 0.1 + kBore, 0.43});
  ASSERT_TRUE(turned.ok()) << turned.status();
  for (const double factor : {1.0, 1.5, 0.7}) {
    SCOPED_TRACE(factor);
    const Eigen::Vector3d stretch(factor, 1, 1);
    const auto wide = SolidOfShape(*shape, stretch.cwiseProduct(shape->size), "seat");
    const auto oval = SolidOfShape(*turned, stretch.cwiseProduct(turned->size), "leg");
    ASSERT_TRUE(wide.ok() && oval.ok());
    const std::vector<Solid> parts = {MovedSolid(*wide, {0, 0, 0.4}),
                                      MovedSolid(*oval, {factor * (0.1 - kBore), 0.1 - kBore, 0})};
    const auto surface = FuseAssembly(parts);
    ASSERT_TRUE(surface.ok()) << surface.status();
    ExpectSound(*surface, parts, 5e-3);
    EXPECT_GT(Between(*surface, 0, 1).area, 0.9 * pi * 2 * std::min(1.0, factor) * kBore * 0.03);
    // As the triangles of the shape say: every face of the solid has the box and area of its
    // namesake.
    const mesh::SurfaceMesh drawn = mesh::SurfaceIn(*shape, stretch.cwiseProduct(shape->size));
    for (std::size_t f = 0; f < shape->face_names.size(); ++f) {
      Eigen::AlignedBox3d expected, found;
      for (Eigen::Index t = 0; t < drawn.triangles.cols(); ++t) {
        if (shape->triangle_face(t) != static_cast<int>(f)) continue;
        for (int k = 0; k < 3; ++k) expected.extend(drawn.vertices.col(drawn.triangles(k, t)));
      }
      for (Eigen::Index t = 0; t < surface->triangles.cols(); ++t) {
        const auto& origins =
            surface->faces[static_cast<std::size_t>(surface->triangle_face(t))].origins;
        const mesh::NamedFace name{0, shape->face_names[f].front()};
        if (std::find(origins.begin(), origins.end(), name) == origins.end()) continue;
        for (int k = 0; k < 3; ++k) {
          found.extend(surface->vertices.col(surface->triangles(k, t)));
        }
      }
      const Eigen::Vector3d shift = parts[0].CentreOfMass() - wide->CentreOfMass();
      const Eigen::Vector3d middle = stretch.cwiseProduct(shape->size) / 2 + shift;
      EXPECT_LT((expected.min() + middle - found.min()).norm(), 2e-3) << shape->face_names[f][0];
      EXPECT_LT((expected.max() + middle - found.max()).norm(), 2e-3) << shape->face_names[f][0];
    }
  }
}

// Triangles alone: flat neighbours of one face are one face again, bores and all.
TEST(FusedSolids, TrianglesAreSolidsOfFlatFaces) {
  const Solid seat = Named(BoredSeat(), "seat");
  auto shape = ShapeOfSolid(seat, Eigen::Matrix3d::Identity(), {0, 0, 0.4}, {0.4, 0.4, 0.43});
  ASSERT_TRUE(shape.ok()) << shape.status();
  shape->brep.clear();
  const auto faceted = SolidOfShape(*shape, 1.5 * shape->size, "seat");
  ASSERT_TRUE(faceted.ok()) << faceted.status();
  const double volume =
      mesh::ComputeMassProperties(mesh::SurfaceIn(*shape, 1.5 * shape->size)).volume;
  EXPECT_NEAR(faceted->Volume(), volume, 1e-9 * volume);
  const auto wall = static_cast<std::size_t>(std::count_if(
      faceted->face_names().begin(), faceted->face_names().end(), [&](const auto& name) {
        return std::count(faceted->face_names().begin(), faceted->face_names().end(), name) > 1;
      }));
  EXPECT_EQ(faceted->face_names().size(), 6 + wall) << "the box and its bore";
  EXPECT_GE(wall, 8u);
  const std::vector<Solid> parts = {*faceted, Named(BoxAt(0.1, 0.1, -0.1, 0.3, 0.3, 0.1), "block")};
  const auto surface = FuseAssembly(parts);
  ASSERT_TRUE(surface.ok()) << surface.status();
  ExpectSound(*surface, parts, 1e-9);
  EXPECT_GT(Between(*surface, 0, 1).area, 0.08);
}

TEST(FusedSolids, DamagedBytesAreAnError) {
  const Solid seat = Named(BoredSeat(), "seat");
  auto shape = ShapeOfSolid(seat, Eigen::Matrix3d::Identity(), {0, 0, 0.4}, {0.4, 0.4, 0.43});
  ASSERT_TRUE(shape.ok()) << shape.status();
  for (const std::string& bytes : {std::string("no shape"), shape->brep.substr(0, 100)}) {
    shape->brep = bytes;
    EXPECT_EQ(SolidOfShape(*shape, shape->size, "seat").status().code(),
              absl::StatusCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace mortise::cad
