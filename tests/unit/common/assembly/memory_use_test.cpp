// Estimates of memory: they see what is large, and shapes that parts share once.
#include "common/assembly/memory_use.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "common/assembly/parametric_assembly.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

// A box of triangles, with exact surfaces of this many bytes.
std::shared_ptr<const mesh::DrawnShape> ShapeWith(std::size_t brep) {
  mesh::SurfaceMesh surface;
  surface.vertices.resize(3, 8);
  surface.triangles.resize(3, 12);
  for (int k = 0; k < 8; ++k) surface.vertices.col(k) = Eigen::Vector3d(k & 1, k >> 1 & 1, k >> 2);
  surface.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,                   //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  mesh::DrawnShape shape = mesh::ShapeOfMesh(surface).value();
  shape.brep.assign(brep, 'x');
  return std::make_shared<const mesh::DrawnShape>(std::move(shape));
}

std::size_t MemoryOfTable(const std::shared_ptr<const mesh::DrawnShape>& first,
                          const std::shared_ptr<const mesh::DrawnShape>& second) {
  Assembly table = TwoLeggedTable();
  table.parts[0].shape = first;
  table.parts[1].shape = second;
  const auto made = ParametricAssembly::Create(std::move(table));
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? MemoryUse(*made) : 0;
}

TEST(MemoryUse, SeesWhatIsLargeInAShape) {
  const auto small = ShapeWith(0), large = ShapeWith(1'000'000);
  EXPECT_GE(MemoryUse(*small), std::size_t{8 * 24 + 12 * 16});
  EXPECT_LT(MemoryUse(*small), 10'000u);
  // A text of no letters has room for a few within itself.
  EXPECT_GE(MemoryUse(*large) + sizeof(std::string), MemoryUse(*small) + 1'000'000);
  EXPECT_LT(MemoryUse(*large), MemoryUse(*small) + 1'100'000);
}

TEST(MemoryUse, CountsASharedShapeOnce) {
  const auto large = ShapeWith(1'000'000);
  const std::size_t without = MemoryOfTable(nullptr, nullptr);
  const std::size_t shared = MemoryOfTable(large, large);
  const std::size_t apart = MemoryOfTable(large, ShapeWith(1'000'000));
  EXPECT_GT(without, 1'000u);
  EXPECT_LT(without, 1'000'000u);
  EXPECT_GE(shared, 1'000'000u);
  EXPECT_LT(shared, 2'000'000u);
  EXPECT_GE(apart, 2'000'000u);
  EXPECT_LT(apart, 3'000'000u);
}

}  // namespace
}  // namespace mortise::parametric
