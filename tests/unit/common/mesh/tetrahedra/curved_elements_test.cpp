// Quadratic elements that follow the faces behind the triangles they were drawn with.
#include "common/mesh/tetrahedra/curved_elements.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/mesh/element_faces.h"
#include "common/mesh/surface_check.h"
#include "common/mesh/tetrahedra/mesher.h"

namespace mortise::mesh {
namespace {

constexpr double kRadius = 0.01, kLength = 0.03;
constexpr int kFaceRound = 2;

// A rod along z of `facets` flat sides, whose corners lie on a circle `outward` m outside the
// rod's, and whose sides know the circle.
AssemblySurface Rod(int facets, double outward = 0) {
  const Eigen::Index n = facets;
  AssemblySurface rod;
  const auto place = [facets](double step, double radius, double z) {
    const double turn = 2 * std::numbers::pi * step / facets;
    return Eigen::Vector3d(radius * std::cos(turn), radius * std::sin(turn), z);
  };
  rod.vertices.resize(3, 2 * n + 2);
  rod.exact.emplace();
  rod.exact->vertices.resize(3, 2 * n + 2);
  for (int i = 0; i < facets; ++i) {
    for (int end = 0; end < 2; ++end) {
      const double z = end * kLength;
      rod.vertices.col(i + end * n) = place(i, kRadius + outward, z);
      rod.exact->vertices.col(i + end * n) = place(i, kRadius, z);
    }
  }
  for (int end = 0; end < 2; ++end) {
    rod.vertices.col(2 * n + end) = Eigen::Vector3d(0, 0, end * kLength);
    rod.exact->vertices.col(2 * n + end) = rod.vertices.col(2 * n + end);
  }
  rod.triangles.resize(3, 4 * n);
  rod.triangle_face.resize(4 * n);
  rod.exact->middles.resize(3, 12 * n);
  for (int i = 0; i < facets; ++i) {
    const int next = (i + 1) % facets, above = i + facets, above_next = next + facets;
    rod.triangles.col(4 * i) << 2 * facets, next, i;
    rod.triangles.col(4 * i + 1) << 2 * facets + 1, above, above_next;
    rod.triangles.col(4 * i + 2) << i, next, above;
    rod.triangles.col(4 * i + 3) << next, above_next, above;
    rod.triangle_face.segment<4>(4 * i) << 0, 1, kFaceRound, kFaceRound;
    for (int t = 4 * i; t < 4 * i + 4; ++t) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d from = rod.exact->vertices.col(rod.triangles(k, t));
        const Eigen::Vector3d to = rod.exact->vertices.col(rod.triangles((k + 1) % 3, t));
        Eigen::Vector3d middle = (from + to) / 2;
        const bool is_round = from.head<2>().norm() > 0 && to.head<2>().norm() > 0;
        if (is_round) middle.head<2>() *= kRadius / middle.head<2>().norm();
        rod.exact->middles.col(3 * t + k) = middle;
      }
    }
  }
  rod.faces = {{-1, 0, {{0, "below"}}}, {-1, 0, {{0, "above"}}}, {-1, 0, {{0, "round"}}}};
  rod.part_interior = Eigen::Vector3d(1e-3, 1e-3, kLength / 2);
  rod.part_names = {"rod"};
  return rod;
}

// The determinant of an element's Jacobian at barycentric coordinates.
double DeterminantAt(const TetrahedralMesh& mesh, Eigen::Index e, const Eigen::Vector4d& at) {
  Eigen::Matrix<double, 3, 4> along = Eigen::Matrix<double, 3, 4>::Zero();
  for (int k = 0; k < 4; ++k) {
    along.col(k) += (4 * at(k) - 1) * mesh.nodes.col(mesh.tetrahedra(k, e));
  }
  for (int k = 0; k < 6; ++k) {
    const auto [i, j] = kTetrahedronEdges[static_cast<std::size_t>(k)];
    along.col(i) += 4 * at(j) * mesh.nodes.col(mesh.tetrahedra(4 + k, e));
    along.col(j) += 4 * at(i) * mesh.nodes.col(mesh.tetrahedra(4 + k, e));
  }
  const Eigen::Matrix3d jacobian = along.rightCols<3>().colwise() - along.col(0);
  return jacobian.determinant();
}

// By the rule of degree 3 that the determinant, a cubic polynomial, asks for.
double VolumeOf(const TetrahedralMesh& mesh) {
  double volume = 0;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    double mean = -0.8 * DeterminantAt(mesh, e, Eigen::Vector4d::Constant(0.25));
    for (int k = 0; k < 4; ++k) {
      Eigen::Vector4d at = Eigen::Vector4d::Constant(1.0 / 6);
      at(k) = 0.5;
      mean += 0.45 * DeterminantAt(mesh, e, at);
    }
    volume += mean / 6;
  }
  return volume;
}

double LeastDeterminant(const TetrahedralMesh& mesh) {
  double least = 1;
  constexpr int kSteps = 4;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        for (int k = 0; i + j + k <= kSteps; ++k) {
          const Eigen::Vector4d at(i, j, k, kSteps - i - j - k);
          least = std::min(least, DeterminantAt(mesh, e, at / kSteps));
        }
      }
    }
  }
  return least;
}

TetrahedralMesh Meshed(const AssemblySurface& surface, double size, bool quadratic = true) {
  auto mesh = MeshAssembly(surface, {.element_size = size, .quadratic = quadratic});
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return *std::move(mesh);
}

