// The fused surface of an assembly is conforming, closed around every part, and correctly named.
#include "common/cad/surface/assembly_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <random>

#include "common/base/errors.h"
#include "common/design/part_shapes.h"
#include "tests/unit/common/files/table.h"

namespace mortise::cad {
namespace {

mesh::PartShape Block(const std::string& name, const Eigen::Vector3d& low,
                      const Eigen::Vector3d& size) {
  mesh::PartShape shape;
  shape.name = name;
  shape.origin = low;
  shape.outline.resize(2, 4);
  shape.outline << 0, size.x(), size.x(), 0, 0, 0, size.y(), size.y();
  shape.height = size.z();
  shape.face_names = {"front", "right", "back", "left", "bottom", "top"};
  return shape;
}

// Volume enclosed by the faces of one part: those it is behind count as they are, those it is in
// front of the other way round.
double PartVolume(const mesh::AssemblySurface& surface, int part) {
  double six = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const mesh::AssemblyFace& face =
        surface.faces[static_cast<std::size_t>(surface.triangle_face(t))];
    const double sign = face.back_part == part ? 1 : face.front_part == part ? -1 : 0;
    const auto triangle = surface.triangles.col(t);
    six +=
        sign * surface.vertices.col(triangle(0))
                   .dot(surface.vertices.col(triangle(1)).cross(surface.vertices.col(triangle(2))));
  }
  return six / 6;
}

// Around every part each edge is used once in each direction: closed, and without T-junctions,
// for at one an edge would be met by two shorter ones.
void ExpectClosed(const mesh::AssemblySurface& surface, int part) {
  std::map<std::pair<int, int>, int> edges;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const mesh::AssemblyFace& face =
        surface.faces[static_cast<std::size_t>(surface.triangle_face(t))];
    if (face.back_part != part && face.front_part != part) continue;
    Eigen::Vector3i triangle = surface.triangles.col(t);
    if (face.front_part == part) std::swap(triangle(1), triangle(2));
    for (int i = 0; i < 3; ++i) ++edges[{triangle(i), triangle((i + 1) % 3)}];
  }
  EXPECT_FALSE(edges.empty());
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u)
        << "edge of part " << part << " from " << surface.vertices.col(edge.first).transpose()
        << " to " << surface.vertices.col(edge.second).transpose();
  }
}

// Whether no vertex lies in the middle of an edge.
void ExpectConforming(const mesh::AssemblySurface& surface) {
  std::map<std::pair<int, int>, bool> edges;
  for (const auto& triangle : surface.triangles.colwise()) {
    for (int i = 0; i < 3; ++i) {
      edges[std::minmax(triangle(i), triangle((i + 1) % 3))] = true;
    }
  }
  for (const auto& [edge, unused] : edges) {
    const Eigen::Vector3d a = surface.vertices.col(edge.first);
    const Eigen::Vector3d along = surface.vertices.col(edge.second) - a;
    for (int v = 0; v < surface.vertices.cols(); ++v) {
      if (v == edge.first || v == edge.second) continue;
      const Eigen::Vector3d offset = surface.vertices.col(v) - a;
      const double t = offset.dot(along) / along.squaredNorm();
      if (t <= 0 || t >= 1) continue;
      EXPECT_GT((offset - t * along).norm(), 1e-9) << "vertex " << v << " lies on an edge";
    }
  }
}

TEST(AssemblySurface, GluesTwoBlocks) {
  const auto surface =
      FuseAssembly({Block("a", {0, 0, 0}, {1, 1, 1}), Block("b", {0.25, 0.25, 1}, {0.5, 0.5, 2})});
  ASSERT_TRUE(surface.ok()) << surface.status();
  ExpectConforming(*surface);
  for (int part = 0; part < 2; ++part) ExpectClosed(*surface, part);
  EXPECT_NEAR(PartVolume(*surface, 0), 1, 1e-12);
  EXPECT_NEAR(PartVolume(*surface, 1), 0.5, 1e-12);
  // 6 + 6 faces, of which one is shared; the top of the lower block keeps a frame around it.
  EXPECT_EQ(surface->faces.size(), 12u);
  int shared = 0;
  for (const mesh::AssemblyFace& face : surface->faces) {
    if (face.front_part < 0) continue;
    ++shared;
    EXPECT_EQ(face.back_part, 0);
    EXPECT_EQ(face.front_part, 1);
    EXPECT_THAT(face.origins, testing::UnorderedElementsAre(mesh::NamedFace{0, "top"},
                                                            mesh::NamedFace{1, "bottom"}));
  }
  EXPECT_EQ(shared, 1);
}

