// Half-edge meshes of surfaces: what they keep, what they refuse, and where any triangles are cut.
#include "common/mesh/halfedge_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/mesh/joined_surface.h"
#include "common/mesh/surface_check.h"
#include "tests/unit/common/mesh/box_assembly.h"
#include "tests/unit/common/mesh/round_solids.h"

namespace mortise::mesh {
namespace {

using ::testing::HasSubstr;

int EulerCharacteristic(const HalfedgeMesh& mesh) {
  return static_cast<int>(mesh.n_vertices()) - static_cast<int>(mesh.n_edges()) +
         static_cast<int>(mesh.n_faces());
}

// Every half-edge belongs to one loop of next half-edges, and all that leave a vertex say so.
void ExpectConsistent(const HalfedgeMesh& mesh) {
  for (const OpenMesh::HalfedgeHandle halfedge : mesh.all_halfedges()) {
    const auto next = mesh.next_halfedge_handle(halfedge);
    ASSERT_TRUE(next.is_valid());
    EXPECT_EQ(mesh.prev_halfedge_handle(next), halfedge);
    EXPECT_EQ(mesh.to_vertex_handle(halfedge), mesh.from_vertex_handle(next));
    EXPECT_EQ(mesh.face_handle(halfedge), mesh.face_handle(next));
  }
  for (const OpenMesh::VertexHandle vertex : mesh.all_vertices()) {
    const auto halfedge = mesh.halfedge_handle(vertex);
    if (!halfedge.is_valid()) continue;
    EXPECT_EQ(mesh.from_vertex_handle(halfedge), vertex);
    EXPECT_TRUE(mesh.is_manifold(vertex));
  }
}

std::string Refused(const SurfaceMesh& surface) {
  ::testing::internal::CaptureStderr();
  const absl::Status status = ToHalfedgeMesh(surface).status();
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "OpenMesh prints what it refuses";
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  for (const FieldViolation& violation : ViolationsOf(status)) {
    EXPECT_EQ(violation.field, "surface");
  }
  return std::string(status.message());
}

TEST(HalfedgeMesh, KeepsOrderAndBits) {
  std::mt19937_64 random(5);
  SurfaceMesh torus = Torus(0.1, 0.03, 12);
  std::vector<int> order(static_cast<std::size_t>(torus.triangles.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  torus.triangles = torus.triangles(Eigen::all, order).eval();
  for (auto triangle : torus.triangles.colwise()) {
    std::rotate(triangle.begin(), triangle.begin() + static_cast<long>(random() % 3),
                triangle.end());
  }
  const auto mesh = ToHalfedgeMesh(torus);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  ExpectConsistent(*mesh);
  const SurfaceMesh again = ToSurfaceMesh(*mesh);
  EXPECT_EQ(again.vertices, torus.vertices);
  EXPECT_EQ(again.triangles, torus.triangles);
}

TEST(HalfedgeMesh, HasTheEulerCharacteristicOfItsShape) {
  EXPECT_EQ(EulerCharacteristic(*ToHalfedgeMesh(Sphere(1, 9))), 2);
  EXPECT_EQ(EulerCharacteristic(*ToHalfedgeMesh(Torus(1, 0.3, 9))), 0);
  EXPECT_EQ(EulerCharacteristic(*ToHalfedgeMesh(BoxSurface({0, 0, 0}, {1, 1, 1}))), 2);
  SurfaceMesh open = Sphere(1, 9);
  open.triangles.conservativeResize(3, open.triangles.cols() - 1);
  const auto disk = ToHalfedgeMesh(open);
  ASSERT_TRUE(disk.ok()) << disk.status();
  EXPECT_EQ(EulerCharacteristic(*disk), 1);
  ExpectConsistent(*disk);
}

TEST(HalfedgeMesh, RefusesWhatIsNoOrientedManifoldWithThePlace) {
  const SurfaceMesh box = BoxSurface({0, 0, 0}, {1, 1, 1});
  SurfaceMesh broken = box;
  broken.triangles.col(3).row(0).swap(broken.triangles.col(3).row(1));
  EXPECT_THAT(Refused(broken), HasSubstr("face opposite ways at ("));
  broken = box;
  broken.triangles.conservativeResize(3, box.triangles.cols() + 1);
  broken.triangles.rightCols(1) = box.triangles.leftCols(1);
  EXPECT_THAT(Refused(broken), HasSubstr("more than two triangles meet at an edge at ("));
  broken = box;
  broken.triangles(0, 5) = broken.triangles(1, 5);
  EXPECT_THAT(Refused(broken), HasSubstr("names a vertex twice at ("));
  broken = box;
  broken.triangles(0, 5) = 8;
  EXPECT_THAT(Refused(broken), HasSubstr("triangle 5 names a vertex that does not exist"));
  broken = box;
  broken.vertices(1, 2) = NAN;
  EXPECT_THAT(Refused(broken), HasSubstr("vertex 2 is not finite"));
  EXPECT_THAT(Refused({}), HasSubstr("no triangles"));
  // Two boxes that share one corner.
  SurfaceMesh pinched = Joined({box, BoxSurface({1, 1, 1}, {2, 2, 2})});
  Eigen::Index low = 0, high = 0;
  (box.vertices.colwise() - Eigen::Vector3d(1, 1, 1)).colwise().norm().minCoeff(&low);
  (pinched.vertices.rightCols(8).colwise() - Eigen::Vector3d(1, 1, 1))
      .colwise()
      .norm()
      .minCoeff(&high);
  for (int& vertex : pinched.triangles.reshaped()) {
    if (vertex == 8 + high) vertex = static_cast<int>(low);
  }
  EXPECT_THAT(Refused(pinched), HasSubstr("single vertex at (1000, 1000, 1000) mm"));
  EXPECT_TRUE(IsWatertight(pinched)) << "for most it is closed all the same";
}

TEST(CutSurface, TellsOfEveryEdgeOfAnyTriangles) {
  std::mt19937_64 random(11);
  for (int trial = 0; trial < 50; ++trial) {
    const int vertices = 4 + static_cast<int>(random() % 12);
    SurfaceMesh soup;
    soup.vertices = Eigen::Matrix3Xd::Zero(3, vertices);
    soup.triangles.resize(3, 1 + static_cast<Eigen::Index>(random() % 40));
    for (int& vertex : soup.triangles.reshaped()) {
      vertex = static_cast<int>(random() % static_cast<unsigned>(vertices));
    }
    std::map<std::pair<int, int>, std::array<int, 2>> expected;
    for (const auto& t : soup.triangles.colwise()) {
      for (int k = 0; k < 3; ++k) {
        const int from = t[k], to = t[(k + 1) % 3];
        ++expected[std::minmax(from, to)][from < to ? 0 : 1];
      }
    }
    const CutSurface cut(soup.vertices, soup.triangles);
    ASSERT_EQ(cut.edges().size(), expected.size());
    auto edge = cut.edges().begin();
    for (const auto& [ends, uses] : expected) {
      EXPECT_EQ(std::pair(edge->low, edge->high), ends);
      EXPECT_EQ((std::array{edge->forward, edge->backward}), uses);
      for (int i = 0; i < edge->triangles(); ++i) {
        const auto corners = soup.triangles.col(cut.TriangleAt(*edge, i));
        EXPECT_TRUE((corners.array() == ends.first).any() &&
                    (corners.array() == ends.second).any());
      }
      ++edge;
    }
    // The triangles are those of the soup, up to copies of vertices, and the mesh is sound.
    const SurfaceMesh pieces = ToSurfaceMesh(cut.mesh());
    for (Eigen::Index i = 0; i < soup.triangles.size(); ++i) {
      EXPECT_EQ(cut.origin()[static_cast<std::size_t>(pieces.triangles(i))], soup.triangles(i));
    }
    ExpectConsistent(cut.mesh());
  }
}

TEST(CutSurface, IsNotCutWhereItIsAManifold) {
  const SurfaceMesh torus = Torus(1, 0.3, 9);
  const CutSurface whole(torus.vertices, torus.triangles);
  EXPECT_EQ(whole.mesh().n_vertices(), static_cast<std::size_t>(torus.vertices.cols()));
  for (const SurfaceEdge& edge : whole.edges()) EXPECT_TRUE(edge.IsJoined());
}

}  // namespace
}  // namespace mortise::mesh
