#include "services/interpolator/shapes/canonical_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <set>

#include "common/base/errors.h"
#include "tests/unit/common/fields/two_tetrahedra.h"
#include "tests/unit/services/interpolator/shapes/block_designs.h"

namespace mortise::interpolator {
namespace {

const BlockCells kCells{.along = 5, .across = 4, .high = 3, .unrest = 0.2};

fields::DesignFields Box() { return BlockDesign(BoxShape({2, 1, 0.5}), kCells); }

double VolumeOf(const CanonicalMesh& mesh, Eigen::Index element) {
  const Eigen::Matrix<double, 3, 4> at = mesh.nodes(Eigen::all, mesh.tetrahedra.col(element));
  const Eigen::Vector3d a = at.col(1) - at.col(0), b = at.col(2) - at.col(0);
  return a.cross(b).dot(at.col(3) - at.col(0)) / 6;
}

TEST(CanonicalMesh, HasTheNodesOfTheSurfaceFirst) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Box()).value();
  EXPECT_EQ(mesh.node_count(), 6 * 5 * 4);
  EXPECT_EQ(mesh.surface_nodes, 6 * 5 * 4 - 4 * 3 * 2);
  std::set<int> used;
  for (const int node : mesh.triangles.reshaped()) used.insert(node);
  EXPECT_EQ(static_cast<int>(used.size()), mesh.surface_nodes);
  EXPECT_EQ(*used.rbegin(), mesh.surface_nodes - 1);
}

TEST(CanonicalMesh, IsTheShapeOfTheDesign) {
  const fields::DesignFields design = Box();
  const CanonicalMesh mesh = CanonicalMesh::Create(design).value();
  for (int node = 0; node < mesh.node_count(); ++node) {
    EXPECT_EQ(mesh.nodes.col(node),
              design.nodes.col(mesh.given_node[static_cast<std::size_t>(node)]));
  }
  double volume = 0;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    EXPECT_GT(VolumeOf(mesh, e), 0);
    volume += VolumeOf(mesh, e);
  }
  EXPECT_NEAR(volume, 1, 1e-12);
  EXPECT_TRUE(mesh.is_closed);
  EXPECT_NEAR(mesh.size, std::sqrt(4 + 1 + 0.25), 1e-12);
}

// Neighbours in the order are, for the most part, neighbours in space.
TEST(CanonicalMesh, SortsNodesInSpace) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Box()).value();
  double steps = 0;
  for (int node = 1; node < mesh.surface_nodes; ++node) {
    steps += (mesh.nodes.col(node) - mesh.nodes.col(node - 1)).norm();
  }
  EXPECT_LT(steps / mesh.surface_nodes, 0.2 * mesh.size);
}

TEST(CanonicalMesh, HasRegionsOfOuterTriangles) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Box()).value();
  ASSERT_EQ(mesh.regions.size(), 1u);
  EXPECT_EQ(mesh.regions[0].name, "held");
  EXPECT_EQ(mesh.regions[0].triangles.size(), 2u * 4 * 3);
  for (const int t : mesh.regions[0].triangles) {
    for (const int node : mesh.triangles.col(t)) EXPECT_EQ(mesh.nodes(0, node), 0);
  }
}

TEST(CanonicalMesh, TellsOuterTrianglesFromThoseBetweenParts) {
  const CanonicalMesh mesh = CanonicalMesh::Create(fields::TwoTetrahedra()).value();
  EXPECT_EQ(mesh.triangles.cols(), 6);
  EXPECT_EQ(mesh.inner_triangles.cols(), 1);
  EXPECT_EQ(mesh.inner_back[0], 0);
  EXPECT_EQ(mesh.inner_front[0], 1);
  EXPECT_EQ(mesh.triangle_part, (Eigen::VectorXi(6) << 0, 0, 0, 1, 1, 1).finished());
  EXPECT_THAT(mesh.regions[0].triangles, testing::ElementsAre(0, 2));
  EXPECT_THAT(mesh.regions[2].triangles, testing::IsEmpty());
  EXPECT_TRUE(mesh.is_closed);
  ASSERT_EQ(mesh.fields.size(), 3u);
  EXPECT_EQ(mesh.FindField("displacement", "wind"), 1);
  EXPECT_EQ(mesh.FindField("displacement", ""), -1);
  EXPECT_EQ(mesh.ValueCount(mesh.fields[2]), 2);
}

// What evaluators leave out or turn round is found in the elements.
TEST(CanonicalMesh, FindsOuterTrianglesInTheElements) {
  fields::DesignFields design = fields::TwoTetrahedra();
  design.triangles = design.triangles.leftCols(1).eval();
  design.triangles.col(0).reverseInPlace();
  design.triangle_back = design.triangle_back.head(1).eval();
  design.triangle_front = design.triangle_front.head(1).eval();
  design.regions = {{"held", {0}}};
  const CanonicalMesh mesh = CanonicalMesh::Create(design).value();
  EXPECT_EQ(mesh.triangles.cols(), 6);
  EXPECT_TRUE(mesh.is_closed);
  EXPECT_THAT(mesh.regions[0].triangles, testing::ElementsAre(0));
}

