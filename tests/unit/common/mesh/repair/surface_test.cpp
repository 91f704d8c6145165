// Checks, mass properties and files of surfaces.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <set>
#include <utility>

#include "common/mesh/files/stl.h"
#include "common/mesh/files/vtu_writer.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "tests/unit/common/mesh/box_assembly.h"

namespace mortise::mesh {
namespace {

double UnitNumber(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

// A sphere of radius r by dividing an octahedron.
SurfaceMesh Sphere(double radius, int divisions) {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3i> triangles;
  const auto corner = [](int axis, int sign) {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    point[axis] = sign;
    return point;
  };
  const auto index = [&](const Eigen::Vector3d& point) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if ((points[i] - point).norm() < 1e-9) return static_cast<int>(i);
    }
    points.push_back(point);
    return static_cast<int>(points.size() - 1);
  };
  for (int octant = 0; octant < 8; ++octant) {
    const int sx = octant & 1 ? 1 : -1, sy = octant & 2 ? 1 : -1, sz = octant & 4 ? 1 : -1;
    Eigen::Vector3d a = corner(0, sx), b = corner(1, sy), c = corner(2, sz);
    if (sx * sy * sz < 0) std::swap(b, c);
    const auto grid = [&](int i, int j) {
      return index(((divisions - i - j) * a + i * b + j * c).normalized());
    };
    for (int i = 0; i < divisions; ++i) {
      for (int j = 0; i + j < divisions; ++j) {
        triangles.emplace_back(grid(i, j), grid(i + 1, j), grid(i, j + 1));
        if (i + j + 1 < divisions) {
          triangles.emplace_back(grid(i + 1, j), grid(i + 1, j + 1), grid(i, j + 1));
        }
      }
    }
  }
  SurfaceMesh sphere;
  sphere.vertices.resize(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) sphere.vertices.col(i) = radius * points[i];
  sphere.triangles.resize(3, triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) sphere.triangles.col(i) = triangles[i];
  return sphere;
}

TEST(MassProperties, OfABoxAnywhere) {
  const Eigen::Vector3d size(0.3, 0.5, 0.7), low(1000, -200, 30);
  const MassProperties mass = ComputeMassProperties(BoxSurface(low, low + size));
  EXPECT_NEAR(mass.volume, size.prod(), 1e-10);
  EXPECT_LT((mass.centroid - low - size / 2).norm(), 1e-8);
  const double v = size.prod();
  for (int k = 0; k < 3; ++k) {
    const double a = size[(k + 1) % 3], b = size[(k + 2) % 3];
    EXPECT_NEAR(mass.inertia(k, k), v * (a * a + b * b) / 12, 1e-9);
  }
}

TEST(MassProperties, OfASphereConverge) {
  const double exact = 4 * std::numbers::pi / 3;
  const double coarse = exact - ComputeMassProperties(Sphere(1, 6)).volume;
  const double fine = exact - ComputeMassProperties(Sphere(1, 12)).volume;
  EXPECT_GT(coarse, 0);
  EXPECT_NEAR(coarse / fine, 4, 0.3);
  EXPECT_NEAR(ComputeMassProperties(Sphere(1, 12)).inertia(0, 0), 0.4 * exact, 0.05);
}

TEST(MassProperties, SurfaceVolumeMeshAndSumsAgree) {
  const AssemblySurface table = TestTable();
  const auto mesh = MeshAssembly(table, {});
  ASSERT_TRUE(mesh.ok());
  std::vector<MassProperties> bodies;
  for (int p = 0; p < 9; ++p) bodies.push_back(ComputeMassProperties(PartSurface(table, p)));
  const MassProperties sum = Combine(bodies, std::vector<double>(9, 1.0));
  const MassProperties whole = ComputeMassProperties(*mesh);
  EXPECT_NEAR(sum.volume, whole.volume, 1e-12);
  EXPECT_LT((sum.centroid - whole.centroid).norm(), 1e-12);
  EXPECT_LT((sum.inertia - whole.inertia).norm(), 1e-12);
}

TEST(SurfaceChecks, NameEachFault) {
  const SurfaceMesh box = BoxSurface({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(IsWatertight(box));
  const auto kind = [](const SurfaceMesh& surface) {
    const auto faults = CheckSurface(surface, 1);
    return faults.empty() ? -1 : static_cast<int>(faults[0].kind);
  };
  SurfaceMesh broken = box;
  broken.triangles.conservativeResize(3, broken.triangles.cols() - 1);
  EXPECT_EQ(kind(broken), static_cast<int>(SurfaceFault::Kind::kOpenEdge));
  broken = box;
  std::swap(broken.triangles(0, 0), broken.triangles(1, 0));
  EXPECT_EQ(kind(broken), static_cast<int>(SurfaceFault::Kind::kFlippedEdge));
  broken = box;
  broken.triangles.conservativeResize(3, box.triangles.cols() + 1);
  broken.triangles.rightCols(1) = box.triangles.leftCols(1);
  EXPECT_EQ(kind(broken), static_cast<int>(SurfaceFault::Kind::kOvercrowded));
  EXPECT_EQ(CheckSurface(broken).size(), 3u) << "each edge once";
  broken = box;
  broken.triangles.row(0).swap(broken.triangles.row(1));
  EXPECT_EQ(kind(broken), static_cast<int>(SurfaceFault::Kind::kInsideOut));
  broken = box;
  broken.vertices.col(0) = broken.vertices.col(1);
  EXPECT_EQ(kind(broken), static_cast<int>(SurfaceFault::Kind::kDegenerate));
  broken = box;
  broken.vertices(0, 0) = NAN;
  EXPECT_EQ(kind(broken), static_cast<int>(SurfaceFault::Kind::kNotFinite));
  broken = box;
  broken.triangles(0, 0) = -3;
  EXPECT_EQ(kind(broken), static_cast<int>(SurfaceFault::Kind::kBadIndex));
  EXPECT_NE(kind(SurfaceMesh{}), -1);
}

TEST(SurfaceChecks, WindingNumberTellsInsideFromOutside) {
  const SurfaceMesh sphere = Sphere(1, 5);
  EXPECT_NEAR(WindingNumber(sphere, {0.2, -0.1, 0.3}), 1, 1e-12);
  EXPECT_NEAR(WindingNumber(sphere, {2, 0, 0.3}), 0, 1e-12);
}

TEST(Intersections, FoundOnlyWhereTheyAre) {
  EXPECT_TRUE(FindIntersections(TestTable().vertices, TestTable().triangles, 10).empty());
  const SurfaceMesh sphere = Sphere(1, 6);
  EXPECT_TRUE(FindIntersections(sphere.vertices, sphere.triangles, 10).empty());
  SurfaceMesh both;
  both.vertices.resize(3, 2 * sphere.vertices.cols());
  both.vertices << sphere.vertices, (sphere.vertices.colwise() + Eigen::Vector3d(0.9, 0.1, 0.05));
  both.triangles.resize(3, 2 * sphere.triangles.cols());
  both.triangles << sphere.triangles,
      (sphere.triangles.array() + static_cast<int>(sphere.vertices.cols())).matrix();
  const auto found = FindIntersections(both.vertices, both.triangles, 1000);
  EXPECT_GT(found.size(), 10u);
  for (const Intersection& crossing : found) EXPECT_NEAR(crossing.place.norm(), 0.98, 0.06);
}

TEST(Intersections, OverlappingTrianglesInOnePlaneCount) {
  SurfaceMesh flat;
  flat.vertices.resize(3, 6);
  flat.vertices << 0, 1, 0, 0.2, 1.2, 0.2, 0, 0, 1, 0.1, 0.1, 1.1, 0, 0, 0, 0, 0, 0;
  flat.triangles.resize(3, 2);
  flat.triangles << 0, 3, 1, 4, 2, 5;
  EXPECT_EQ(FindIntersections(flat.vertices, flat.triangles, 9).size(), 1u);
  flat.vertices.rightCols(3).row(0).array() += 2;
  EXPECT_TRUE(FindIntersections(flat.vertices, flat.triangles, 9).empty());
}

TEST(Intersections, AreTheSameAlongAnyAxis) {
  std::mt19937_64 random(8);
  SurfaceMesh soup;
  soup.vertices.resize(3, 180);
  soup.triangles.resize(3, 60);
  for (int t = 0; t < 60; ++t) {
    Eigen::Vector3d place;
    for (int axis = 0; axis < 3; ++axis) place(axis) = (3 - axis) * UnitNumber(random);
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        soup.vertices(axis, 3 * t + k) = place(axis) + 1.5 * UnitNumber(random);
      }
      soup.triangles(k, t) = 3 * t + k;
    }
  }
  const auto pairs = [&soup] {
    std::set<std::pair<int, int>> found;
    for (const Intersection& crossing : FindIntersections(soup.vertices, soup.triangles, 10'000)) {
      found.emplace(crossing.first, crossing.second);
    }
    return found;
  };
  const auto along_x = pairs();
  EXPECT_GT(along_x.size(), 20u);
  for (int turn = 0; turn < 2; ++turn) {
    soup.vertices = Eigen::Matrix3Xd(soup.vertices(std::array{1, 2, 0}, Eigen::all));
    EXPECT_EQ(pairs(), along_x);
  }
}

TEST(Intersections, CountTrianglesDrawnTwiceButNoneWithoutAnArea) {
  SurfaceMesh mesh;
  mesh.vertices.resize(3, 5);
  mesh.vertices << 0, 1, 0, 0.2, 0.4, 0, 0, 1, 0.2, 0.4, 0, 0, 0, 0, 0;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 2, 1, 1, 2, 0;
  EXPECT_EQ(FindIntersections(mesh.vertices, mesh.triangles, 9).size(), 1u);
  mesh.triangles.col(1) = Eigen::Vector3i(3, 4, 4);  // a line within the first
  EXPECT_TRUE(FindIntersections(mesh.vertices, mesh.triangles, 9).empty());
}

TEST(Files, StlHasEveryTriangle) {
  const auto stl = WriteStl(BoxSurface({0, 0, 0}, {1, 2, 3}), "box");
  ASSERT_TRUE(stl.ok());
  ASSERT_EQ(stl->size(), 84u + 50 * 12);
  std::uint32_t count = 0;
  std::memcpy(&count, stl->data() + 80, 4);
  EXPECT_EQ(count, 12u);
}

TEST(Files, VtuSaysItsSizesAndRefusesWrongFields) {
  const auto mesh = MeshAssembly(AssembleBoxes({{"a", {0, 0, 0}, {1, 1, 1}}}), {});
  ASSERT_TRUE(mesh.ok());
  VtuField field{"height <m>", mesh->nodes.row(2)};
  const auto vtu = WriteVtu(*mesh, {field});
  ASSERT_TRUE(vtu.ok()) << vtu.status();
  EXPECT_NE(vtu->find("height &lt;m&gt;"), std::string::npos);
  EXPECT_NE(vtu->find("NumberOfPoints=\"" + std::to_string(mesh->nodes.cols()) + "\""),
            std::string::npos);
  field.values.conservativeResize(1, 3);
  EXPECT_FALSE(WriteVtu(*mesh, {field}).ok());
}

TEST(Files, VtuHoldsSurfacesToo) {
  const SurfaceMesh box = BoxSurface({0, 0, 0}, {1, 2, 3});
  const VtuField pressure{"pressure", box.vertices.row(2)};
  const VtuField area{"area", Eigen::MatrixXd::Ones(1, box.triangles.cols())};
  const auto vtu = WriteVtu(box, {pressure}, {area});
  ASSERT_TRUE(vtu.ok()) << vtu.status();
  EXPECT_NE(vtu->find("NumberOfPoints=\"8\" NumberOfCells=\"12\""), std::string::npos);
  EXPECT_EQ(vtu->find("\"part\""), std::string::npos);
  // The last array tells what the cells are: twelve triangles, which VTK numbers 5.
  EXPECT_NE(vtu->find(std::string(12, '\x05') + "\n</AppendedData>"), std::string::npos);
  EXPECT_FALSE(WriteVtu(box, {area}).ok());
}

}  // namespace
}  // namespace mortise::mesh
