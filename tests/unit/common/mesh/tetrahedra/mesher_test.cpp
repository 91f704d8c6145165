// Volume meshes: what they keep of the assembly, what they refuse.
#include "common/mesh/tetrahedra/mesher.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/base/errors.h"
#include "common/mesh/element_faces.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "tests/support/mesh_quality.h"
#include "tests/unit/common/mesh/box_assembly.h"

namespace mortise::mesh {
namespace {

TEST(Mesher, FillsEveryPartExactly) {
  const AssemblySurface table = TestTable();
  for (const bool quadratic : {false, true}) {
    const auto mesh = MeshAssembly(table, {.quadratic = quadratic});
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_EQ(mesh->IsQuadratic(), quadratic);
    for (int p = 0; p < 9; ++p) {
      const double expected = ComputeMassProperties(PartSurface(table, p)).volume;
      EXPECT_NEAR(ComputeMassProperties(*mesh, p).volume, expected, 1e-12 * expected + 1e-15);
    }
    const testing::QualityReport quality = testing::MeasureQuality(*mesh);
    EXPECT_GT(quality.minimum_volume, 0);
    EXPECT_GT(quality.minimum_dihedral, 0.05) << ToText(quality);
    std::printf("%s\n", ToText(quality).c_str());
  }
}

// The area of each face as a vector along its normal, m².
std::vector<Eigen::Vector3d> FaceAreas(const TetrahedralMesh& mesh) {
  std::vector<Eigen::Vector3d> areas(mesh.faces.size(), Eigen::Vector3d::Zero());
  for (Eigen::Index t = 0; t < mesh.face_triangles.cols(); ++t) {
    const Eigen::Vector3d a = mesh.nodes.col(mesh.face_triangles(0, t));
    const Eigen::Vector3d b = mesh.nodes.col(mesh.face_triangles(1, t));
    const Eigen::Vector3d c = mesh.nodes.col(mesh.face_triangles(2, t));
    areas[mesh.face_triangle_face[t]] += (b - a).cross(c - a) / 2;
  }
  return areas;
}

// The edge of the regular tetrahedron of an element's volume, m.
double SizeOf(const TetrahedralMesh& mesh, Eigen::Index element) {
  const Eigen::Vector3d a = mesh.nodes.col(mesh.tetrahedra(0, element));
  const Eigen::Vector3d b = mesh.nodes.col(mesh.tetrahedra(1, element)) - a;
  const Eigen::Vector3d c = mesh.nodes.col(mesh.tetrahedra(2, element)) - a;
  const Eigen::Vector3d d = mesh.nodes.col(mesh.tetrahedra(3, element)) - a;
  return std::cbrt(std::sqrt(2.0) * b.cross(c).dot(d));
}

Eigen::Vector3d MiddleOf(const TetrahedralMesh& mesh, Eigen::Index element) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4; ++k) sum += mesh.nodes.col(mesh.tetrahedra(k, element));
  return sum / 4;
}

TEST(Mesher, RefinesElementsToTheirSizes) {
  const AssemblySurface table = TestTable();
  for (const bool quadratic : {false, true}) {
    const MeshOptions options{.quadratic = quadratic};
    const auto coarse = MeshAssembly(table, options);
    ASSERT_TRUE(coarse.ok()) << coarse.status();
    Eigen::VectorXd sizes(coarse->tetrahedra.cols());
    for (Eigen::Index e = 0; e < sizes.size(); ++e) sizes[e] = 0.75 * SizeOf(*coarse, e);
    const auto fine = RefineMesh(*coarse, sizes, options);
    ASSERT_TRUE(fine.ok()) << fine.status();
    EXPECT_EQ(fine->IsQuadratic(), quadratic);
    EXPECT_GE(fine->tetrahedra.cols(), EstimateRefinement(*coarse, sizes));
    EXPECT_LT(fine->tetrahedra.cols(), 6 * EstimateRefinement(*coarse, sizes));
    EXPECT_EQ(fine->part_names, coarse->part_names);
    for (int p = 0; p < 9; ++p) {
      const double volume = ComputeMassProperties(*coarse, p).volume;
      EXPECT_NEAR(ComputeMassProperties(*fine, p).volume, volume, 1e-12 * volume + 1e-15) << p;
      EXPECT_TRUE(IsWatertight({fine->nodes, OuterTriangles(*fine, p)})) << p;
    }
    const auto before = FaceAreas(*coarse), after = FaceAreas(*fine);
    ASSERT_EQ(after.size(), before.size());
    for (std::size_t f = 0; f < before.size(); ++f) {
      EXPECT_EQ(fine->faces[f].origins, coarse->faces[f].origins);
      EXPECT_EQ(fine->faces[f].back_part, coarse->faces[f].back_part);
      EXPECT_LT((before[f] - after[f]).norm(), 1e-12) << f;
    }
    const testing::QualityReport quality = testing::MeasureQuality(*fine);
    EXPECT_GT(quality.minimum_dihedral, 0.05) << ToText(quality);
  }
}