TEST(CanonicalMesh, TakesASurfaceAlone) {
  const CanonicalMesh mesh = CanonicalMesh::Create(SurfaceOnly(Box())).value();
  EXPECT_EQ(mesh.element_count(), 0);
  EXPECT_EQ(mesh.node_count(), mesh.surface_nodes);
  EXPECT_TRUE(mesh.is_closed);
  EXPECT_EQ(mesh.fields.size(), 3u);
}

TEST(CanonicalMesh, TurnsTrianglesOfASurfaceOutward) {
  fields::DesignFields design = SurfaceOnly(Box());
  const CanonicalMesh straight = CanonicalMesh::Create(design).value();
  std::swap(design.triangle_back, design.triangle_front);
  design.triangles.row(0).swap(design.triangles.row(1));
  const CanonicalMesh turned = CanonicalMesh::Create(design).value();
  EXPECT_TRUE(turned.is_closed);
  EXPECT_EQ(turned.triangle_part, straight.triangle_part);
  for (Eigen::Index t = 0; t < straight.triangles.cols(); ++t) {
    const auto normal = [t](const CanonicalMesh& mesh) -> Eigen::Vector3d {
      const Eigen::Matrix3d at = mesh.nodes(Eigen::all, mesh.triangles.col(t));
      return (at.col(1) - at.col(0)).cross(at.col(2) - at.col(0));
    };
    EXPECT_GT(normal(turned).dot(normal(straight)), 0);
  }
}

TEST(CanonicalMesh, SaysThatASurfaceIsOpen) {
  fields::DesignFields design = SurfaceOnly(Box());
  const Eigen::Index left = design.triangles.cols() - 1;
  design.triangles = design.triangles.leftCols(left).eval();
  design.triangle_back = design.triangle_back.head(left).eval();
  design.triangle_front = design.triangle_front.head(left).eval();
  EXPECT_FALSE(CanonicalMesh::Create(design).value().is_closed);
}

TEST(CanonicalMesh, DropsTheMiddlesOfEdges) {
  const CanonicalMesh linear = CanonicalMesh::Create(Box()).value();
  const CanonicalMesh quadratic = CanonicalMesh::Create(Quadratic(Box())).value();
  EXPECT_EQ(quadratic.nodes, linear.nodes);
  EXPECT_EQ(quadratic.tetrahedra, linear.tetrahedra);
  EXPECT_EQ(quadratic.triangles, linear.triangles);
}

TEST(CanonicalMesh, ComesBackFromItsFile) {
  for (const fields::DesignFields& design : {Box(), SurfaceOnly(Box()), fields::TwoTetrahedra()}) {
    const CanonicalMesh mesh = CanonicalMesh::Create(design).value();
    const std::string file = WriteMesh(mesh).value();
    EXPECT_EQ(file, WriteMesh(CanonicalMesh::Create(design).value()).value());
    const CanonicalMesh read = ReadMesh(file).value();
    EXPECT_EQ(read.nodes, mesh.nodes);
    EXPECT_EQ(read.tetrahedra, mesh.tetrahedra);
    EXPECT_EQ(read.triangles, mesh.triangles);
    EXPECT_EQ(read.inner_triangles, mesh.inner_triangles);
    EXPECT_EQ(read.fields, mesh.fields);
    EXPECT_EQ(read.given_node, mesh.given_node);
    EXPECT_EQ(read.given.control_points.size(), design.control_points.size());
    EXPECT_EQ(read.given.paths.size(), design.paths.size());
    EXPECT_EQ(read.given.ways.size(), design.ways.size());
  }
}

TEST(CanonicalMesh, RefusesADamagedFile) {
  const std::string file =
      WriteMesh(CanonicalMesh::Create(fields::TwoTetrahedra()).value()).value();
  for (std::size_t at = 0; at < file.size(); ++at) {
    std::string damaged = file;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const absl::Status status = ReadMesh(damaged).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << at;
    EXPECT_THAT(DetailOf(status).field, testing::StartsWith("mesh.")) << at;
    EXPECT_FALSE(ReadMesh(std::string_view(file).substr(0, at)).ok()) << at;
  }
}

TEST(CanonicalMesh, RefusesWhatIsNotFinite) {
  fields::DesignFields design = Box();
  design.fields[1].values(2, 7) = std::numeric_limits<double>::quiet_NaN();
  const absl::Status field = CanonicalMesh::Create(design).status();
  EXPECT_EQ(field.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(field).field, "fields[1].values");
  design = Box();
  design.nodes(0, 3) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(DetailOf(CanonicalMesh::Create(design).status()).field, "nodes");
}

TEST(CanonicalMesh, RefusesADesignWithoutAnOutside) {
  fields::DesignFields design = SurfaceOnly(Box());
  design.triangle_front.setZero();
  EXPECT_EQ(DetailOf(CanonicalMesh::Create(design).status()).field, "triangles");
}

}  // namespace
}  // namespace mortise::interpolator
