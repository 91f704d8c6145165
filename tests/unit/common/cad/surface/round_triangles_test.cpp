// What is round gets triangles that are about as wide as they are high, for elements of some size.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <tuple>

#include "common/base/errors.h"
#include "common/base/process.h"
#include "common/cad/surface/gmsh_mesh.h"
#include "tests/support/environment.h"
#include "tests/support/replaced_program.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/common/cad/surface/fused_parts.h"

namespace mortise::cad {
namespace {

using std::numbers::pi;
using ::testing::HasSubstr;

struct Shape {
  std::string name;
  std::vector<Solid> parts;
  double element_size = 0;  // m
};

TopoDS_Shape RoundedBar() {
  const TopoDS_Shape bar = BoxAt(0, 0, 0, 0.04, 0.03, 0.5);
  BRepFilletAPI_MakeFillet round(bar);
  for (TopExp_Explorer edge(bar, TopAbs_EDGE); edge.More(); edge.Next()) {
    round.Add(0.004, TopoDS::Edge(edge.Current()));
  }
  return round.Shape();
}

std::vector<Shape> Shapes() {
  return {
      {"rod", {Named(Upright(0, 0, 0, 1, 0.01), "rod")}, 0.08},
      {"ball", {Named(BRepPrimAPI_MakeSphere(0.05).Solid(), "ball")}, 0.03},
      {"half_a_ball", {Named(BRepPrimAPI_MakeSphere(0.05, 0, pi / 2).Solid(), "half")}, 0.03},
      {"cone", {Named(BRepPrimAPI_MakeCone(0.03, 0, 0.1).Solid(), "cone")}, 0.03},
      {"ring", {Named(BRepPrimAPI_MakeTorus(0.05, 0.01).Solid(), "ring")}, 0.03},
      {"rounded_bar", {Named(RoundedBar(), "bar")}, 0.05},
      {"leg_in_a_seat",
       {Named(BoredSeat(), "seat"), Named(Upright(0.1, 0.1, 0, 0.43, kBore), "leg")},
       0.06},
  };
}

class RoundTrianglesTest : public ::testing::TestWithParam<Shape> {};

// The longest side of a triangle over its height.
double SlimmestOf(const mesh::AssemblySurface& surface) {
  double slimmest = 0;
  for (const auto& corners : surface.triangles.colwise()) {
    const Eigen::Vector3d a = surface.vertices.col(corners(0)),
                          b = surface.vertices.col(corners(1)),
                          c = surface.vertices.col(corners(2));
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    slimmest = std::max(slimmest, longest * longest / (b - a).cross(c - a).norm());
  }
  return slimmest;
}

double LongestEdgeOf(const mesh::AssemblySurface& surface) {
  double longest = 0;
  for (const auto& corners : surface.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      longest = std::max(
          longest,
          (surface.vertices.col(corners(k)) - surface.vertices.col(corners((k + 1) % 3))).norm());
    }
  }
  return longest;
}

TEST_P(RoundTrianglesTest, AreSoundAndNoNeedles) {
  const Shape& shape = GetParam();
  const auto surface = FuseAssembly(shape.parts, {.element_size = shape.element_size});
  ASSERT_TRUE(surface.ok()) << surface.status();
  ExpectSound(*surface, shape.parts, 5e-3);
  EXPECT_LT(SlimmestOf(*surface), 8);
  EXPECT_LT(LongestEdgeOf(*surface), 2 * shape.element_size);
}

TEST_P(RoundTrianglesTest, AreTheSameEachTime) {
  const Shape& shape = GetParam();
  const auto first = FuseAssembly(shape.parts, {.element_size = shape.element_size});
  const auto second = FuseAssembly(shape.parts, {.element_size = shape.element_size});
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(first->vertices, second->vertices);
  EXPECT_EQ(first->triangles, second->triangles);
}

// The volume within the parabolas through exact vertices and middles, by a rule that is exact.
double ExactlyDrawnVolume(const mesh::AssemblySurface& surface, int part) {
  constexpr double kNear = 0.816847572980459, kFar = 0.108103018168070;
  double volume = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const mesh::AssemblyFace& face =
        surface.faces[static_cast<std::size_t>(surface.triangle_face(t))];
    const int side = face.back_part == part ? 1 : face.front_part == part ? -1 : 0;
    if (side == 0) continue;
    Eigen::Matrix<double, 3, 6> places;
    for (int k = 0; k < 3; ++k) {
      places.col(k) = surface.exact->vertices.col(surface.triangles(k, t));
      places.col(3 + k) = surface.exact->middles.col(3 * t + k);
    }
    for (const auto& [own, other, weight] : {std::tuple(kNear, (1 - kNear) / 2, 0.109951743655322),
                                             std::tuple(kFar, (1 - kFar) / 2, 0.223381589678011)}) {
      for (int k = 0; k < 3; ++k) {
        Eigen::Vector3d l = Eigen::Vector3d::Constant(other);
        l(k) = own;
        Eigen::Matrix<double, 6, 1> shape;
        Eigen::Matrix<double, 6, 3> along = Eigen::Matrix<double, 6, 3>::Zero();
        for (int i = 0; i < 3; ++i) {
          const int next = (i + 1) % 3;
          shape(i) = l(i) * (2 * l(i) - 1);
          shape(3 + i) = 4 * l(i) * l(next);
          along(i, i) = 4 * l(i) - 1;
          along(3 + i, i) = 4 * l(next);
          along(3 + i, next) = 4 * l(i);
        }
        const Eigen::Vector3d place = places * shape;
        const Eigen::Vector3d first = places * (along.col(1) - along.col(0));
        const Eigen::Vector3d second = places * (along.col(2) - along.col(0));
        volume += side * weight / 2 * place.dot(first.cross(second)) / 3;
      }
    }
  }
  return volume;
}

