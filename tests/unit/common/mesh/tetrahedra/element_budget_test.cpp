// Meshes of thin boards that stay within a budget of elements, and those that need none.
#include "common/mesh/tetrahedra/element_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "tests/support/mesh_quality.h"
#include "tests/unit/common/mesh/box_assembly.h"

namespace mortise::mesh {
namespace {

constexpr int kFew = 4000;

// A thin back with two thicker boards before it, as a shelf has: well-shaped elements are as wide
// as the back is thick.
AssemblySurface Shelf() {
  return AssembleBoxes({{"back", {0, 0.3, 0}, {0.9, 0.308, 0.8}},
                        {"lower", {0.02, 0, 0.1}, {0.88, 0.3, 0.118}},
                        {"upper", {0.02, 0, 0.5}, {0.88, 0.3, 0.518}}});
}

TEST(ElementBudget, LeavesMeshesWithinItAsTheyAre) {
  for (const bool quadratic : {false, true}) {
    const MeshOptions options{.quadratic = quadratic};
    const auto plain = MeshAssembly(TestTable(), options);
    const auto budgeted = MeshWithinBudget(TestTable(), options, {kQuadraticBudget});
    ASSERT_TRUE(plain.ok() && budgeted.ok()) << plain.status() << budgeted.status();
    EXPECT_EQ(budgeted->mesh.nodes, plain->nodes);
    EXPECT_EQ(budgeted->mesh.tetrahedra, plain->tetrahedra);
    EXPECT_EQ(budgeted->chosen_size, 0);
    EXPECT_FALSE(budgeted->is_beyond);
    EXPECT_EQ(budgeted->wanted_size, DefaultElementSize(TestTable()));
  }
}

TEST(ElementBudget, BoundsTheElementsOfThinBoards) {
  const AssemblySurface shelf = Shelf();
  const auto plain = MeshAssembly(shelf, {.quadratic = false});
  ASSERT_TRUE(plain.ok()) << plain.status();
  ASSERT_GT(plain->tetrahedra.cols(), 5 * kFew);
  const auto budgeted = MeshWithinBudget(shelf, {}, {kFew});
  ASSERT_TRUE(budgeted.ok()) << budgeted.status();
  const TetrahedralMesh& mesh = budgeted->mesh;
  EXPECT_LE(mesh.tetrahedra.cols(), kFew);
  EXPECT_GT(mesh.tetrahedra.cols(), kFew / 4) << "nor is it coarser than it must be";
  EXPECT_GT(budgeted->chosen_size, 0.008);
  EXPECT_TRUE(mesh.IsQuadratic());
  for (int p = 0; p < 3; ++p) {
    const double volume = ComputeMassProperties(PartSurface(shelf, p)).volume;
    EXPECT_NEAR(ComputeMassProperties(mesh, p).volume, volume, 1e-9 * volume);
    EXPECT_TRUE(IsWatertight({mesh.nodes, OuterTriangles(mesh, p)})) << p;
  }
  const testing::QualityReport quality = testing::MeasureQuality(mesh);
  EXPECT_GT(quality.minimum_volume, 0);
  EXPECT_GT(quality.minimum_dihedral, 0.01) << ToText(quality);
}

TEST(ElementBudget, GivesTheSameMeshAgain) {
  const auto one = MeshWithinBudget(Shelf(), {}, {kFew});
  const auto other = MeshWithinBudget(Shelf(), {}, {kFew});
  ASSERT_TRUE(one.ok() && other.ok());
  EXPECT_EQ(one->mesh.nodes, other->mesh.nodes);
  EXPECT_EQ(one->mesh.tetrahedra, other->mesh.tetrahedra);
}

TEST(ElementBudget, ScalesTheSizeThatItAllows) {
  const auto plain = MeshWithinBudget(Shelf(), {}, {.elements = kFew});
  const auto finer = MeshWithinBudget(Shelf(), {}, {.elements = kFew, .size_scale = 0.8});
  ASSERT_TRUE(plain.ok() && finer.ok());
  EXPECT_LT(finer->chosen_size, 0.9 * plain->chosen_size);
  EXPECT_GT(finer->mesh.tetrahedra.cols(), plain->mesh.tetrahedra.cols());
}

TEST(ElementBudget, EstimatesWhatComesOut) {
  const std::vector<AssemblySurface> assemblies = {
      Shelf(), AssembleBoxes({{"block", {0, 0, 0}, {1, 0.7, 0.8}}})};
  for (const AssemblySurface& assembly : assemblies) {
    for (const int elements : {1500, 2500}) {
      const auto budgeted = MeshWithinBudget(assembly, {.quadratic = false}, {elements});
      ASSERT_TRUE(budgeted.ok()) << budgeted.status();
      ASSERT_GT(budgeted->chosen_size, 0);
      const double expected = EstimateWideElements(assembly, budgeted->chosen_size);
      const auto made = static_cast<double>(budgeted->mesh.tetrahedra.cols());
      EXPECT_GT(made, expected / 2) << elements;
      EXPECT_LT(made, expected * 2) << elements;
    }
  }
}

TEST(ElementBudget, FailsAsMeshingDoes) {
  AssemblySurface open = TestTable();
  open.triangles.conservativeResize(Eigen::NoChange, open.triangles.cols() - 1);
  open.triangle_face.conservativeResize(open.triangle_face.size() - 1);
  EXPECT_EQ(MeshWithinBudget(open, {}, {}).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(MeshWithinBudget(TestTable(), {.element_size = -1}, {}).status().code(),
            absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace mortise::mesh