TEST(Mesher, RefinesOnlyWhereItIsAsked) {
  const auto coarse = MeshAssembly(
      AssembleBoxes({{"a", {0, 0, 0}, {4, 1, 1}}, {"b", {4, 0.2, 0.2}, {5, 0.8, 0.8}}}),
      {.element_size = 0.4, .quadratic = false});
  ASSERT_TRUE(coarse.ok()) << coarse.status();
  const double wanted = 0.08;
  Eigen::VectorXd sizes(coarse->tetrahedra.cols());
  Eigen::Index far_before = 0;
  for (Eigen::Index e = 0; e < sizes.size(); ++e) {
    double nearest = 9;
    for (int k = 0; k < 4; ++k) {
      nearest = std::min(nearest, coarse->nodes(0, coarse->tetrahedra(k, e)));
    }
    sizes[e] = nearest < 0.1 ? wanted : 1;
    if (MiddleOf(*coarse, e).x() > 3) ++far_before;
  }
  const auto fine = RefineMesh(*coarse, sizes, {.quadratic = false});
  ASSERT_TRUE(fine.ok()) << fine.status();
  Eigen::Index far_after = 0;
  for (Eigen::Index e = 0; e < fine->tetrahedra.cols(); ++e) {
    const Eigen::Vector3d middle = MiddleOf(*fine, e);
    if (middle.x() > 3) ++far_after;
    if (middle.x() < 0.1) {
      EXPECT_LE(SizeOf(*fine, e), wanted * 1.001);
    }
  }
  EXPECT_GT(fine->tetrahedra.cols(), 3 * coarse->tetrahedra.cols());
  EXPECT_LE(far_after, far_before * 11 / 10 + 5);
  // The interface is still one set of triangles, and the outline of the contact is kept.
  const SurfaceMesh outside{fine->nodes, OuterTriangles(*fine)};
  EXPECT_TRUE(IsWatertight(outside));
  EXPECT_NEAR(SurfaceArea(outside), 2 + 4 * 4 + 4 * 0.6, 1e-9);
}