double DistanceTo(const TopoDS_Shape& shape, const Eigen::Vector3d& place) {
  const TopoDS_Vertex vertex =
      BRepBuilderAPI_MakeVertex(gp_Pnt(place.x(), place.y(), place.z())).Vertex();
  double least = 1;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    least = std::min(least, BRepExtrema_DistShapeShape(vertex, face.Current()).Value());
  }
  return least;
}

TEST_P(RoundTrianglesTest, KnowWhereTheirSidesAreOnTheFaces) {
  const Shape& shape = GetParam();
  for (const std::optional<double> size :
       {std::optional(shape.element_size), std::optional<double>()}) {
    const auto surface = FuseAssembly(shape.parts, {.element_size = size});
    ASSERT_TRUE(surface.ok()) << surface.status();
    ASSERT_TRUE(surface->exact.has_value());
    for (std::size_t i = 0; i < shape.parts.size(); ++i) {
      const double volume = shape.parts[i].Volume();
      EXPECT_NEAR(ExactlyDrawnVolume(*surface, static_cast<int>(i)), volume, 1e-3 * volume);
    }
    // Every tenth, as the kernel takes its time to tell.
    for (Eigen::Index i = 0; i < surface->exact->middles.cols(); i += 10) {
      const auto middle = surface->exact->middles.col(i);
      double distance = 1;
      for (const Solid& part : shape.parts) {
        distance = std::min(distance, DistanceTo(part.kernel().shape, middle));
      }
      EXPECT_LT(distance, 1e-7) << "at " << middle.transpose();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, RoundTrianglesTest, ::testing::ValuesIn(Shapes()),
                         [](const auto& shape) { return shape.param.name; });

TEST(RoundTriangles, ShareWhatTouchesAndKnowTheirFaces) {
  const std::vector<Solid> parts = {Named(BoredSeat(), "seat"),
                                    Named(Upright(0.1, 0.1, 0, 0.43, kBore), "leg")};
  const auto drawn = FuseAssembly(parts);
  const auto round = FuseAssembly(parts, {.element_size = 0.05});
  ASSERT_TRUE(drawn.ok() && round.ok());
  EXPECT_NEAR(Between(*round, 0, 1).area, 2 * pi * kBore * 0.03, 0.02 * Between(*round, 0, 1).area);
  ASSERT_EQ(round->faces.size(), drawn->faces.size());
  for (std::size_t f = 0; f < drawn->faces.size(); ++f) {
    EXPECT_EQ(round->faces[f].origins, drawn->faces[f].origins);
    const auto mean = [&](const mesh::AssemblySurface& surface) {
      Eigen::Vector3d moment = Eigen::Vector3d::Zero();
      double area = 0;
      for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
        if (surface.triangle_face(t) != static_cast<int>(f)) continue;
        const Eigen::Vector3i corners = surface.triangles.col(t);
        const Eigen::Vector3d a = surface.vertices.col(corners(0)),
                              b = surface.vertices.col(corners(1)),
                              c = surface.vertices.col(corners(2));
        const double twice = (b - a).cross(c - a).norm();
        moment += twice * (a + b + c) / 3;
        area += twice;
      }
      return Eigen::Vector3d(moment / area);
    };
    EXPECT_LT((mean(*round) - mean(*drawn)).norm(), 2e-4) << "face " << f;
  }
}

TEST(RoundTriangles, GrowWithTheElements) {
  const std::vector<Solid> ball = {Named(BRepPrimAPI_MakeSphere(0.05).Solid(), "ball")};
  const auto count = [&](double size) {
    const auto surface = FuseAssembly(ball, {.element_size = size});
    EXPECT_TRUE(surface.ok()) << surface.status();
    return static_cast<double>(surface->triangles.cols());
  };
  const double fine = count(0.005), coarse = count(0.01);
  EXPECT_NEAR(fine / coarse, 4, 1);
  EXPECT_NEAR(fine * std::sqrt(3) / 4 * 0.005 * 0.005, 4 * pi * 0.05 * 0.05, 0.3 * 4 * pi * 0.0025);
}

TEST(RoundTriangles, AreTheSameWhateverSettingsAreAtHome) {
  const std::vector<Solid> rod = {Named(Upright(0, 0, 0, 1, 0.01), "rod")};
  const auto before = FuseAssembly(rod, {.element_size = 0.08});
  const testing::TemporaryFolder home;
  std::ofstream(home.path() / ".gmshrc") << "Mesh.Algorithm = 1;\nMesh.MeshSizeFactor = 0.5;\n";
  const testing::Environment at_home("HOME", home.path());
  const auto after = FuseAssembly(rod, {.element_size = 0.08});
  ASSERT_TRUE(before.ok() && after.ok());
  EXPECT_EQ(after->vertices, before->vertices);
}

TEST(RoundTriangles, NeedGmsh) {
  const testing::ReplacedProgram none("gmsh", "");
  const std::vector<Solid> rod = {Named(Upright(0, 0, 0, 1, 0.01), "rod")};
  const absl::Status status = FuseAssembly(rod, {.element_size = 0.08}).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(status)) << status;
  EXPECT_EQ(DetailOf(status).reason, "NO_GMSH");
  EXPECT_THAT(status.message(), HasSubstr("install Debian's package 'gmsh'"));
  EXPECT_TRUE(FuseAssembly(rod).ok()) << "that draws with the kernel";
  const std::vector<Solid> box = {Named(BoxAt(0, 0, 0, 1, 1, 1), "box")};
  EXPECT_TRUE(FuseAssembly(box, {.element_size = 0.1}).ok()) << "nothing of it is round";
}

