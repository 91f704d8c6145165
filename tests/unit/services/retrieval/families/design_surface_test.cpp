#include "services/retrieval/families/design_surface.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"

namespace mortise::retrieval {
namespace {

// A box from the origin of so many metres along each axis, as a prism along z.
parametric::EvaluatedPart Box(const std::string& name, double size) {
  parametric::EvaluatedPart part;
  part.name = name;
  part.outline.resize(2, 4);
  part.outline << 0, size, size, 0, 0, 0, size, size;
  part.to = size;
  return part;
}

parametric::EvaluatedDesign TwoBoxes() {
  parametric::EvaluatedDesign design;
  design.parts = {Box("small", 1), Box("large", 2)};
  return design;
}

TEST(DesignSurfaceTest, HasTheTrianglesOfAllParts) {
  const mesh::SurfaceMesh surface = DesignSurface(TwoBoxes());
  EXPECT_EQ(surface.vertices.cols(), 16);
  EXPECT_EQ(surface.triangles.cols(), 24);
  EXPECT_EQ(surface.triangles.leftCols(12).maxCoeff(), 7);
  EXPECT_EQ(surface.triangles.rightCols(12).minCoeff(), 8);
  EXPECT_EQ(surface.vertices.leftCols(8).maxCoeff(), 1);
  EXPECT_EQ(surface.vertices.rightCols(8).maxCoeff(), 2);
}

TEST(DesignSurfaceTest, HasThoseOfThePartsThatAreNamed) {
  const auto large = DesignSurface(TwoBoxes(), {"large"});
  ASSERT_TRUE(large.ok()) << large.status();
  EXPECT_EQ(large->vertices.cols(), 8);
  EXPECT_EQ(large->vertices.maxCoeff(), 2);
  const absl::Status none = DesignSurface(TwoBoxes(), {"large", "other"}).status();
  EXPECT_TRUE(absl::IsNotFound(none));
  EXPECT_EQ(DetailOf(none).field, "other");
}

}  // namespace
}  // namespace mortise::retrieval
