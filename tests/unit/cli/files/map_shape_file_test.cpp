// Designs of maps as files: what is in them, and answers that are not whole.
#include "cli/files/map_shape_file.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/base/errors.h"

namespace mortise::cli {
namespace {

template <typename Number>
std::string Bytes(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

v1::DesignMap Map() {
  v1::DesignMap map;
  map.set_name("maps/m");
  v1::MapShapes::Field& stress = *map.mutable_shapes()->add_fields();
  stress.set_name("stress");
  stress.set_unit("Pa");
  stress.set_load_case("pull");
  stress.set_components(1);
  v1::MapShapes::Field& heat = *map.mutable_shapes()->add_fields();
  heat.set_name("heat");
  heat.set_unit("K");
  heat.set_components(3);
  heat.set_of_elements(true);
  return map;
}

// One tetrahedron with both fields.
v1::MapShape Shape() {
  v1::MapShape shape;
  shape.set_positions(Bytes<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}));
  v1::MapMesh& mesh = *shape.mutable_new_mesh();
  mesh.set_triangles(Bytes<int>({0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2}));
  mesh.set_tetrahedra(Bytes<int>({0, 1, 2, 3}));
  mesh.set_parts(Bytes<int>({0, 0, 0, 0, 0}));
  mesh.add_part_names("body");
  v1::MapFieldValues& stress = *shape.add_fields();
  stress.set_name("stress");
  stress.set_load_case("pull");
  stress.set_values(Bytes<float>({1, 2, 3, 4}));
  v1::MapFieldValues& heat = *shape.add_fields();
  heat.set_name("heat");
  heat.set_values(Bytes<float>({5, 6, 7}));
  return shape;
}

TEST(MapShapeFileTest, HasElementsAndFieldsWithTheirUnits) {
  const std::string file = WriteShapeFile(Map(), Shape(), ShapeFormat::kVtu).value();
  EXPECT_NE(file.find("NumberOfCells=\"1\""), std::string::npos);
  EXPECT_NE(file.find("\"stress (Pa), pull\""), std::string::npos);
  EXPECT_NE(file.find("\"heat (K)\""), std::string::npos);
  v1::MapShape surface = Shape();
  surface.mutable_new_mesh()->clear_tetrahedra();
  surface.mutable_new_mesh()->set_parts(Bytes<int>({0, 0, 0, 0}));
  surface.mutable_fields()->RemoveLast();
  EXPECT_NE(WriteShapeFile(Map(), surface, ShapeFormat::kVtu)->find("NumberOfCells=\"4\""),
            std::string::npos);
  // Header, count, four triangles.
  EXPECT_EQ(WriteShapeFile(Map(), surface, ShapeFormat::kStl)->size(), 80u + 4 + 4 * 50);
}

TEST(MapShapeFileTest, GoesByTheNameOfTheFile) {
  EXPECT_EQ(ShapeFormatOf("a/table.VTU").value(), ShapeFormat::kVtu);
  EXPECT_EQ(ShapeFormatOf("table.stl").value(), ShapeFormat::kStl);
  EXPECT_EQ(DetailOf(ShapeFormatOf("table.obj").status()).field, "--output");
}

TEST(MapShapeFileTest, RefusesNumbersThatAreNotThoseOfTheMesh) {
  v1::MapShape shape = Shape();
  shape.mutable_positions()->pop_back();
  EXPECT_EQ(DetailOf(WriteShapeFile(Map(), shape, ShapeFormat::kVtu).status()).field, "positions");
  shape = Shape();
  shape.mutable_new_mesh()->set_tetrahedra(Bytes<int>({0, 1, 2, 4}));
  EXPECT_EQ(DetailOf(WriteShapeFile(Map(), shape, ShapeFormat::kVtu).status()).field, "new_mesh");
  shape = Shape();
  shape.mutable_new_mesh()->set_parts(Bytes<int>({0}));
  EXPECT_EQ(DetailOf(WriteShapeFile(Map(), shape, ShapeFormat::kVtu).status()).field,
            "new_mesh.parts");
  shape = Shape();
  shape.mutable_fields(0)->set_values(Bytes<float>({1, 2}));
  EXPECT_FALSE(WriteShapeFile(Map(), shape, ShapeFormat::kVtu).ok());
}

}  // namespace
}  // namespace mortise::cli