// A radius of a fraction of a millimetre at all edges of a large board would make small triangles
// all over it.
TEST(RoundTriangles, AreNotDrawnWhereEdgesAreOnlyJustBroken) {
  const TopoDS_Shape board = BoxAt(0, 0, 0, 1, 0.5, 0.02);
  BRepFilletAPI_MakeFillet broken(board);
  for (TopExp_Explorer edge(board, TopAbs_EDGE); edge.More(); edge.Next()) {
    broken.Add(3e-4, TopoDS::Edge(edge.Current()));
  }
  const std::vector<Solid> parts = {Named(broken.Shape(), "board")};
  const auto drawn = FuseAssembly(parts);
  const auto surface = FuseAssembly(parts, {.element_size = 0.08});
  ASSERT_TRUE(drawn.ok() && surface.ok());
  EXPECT_EQ(surface->triangles, drawn->triangles);
}

// A mesh of such elements is refused; to draw its triangles would take hours.
TEST(RoundTriangles, AreNotDrawnBeyondAllMeasure) {
  const std::vector<Solid> rod = {Named(Upright(0, 0, 0, 1, 0.01), "rod")};
  const auto drawn = FuseAssembly(rod);
  const auto surface = FuseAssembly(rod, {.element_size = 1e-5});
  ASSERT_TRUE(drawn.ok() && surface.ok());
  EXPECT_EQ(surface->triangles, drawn->triangles);
}

// The kernel's triangles are worse, but can mostly be meshed.
TEST(RoundTriangles, GiveWayToTheKernelsWhereGmshFails) {
  const std::vector<Solid> rod = {Named(Upright(0, 0, 0, 1, 0.01), "rod")};
  const auto drawn = FuseAssembly(rod);
  ASSERT_TRUE(drawn.ok()) << drawn.status();
  for (const std::string script : {
           "exit 1",
           "kill -SEGV $$",
           "exit 0",
           "for last; do :; done; echo rubbish > $last",
           "for last; do :; done; printf '$ParametricNodes\\n3\\n1 0 0\\n' > $last",
           "for last; do :; done; printf '$Elements\\n1\\n1 2 2 0 1 1 2 3\\n' > $last",
       }) {
    SCOPED_TRACE(script);
    const testing::ReplacedProgram other("gmsh", script);
    const auto surface = FuseAssembly(rod, {.element_size = 0.08});
    ASSERT_TRUE(surface.ok()) << surface.status();
    EXPECT_EQ(surface->vertices, drawn->vertices);
    EXPECT_EQ(surface->triangles, drawn->triangles);
  }
}

// It may take a minute, not for ever; what it started goes with it.
TEST(RoundTriangles, AreGivenUpWhereGmshComesToNoEnd) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path started = folder.path() / "started";
  const testing::ReplacedProgram other("gmsh",
                                       "echo $$ > " + started.string() + "; /bin/sleep 1000");
  const TopoDS_Shape rod = Upright(0, 0, 0, 1, 0.01);
  std::vector<TopoDS_Face> faces;
  for (TopExp_Explorer face(rod, TopAbs_FACE); face.More(); face.Next()) {
    faces.push_back(TopoDS::Face(face.Current()));
  }
  const absl::Status status =
      MeshWithGmsh(faces, std::vector<double>(faces.size(), 0.01), std::chrono::seconds(1))
          .status();
  EXPECT_TRUE(absl::IsInternal(status)) << status;
  EXPECT_THAT(status.message(), HasSubstr("Gmsh came to no end"));
  pid_t gmsh = 0;
  std::ifstream(started) >> gmsh;
  ASSERT_GT(gmsh, 0);
  EXPECT_FALSE(ProcessExists(gmsh));
}

}  // namespace
}  // namespace mortise::cad