TEST(Mesher, RefiningIsDeterministicAndRefusesNonsense) {
  const auto coarse = MeshAssembly(AssembleBoxes({{"a", {0, 0, 0}, {1, 1, 1}}}), {});
  ASSERT_TRUE(coarse.ok());
  const Eigen::VectorXd sizes = Eigen::VectorXd::Constant(coarse->tetrahedra.cols(), 0.1);
  const auto first = RefineMesh(*coarse, sizes), second = RefineMesh(*coarse, sizes);
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(first->nodes, second->nodes);
  EXPECT_EQ(first->tetrahedra, second->tetrahedra);
  const auto code = [&](const Eigen::VectorXd& wanted, int limit = 2'000'000) {
    return RefineMesh(*coarse, wanted, {.element_limit = limit}).status().code();
  };
  EXPECT_EQ(code(Eigen::VectorXd()), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code(0 * sizes), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code(sizes * std::numeric_limits<double>::quiet_NaN()),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code(1e-5 * sizes), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(code(sizes, 1000), absl::StatusCode::kResourceExhausted);
}

TEST(Mesher, KeepsFacesWithTheirAreaAndDirection) {
  const AssemblySurface table = TestTable();
  const auto mesh = MeshAssembly(table, {.quadratic = true});
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  ASSERT_EQ(mesh->faces.size(), table.faces.size());
  std::vector<Eigen::Vector3d> before(table.faces.size(), Eigen::Vector3d::Zero());
  const std::vector<Eigen::Vector3d> after = FaceAreas(*mesh);
  for (Eigen::Index t = 0; t < table.triangles.cols(); ++t) {
    const Eigen::Vector3d a = table.vertices.col(table.triangles(0, t));
    const Eigen::Vector3d b = table.vertices.col(table.triangles(1, t));
    const Eigen::Vector3d c = table.vertices.col(table.triangles(2, t));
    // The mesh turns faces whose back is the outside.
    const double sign = table.faces[table.triangle_face[t]].back_part < 0 ? -1 : 1;
    before[table.triangle_face[t]] += sign * (b - a).cross(c - a) / 2;
  }
  for (Eigen::Index t = 0; t < mesh->face_triangles.cols(); ++t) {
    const Eigen::Vector3d a = mesh->nodes.col(mesh->face_triangles(0, t));
    const Eigen::Vector3d b = mesh->nodes.col(mesh->face_triangles(1, t));
    const Eigen::Vector3d c = mesh->nodes.col(mesh->face_triangles(2, t));
    EXPECT_LT((mesh->nodes.col(mesh->face_triangles(3, t)) - 0.5 * (a + b)).norm(), 1e-15);
    EXPECT_LT((mesh->nodes.col(mesh->face_triangles(4, t)) - 0.5 * (b + c)).norm(), 1e-15);
    EXPECT_LT((mesh->nodes.col(mesh->face_triangles(5, t)) - 0.5 * (c + a)).norm(), 1e-15);
  }
  for (std::size_t f = 0; f < before.size(); ++f) {
    EXPECT_LT((before[f] - after[f]).norm(), 1e-12) << f;
    EXPECT_GE(mesh->faces[f].back_part, 0);
  }
}

TEST(Mesher, MidNodesFollowTheHeadersOrder) {
  const auto mesh = MeshAssembly(AssembleBoxes({{"a", {0, 0, 0}, {1, 1, 1}}}), {});
  ASSERT_TRUE(mesh.ok());
  for (Eigen::Index e = 0; e < mesh->tetrahedra.cols(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d middle =
          0.5 * (mesh->nodes.col(mesh->tetrahedra(kTetrahedronEdges[k][0], e)) +
                 mesh->nodes.col(mesh->tetrahedra(kTetrahedronEdges[k][1], e)));
      EXPECT_LT((mesh->nodes.col(mesh->tetrahedra(4 + k, e)) - middle).norm(), 1e-15);
    }
  }
}

TEST(Mesher, TouchingPartsShareNodes) {
  const auto mesh = MeshAssembly(
      AssembleBoxes({{"a", {0, 0, 0}, {1, 1, 1}}, {"b", {1, 0.2, 0.2}, {2, 0.8, 0.8}}}),
      {.element_size = 0.3});
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  // If nodes were doubled, the outer faces would include the interface.
  double area = 0;
  const Eigen::Matrix3Xi outer = OuterTriangles(*mesh);
  SurfaceMesh surface{mesh->nodes, outer};
  area = SurfaceArea(surface);
  EXPECT_NEAR(area, 6 - 0.36 + 0.36 + 4 * 0.6, 1e-9);
  EXPECT_TRUE(IsWatertight(surface));
  EXPECT_TRUE(IsWatertight({mesh->nodes, OuterTriangles(*mesh, 1)}));
}

TEST(Mesher, LeavesEnclosedVoidsEmpty) {
  // Six slabs round a hollow.
  const auto surface = AssembleBoxes({{"floor", {0, 0, 0}, {3, 3, 1}},
                                      {"roof", {0, 0, 2}, {3, 3, 3}},
                                      {"left", {0, 0, 1}, {1, 3, 2}},
                                      {"right", {2, 0, 1}, {3, 3, 2}},
                                      {"front", {1, 0, 1}, {2, 1, 2}},
                                      {"back", {1, 2, 1}, {2, 3, 2}}});
  const auto mesh = MeshAssembly(surface, {.element_size = 1});
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_NEAR(ComputeMassProperties(*mesh).volume, 26, 1e-9);
}

TEST(Mesher, SmallerElementsWhenAsked) {
  const auto box = AssembleBoxes({{"a", {0, 0, 0}, {1, 1, 1}}});
  Eigen::Index previous = 0;
  for (const double size : {0.5, 0.25, 0.125}) {
    const auto mesh = MeshAssembly(box, {.element_size = size});
    ASSERT_TRUE(mesh.ok());
    EXPECT_GT(mesh->tetrahedra.cols(), 3 * previous);
    EXPECT_GE(mesh->tetrahedra.cols(), EstimateElements(box, size));
    previous = mesh->tetrahedra.cols();
  }
}

TEST(Mesher, TheSameInputGivesTheSameMesh) {
  const auto first = MeshAssembly(TestTable(), {});
  const auto second = MeshAssembly(TestTable(), {});
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(first->nodes, second->nodes);
  EXPECT_EQ(first->tetrahedra, second->tetrahedra);
}

TEST(Mesher, RefusesAbsurdSizesAtOnce) {
  const auto mesh = MeshAssembly(TestTable(), {.element_size = 1e-5});
  EXPECT_EQ(mesh.status().code(), absl::StatusCode::kResourceExhausted) << mesh.status();
  EXPECT_EQ(MeshAssembly(TestTable(), {.element_size = -1}).status().code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(MeshAssembly(TestTable(), {.element_size = std::numeric_limits<double>::quiet_NaN()})
                .status()
                .code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(MeshAssembly(TestTable(), {.radius_edge_ratio = 0.5}).ok());
  EXPECT_FALSE(MeshAssembly(TestTable(), {.element_limit = 0}).ok());
}

TEST(Mesher, NamesThePartThatIsOpen) {
  AssemblySurface open = TestTable();
  open.triangles.conservativeResize(3, open.triangles.cols() - 1);
  open.triangle_face.conservativeResize(open.triangles.cols());
  const auto mesh = MeshAssembly(open, {});
  EXPECT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_NE(mesh.status().message().find("part 'top'"), std::string::npos) << mesh.status();
  EXPECT_NE(mesh.status().message().find("open"), std::string::npos) << mesh.status();
}

TEST(Mesher, NamesThePartsThatCross) {
  AssemblySurface crossing =
      AssembleBoxes({{"a", {0, 0, 0}, {1, 1, 1}}, {"b", {2, 0, 0}, {3, 1, 1}}});
  // The second box is pushed into the first.
  for (Eigen::Index v = 0; v < crossing.vertices.cols(); ++v) {
    if (crossing.vertices(0, v) > 1.5) {
      crossing.vertices.col(v) += Eigen::Vector3d(-1.3, 0.13, 0.17);
    }
  }
  crossing.part_interior.col(1) += Eigen::Vector3d(-1.3 + 0.1, 0.13, 0.17);
  const auto mesh = MeshAssembly(crossing, {});
  EXPECT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument) << mesh.status();
  EXPECT_NE(mesh.status().message().find("cross"), std::string::npos) << mesh.status();
}

TEST(Mesher, RefusesBrokenInput) {
  const auto code = [](const AssemblySurface& surface) {
    return MeshAssembly(surface, {}).status().code();
  };
  EXPECT_EQ(code({}), absl::StatusCode::kInvalidArgument);
  AssemblySurface broken = TestTable();
  broken.triangles(0, 3) = 1000000;
  EXPECT_EQ(code(broken), absl::StatusCode::kInvalidArgument);
  broken = TestTable();
  broken.vertices(1, 2) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(code(broken), absl::StatusCode::kInvalidArgument);
  broken = TestTable();
  broken.triangle_face[0] = -2;
  EXPECT_EQ(code(broken), absl::StatusCode::kInvalidArgument);
  broken = TestTable();
  broken.part_interior.col(3) = Eigen::Vector3d(9, 9, 9);
  EXPECT_EQ(code(broken), absl::StatusCode::kInvalidArgument);
  broken = TestTable();
  broken.faces[0].front_part = 77;
  EXPECT_EQ(code(broken), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace mortise::mesh