TEST(AssemblySurface, KeepsPartsApartThatDoNotTouch) {
  const auto surface =
      FuseAssembly({Block("a", {0, 0, 0}, {1, 1, 1}), Block("b", {2, 0, 0}, {1, 1, 1})});
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_EQ(surface->faces.size(), 12u);
  EXPECT_EQ(surface->vertices.cols(), 16);
}

TEST(AssemblySurface, RefusesPartsThatPenetrate) {
  const auto surface =
      FuseAssembly({Block("a", {0, 0, 0}, {1, 1, 1}), Block("b", {0.5, 0.5, 0.5}, {1, 1, 1})});
  EXPECT_EQ(surface.status().code(), absl::StatusCode::kInvalidArgument) << surface.status();
  const auto inside = FuseAssembly(
      {Block("a", {0, 0, 0}, {1, 1, 1}), Block("b", {0.2, 0.2, 0.2}, {0.5, 0.5, 0.5})});
  EXPECT_FALSE(inside.ok());
}

TEST(AssemblySurface, RefusesShapesThatAreNone) {
  EXPECT_FALSE(FuseAssembly(std::vector<mesh::PartShape>()).ok());
  EXPECT_FALSE(FuseAssembly(std::vector<Solid>()).ok());
  mesh::PartShape flat = Block("a", {0, 0, 0}, {1, 1, 1});
  flat.height = 0;
  EXPECT_EQ(DetailOf(FuseAssembly({flat}).status()).field, "parts[0].height");
  mesh::PartShape crossed = Block("a", {0, 0, 0}, {1, 1, 1});
  crossed.outline.col(1).swap(crossed.outline.col(2));
  EXPECT_FALSE(FuseAssembly({crossed}).ok());
  mesh::PartShape unnamed = Block("a", {0, 0, 0}, {1, 1, 1});
  unnamed.face_names.pop_back();
  EXPECT_EQ(DetailOf(FuseAssembly({unnamed}).status()).field, "parts[0].face_names");
}

TEST(AssemblySurface, TableIsClosedAndConformingAtRandomPoints) {
  const auto table = parametric::TemplateFunction::Create(parametric::TableBundle());
  ASSERT_TRUE(table.ok()) << table.status();
  std::mt19937 random(9);
  for (int trial = 0; trial < 10; ++trial) {
    Eigen::VectorXd q = table->Defaults();
    if (trial > 0) {
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        const auto& parameter = table->parameters()[static_cast<std::size_t>(i)];
        q(i) = std::uniform_real_distribution<double>(parameter.minimum, parameter.maximum)(random);
      }
    }
    const auto design = table->Evaluate(q);
    ASSERT_TRUE(design.ok()) << design.status();
    const auto surface = FuseAssembly(parametric::PartShapes(*design));
    ASSERT_TRUE(surface.ok()) << surface.status() << " at " << q.transpose();
    ASSERT_EQ(surface->part_names.size(), 9u);
    ExpectConforming(*surface);
    std::map<std::string, int> pieces;
    for (const mesh::AssemblyFace& face : surface->faces) {
      ASSERT_GE(face.origins.size(), 1u);
      ASSERT_LE(face.origins.size(), 2u);
      EXPECT_EQ(face.origins.size(), face.front_part >= 0 ? 2u : 1u);
      for (const auto& origin : face.origins) {
        if (origin.part == 8) ++pieces[origin.name];
      }
    }
    EXPECT_EQ(pieces["cap"], 1);
    EXPECT_GE(pieces["base"], 9);  // under four legs, four aprons, and what is left
    for (int part = 0; part < 9; ++part) {
      ExpectClosed(*surface, part);
      EXPECT_NEAR(PartVolume(*surface, part), design->parts[static_cast<std::size_t>(part)].volume,
                  1e-12);
      const Eigen::Vector3d inside = surface->part_interior.col(part);
      const auto& evaluated = design->parts[static_cast<std::size_t>(part)];
      EXPECT_GT((inside - evaluated.minimum).minCoeff(), 1e-3);
      EXPECT_GT((evaluated.maximum - inside).minCoeff(), 1e-3);
    }
  }
}

}  // namespace
}  // namespace mortise::cad
