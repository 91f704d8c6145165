// Surfaces whose curved faces are drawn anew, and meshes of those that TetGen fails over.
#include "common/mesh/tetrahedra/surface_remesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/base/errors.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "common/mesh/tetrahedra/tetgen_process.h"

namespace mortise::mesh {
namespace {

constexpr double kRadius = 0.01, kLength = 0.15;

// A rod along z whose round face is drawn with needles from end to end, of as many points at each
// as wanted; and its two ends.
AssemblySurface Rod(int points_below, int points_above) {
  AssemblySurface rod;
  std::vector<Eigen::Vector3d> vertices{{0, 0, 0}, {0, 0, kLength}};
  const auto ring = [&vertices](int points, double z) {
    const int first = static_cast<int>(vertices.size());
    for (int i = 0; i < points; ++i) {
      const double turn = 2 * std::numbers::pi * i / points;
      vertices.emplace_back(kRadius * std::cos(turn), kRadius * std::sin(turn), z);
    }
    return first;
  };
  const int below = ring(points_below, 0);
  const int above = ring(points_above, kLength);
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> faces;
  const auto add = [&](const Eigen::Vector3i& triangle, int face) {
    triangles.push_back(triangle);
    faces.push_back(face);
  };
  for (int i = 0; i < points_below; ++i) {
    add({0, below + (i + 1) % points_below, below + i}, 0);
  }
  for (int i = 0; i < points_above; ++i) {
    add({1, above + i, above + (i + 1) % points_above}, 1);
  }
  for (int i = 0, j = 0; i < points_below || j < points_above;) {
    const int low = below + i % points_below, high = above + j % points_above;
    if (j * points_below < (i + 1) * points_above && j < points_above) {
      add({low, above + (j + 1) % points_above, high}, 2);
      ++j;
    } else {
      add({low, below + (i + 1) % points_below, high}, 2);
      ++i;
    }
  }
  rod.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t v = 0; v < vertices.size(); ++v) rod.vertices.col(v) = vertices[v];
  rod.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  rod.triangle_face.resize(static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    rod.triangles.col(t) = triangles[t];
    rod.triangle_face[t] = faces[t];
  }
  for (const char* name : {"base", "cap", "side"}) {
    rod.faces.push_back({.front_part = -1, .back_part = 0, .origins = {{0, name}}});
  }
  rod.part_interior = Eigen::Vector3d(0, 0, kLength / 2);
  rod.part_names = {"rod"};
  return rod;
}

AssemblySurface Drawn(const AssemblySurface& surface, double longest) {
  auto drawn = WithRoundTriangles(surface, longest, 0.5);
  EXPECT_TRUE(drawn.ok()) << drawn.status();
  return *std::move(drawn);
}

double AreaOf(const AssemblySurface& surface, int face) {
  double area = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    if (surface.triangle_face[t] != face) continue;
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t));
    const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, t));
    const Eigen::Vector3d c = surface.vertices.col(surface.triangles(2, t));
    area += (b - a).cross(c - a).norm() / 2;
  }
  return area;
}

// The longest edge of a face.
double LongestEdge(const AssemblySurface& surface, int face) {
  double longest = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    if (surface.triangle_face[t] != face) continue;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (surface.vertices.col(surface.triangles(k, t)) -
                                   surface.vertices.col(surface.triangles((k + 1) % 3, t)))
                                      .norm());
    }
  }
  return longest;
}

TEST(SurfaceRemesh, ReplacesNeedlesAndKeepsTheRest) {
  const AssemblySurface rod = Rod(24, 60);
  ASSERT_EQ(CheckAssembly(rod), absl::OkStatus());
  const AssemblySurface drawn = Drawn(rod, 0.1);
  EXPECT_EQ(CheckAssembly(drawn), absl::OkStatus());
  EXPECT_TRUE(FindIntersections(drawn.vertices, drawn.triangles, 1).empty());
  EXPECT_LT(LongestEdge(drawn, 2), 0.02);
  const double volume = ComputeMassProperties(PartSurface(rod, 0)).volume;
  EXPECT_NEAR(ComputeMassProperties(PartSurface(drawn, 0)).volume, volume, 0.03 * volume);
  for (const int end : {0, 1}) EXPECT_NEAR(AreaOf(drawn, end), AreaOf(rod, end), 1e-12);
  EXPECT_NEAR(AreaOf(drawn, 2), AreaOf(rod, 2), 0.03 * AreaOf(rod, 2));
  // Every point of the outlines is still there.
  for (Eigen::Index v = 0; v < rod.vertices.cols(); ++v) {
    const Eigen::Vector3d point = rod.vertices.col(v);
    EXPECT_EQ((drawn.vertices.colwise() - point).colwise().norm().minCoeff(), 0);
  }
}

TEST(SurfaceRemesh, IsTheSameEachTime) {
  const AssemblySurface rod = Rod(24, 60);
  const AssemblySurface first = Drawn(rod, 0.1);
  const AssemblySurface second = Drawn(rod, 0.1);
  EXPECT_EQ(first.vertices, second.vertices);
  EXPECT_EQ(first.triangles, second.triangles);
}

TEST(SurfaceRemesh, LeavesWhatIsPlane) {
  AssemblySurface box = Rod(4, 4);
  box.triangle_face.setZero();
  for (Eigen::Index t = 0; t < box.triangles.cols(); ++t) {
    // Each plane side is a face of its own.
    box.triangle_face[t] = static_cast<int>(t < 4 ? 0 : t < 8 ? 1 : 2 + (t - 8) / 2);
  }
  box.faces.resize(6, {.front_part = -1, .back_part = 0, .origins = {{0, "side"}}});
  const AssemblySurface drawn = Drawn(box, 0.001);
  EXPECT_EQ(drawn.triangles.cols(), box.triangles.cols());
  EXPECT_EQ(drawn.vertices.cols(), box.vertices.cols());
  for (int face = 0; face < 6; ++face) EXPECT_EQ(AreaOf(drawn, face), AreaOf(box, face));
}

TEST(SurfaceRemesh, RefusesWhatWouldTakeHours) {
  const auto refused = WithRoundTriangles(Rod(24, 60), 1e-6, 0.5);
  EXPECT_TRUE(absl::IsResourceExhausted(refused.status())) << refused.status();
}

// A surface that names points that are not there: TetGen reads what is not its own.
TEST(TetGenProcess, OutlivesACrash) {
  tetgenio input, output;
  input.firstnumber = 0;
  input.numberofpoints = 4;
  input.pointlist = new REAL[12]{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  input.numberoffacets = 1;
  input.facetlist = new tetgenio::facet[1];
  input.facetmarkerlist = new int[1]{1};
  tetgenio::init(&input.facetlist[0]);
  input.facetlist[0].numberofpolygons = 1;
  input.facetlist[0].polygonlist = new tetgenio::polygon[1];
  tetgenio::init(&input.facetlist[0].polygonlist[0]);
  input.facetlist[0].polygonlist[0].numberofvertices = 3;
  input.facetlist[0].polygonlist[0].vertexlist = new int[3]{0, 1, 400'000'000};
  const absl::Status status = RunTetGen("pzQ", 10, input, output);
  EXPECT_TRUE(absl::IsInternal(status)) << status;
  EXPECT_TRUE(MeshAssembly(Rod(12, 12), {.element_size = 0.05}).ok());
}

}  // namespace
}  // namespace mortise::mesh