// The largest distance of a node on the round face from the rod's.
double LargestMiss(const TetrahedralMesh& mesh) {
  double miss = 0;
  for (Eigen::Index f = 0; f < mesh.face_triangles.cols(); ++f) {
    if (mesh.face_triangle_face(f) != kFaceRound) continue;
    for (const int node : mesh.face_triangles.col(f)) {
      miss = std::max(miss, std::abs(mesh.nodes.col(node).head<2>().norm() - kRadius));
    }
  }
  return miss;
}

constexpr double kVolume = std::numbers::pi * kRadius * kRadius * kLength;

// What parabolas through both ends and the middle of arcs miss of the area of a circle.
double MissOfParabolas(int facets) { return std::pow(2 * std::numbers::pi / facets, 4) / 480; }

TEST(CurvedElementsTest, FollowARoundFace) {
  for (const double outward : {0.0, 2e-4}) {
    const AssemblySurface rod = Rod(12, outward);
    const TetrahedralMesh straight = Meshed(rod, 0.006);
    const TetrahedralMesh curved = WithCurvedElements(rod, straight);
    EXPECT_EQ(curved.tetrahedra, straight.tetrahedra);
    EXPECT_GT(std::abs(VolumeOf(straight) - kVolume), 5e-3 * kVolume);
    EXPECT_NEAR(VolumeOf(curved) / kVolume, 1 - MissOfParabolas(12), 1e-5);
    EXPECT_LT(LargestMiss(curved), 2 * MissOfParabolas(12) * kRadius);
    EXPECT_GT(LeastDeterminant(curved), 0);
  }
}

// Twice as many sides: a sixteenth of the miss.
TEST(CurvedElementsTest, MissByTheFourthPowerOfTheSides) {
  const auto miss = [](int facets) {
    const AssemblySurface rod = Rod(facets);
    return std::abs(VolumeOf(WithCurvedElements(rod, Meshed(rod, 0.006))) - kVolume);
  };
  EXPECT_NEAR(std::log2(miss(8) / miss(16)), 4, 0.3);
}

TEST(CurvedElementsTest, LetMiddlesInsideBeHalfway) {
  const AssemblySurface rod = Rod(12, 2e-4);
  const TetrahedralMesh curved = WithCurvedElements(rod, Meshed(rod, 0.004));
  std::vector<bool> is_on_face(static_cast<std::size_t>(curved.nodes.cols()));
  for (const int node : curved.face_triangles.reshaped()) {
    is_on_face[static_cast<std::size_t>(node)] = true;
  }
  for (const auto& nodes : curved.tetrahedra.colwise()) {
    for (int k = 0; k < 6; ++k) {
      if (is_on_face[static_cast<std::size_t>(nodes(4 + k))]) continue;
      const auto [i, j] = kTetrahedronEdges[static_cast<std::size_t>(k)];
      const Eigen::Vector3d halfway = (curved.nodes.col(nodes(i)) + curved.nodes.col(nodes(j))) / 2;
      EXPECT_LT((curved.nodes.col(nodes(4 + k)) - halfway).norm(), 1e-15);
    }
  }
}

// Nodes that are added on a facet lie between those that know where the face is.
TEST(CurvedElementsTest, FollowTheFaceThroughRefinement) {
  const AssemblySurface rod = Rod(12, 2e-4);
  const TetrahedralMesh coarse = Meshed(rod, 0.006);
  const Eigen::VectorXd sizes = Eigen::VectorXd::Constant(coarse.tetrahedra.cols(), 0.003);
  const auto fine = RefineMesh(coarse, sizes);
  ASSERT_TRUE(fine.ok()) << fine.status();
  ASSERT_GT(fine->tetrahedra.cols(), 3 * coarse.tetrahedra.cols());
  const TetrahedralMesh curved = WithCurvedElements(rod, *fine);
  EXPECT_NEAR(VolumeOf(curved) / kVolume, 1 - MissOfParabolas(12), 1e-5);
  EXPECT_LT(LargestMiss(curved), 2 * MissOfParabolas(12) * kRadius);
  EXPECT_GT(LeastDeterminant(curved), 0);
}

TEST(CurvedElementsTest, StayStraightWhereTheyWouldTurnInsideOut) {
  AssemblySurface rod = Rod(12);
  // One side of the round face is told to be beyond the rod's axis.
  int dented = 0;
  while (rod.triangle_face(dented) != kFaceRound) ++dented;
  const std::pair<int, int> side(rod.triangles(1, dented), rod.triangles(2, dented));
  for (Eigen::Index t = 0; t < rod.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = rod.triangles(k, t), to = rod.triangles((k + 1) % 3, t);
      if (std::pair(from, to) == side || std::pair(to, from) == side) {
        rod.exact->middles.col(3 * t + k).head<2>() *= -0.5;
      }
    }
  }
  const TetrahedralMesh curved = WithCurvedElements(rod, Meshed(rod, 0.006));
  EXPECT_GT(LeastDeterminant(curved), 0);
  EXPECT_NEAR(VolumeOf(curved), kVolume, 0.02 * kVolume);
}

TEST(CurvedElementsTest, LeaveOthersAsTheyAre) {
  AssemblySurface rod = Rod(12, 2e-4);
  const TetrahedralMesh linear = Meshed(rod, 0.006, false);
  EXPECT_EQ(WithCurvedElements(rod, linear).nodes, linear.nodes);
  const TetrahedralMesh quadratic = Meshed(rod, 0.006);
  rod.exact.reset();
  EXPECT_EQ(WithCurvedElements(rod, quadratic).nodes, quadratic.nodes);
}

}  // namespace
}  // namespace mortise::mesh
