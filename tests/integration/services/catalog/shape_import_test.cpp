// Shapes from files of their own: given to items, repaired, and refused with places where they
// bound no solid.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/step/step_reader.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/catalog/drawn_stool.h"
#include "tests/integration/services/catalog/shape_service_fixture.h"

namespace mortise::catalog {
namespace {

using testing::Call;
using ::testing::HasSubstr;
using testing::Prepare;
using ::testing::UnorderedElementsAre;

// A tetrahedron as text, in millimetres; `faces` of its four corners, and of one beside it.
std::string Tetrahedron(const std::vector<std::array<int, 3>>& faces) {
  const char* const corners[] = {"0 0 0", "40 0 0", "0 40 0", "0 0 40", "30 -20 10"};
  std::string text = "solid t\n";
  for (const auto& face : faces) {
    absl::StrAppend(&text, "facet normal 0 0 0\nouter loop\n");
    for (const int corner : face) absl::StrAppend(&text, "vertex ", corners[corner], "\n");
    absl::StrAppend(&text, "endloop\nendfacet\n");
  }
  return text + "endsolid t\n";
}

TEST_F(ShapeServiceTest, IsOfItemsToo) {
  const auto shape = ImportShape(Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}),
                                 v1::ImportShapeRequest::STL);
  ASSERT_TRUE(shape.ok()) << shape.status();
  EXPECT_NEAR(shape->volume(), 0.04 * 0.04 * 0.04 / 6, 1e-12);
  EXPECT_FALSE(shape->exact());
  v1::CreateMaterialRequest material;
  material.set_request_id(NextId());
  *material.mutable_material() = Parse<v1::Material>(
      "name: 'materials/steel' density: 7850 youngs_modulus: 2e11 poissons_ratio: 0.3 strength: "
      "2e8");
  ASSERT_TRUE(Call(*catalog_, &v1::CatalogService::Stub::CreateMaterial, material).ok());
  v1::CreateItemRequest item;
  item.set_request_id(NextId());
  *item.mutable_item() = Parse<v1::Item>(absl::StrCat(
      "name: 'items/gusset' kind: BRACKET material: 'materials/steel' shape: '", shape->name(),
      "' dimensions { axis: X size: 0.04 } dimensions { axis: Y size: 0.04 } dimensions { axis: Z "
      "size: 0.03 } price { currency: 'EUR' amount: 1 } price_basis: PER_PIECE price_date: "
      "'2026-01-15' supplier: 'Example' price_is_example: true"));
  EXPECT_THAT(FieldsOf(Call(*catalog_, &v1::CatalogService::Stub::CreateItem, item).status()),
              UnorderedElementsAre("item.shape"))
      << "another thickness";
  item.mutable_item()->mutable_dimensions(2)->set_size(0.04);
  item.set_request_id(NextId());
  const auto created = Call(*catalog_, &v1::CatalogService::Stub::CreateItem, item);
  ASSERT_TRUE(created.ok()) << created.status();
  v1::ImportAssemblyRequest import;
  import.set_request_id(NextId());
  *import.mutable_assembly() = Parse<v1::Assembly>(
      "name: 'assemblies/corner' parts { name: 'gusset' item: 'items/gusset' length_axis: Y "
      "thickness_axis: Z position { x: 0 y: 0 z: 0 } } parts { name: 'plate' position { z: -0.01 } "
      "size { x: 0.04 y: 0.04 z: 0.01 } }");
  const auto assembly = Call(*assemblies_, &v1::AssemblyService::Stub::ImportAssembly, import);
  ASSERT_TRUE(assembly.ok()) << assembly.status();
  const auto step = Export("name: 'assemblies/corner' format: STEP");
  ASSERT_TRUE(step.ok()) << step.status();
  const auto read = cad::ReadStep(*step);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_NEAR(PartOf(*read, "gusset").volume, shape->volume(), 1e-6 * shape->volume());
  import.mutable_assembly()->mutable_parts(1)->set_shape("shapes/none");
  import.set_request_id(NextId());
  import.set_expected_revision(1);
  EXPECT_THAT(
      FieldsOf(Call(*assemblies_, &v1::AssemblyService::Stub::ImportAssembly, import).status()),
      UnorderedElementsAre("assembly.parts[1].shape"));
}

TEST_F(ShapeServiceTest, RepairsStlAndSaysWhat) {
  using Request = v1::ImportShapeRequest;
  const auto good =
      ImportShape(Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}), Request::STL);
  ASSERT_TRUE(good.ok()) << good.status();
  EXPECT_EQ(good->notes_size(), 0);
  // Without a face, inside out, and with a face twice, it is the same solid.
  const std::map<std::string, std::string> damaged = {
      {"filled 1 hole, up to 69.28 mm across", Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}})},
      {"turned 4 triangles around", Tetrahedron({{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}})},
      {"dropped 1 triangle drawn more than once",
       Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 1, 3}})}};
  for (const auto& [note, file] : damaged) {
    const auto repaired = ImportShape(file, Request::STL);
    ASSERT_TRUE(repaired.ok()) << repaired.status();
    EXPECT_NEAR(repaired->volume(), good->volume(), 1e-12);
    ASSERT_EQ(repaired->notes_size(), 1) << note;
    EXPECT_EQ(repaired->notes(0), note);
    EXPECT_EQ(Shape(repaired->name()).notes_size(), 0) << "they are of the file";
  }
}

TEST_F(ShapeServiceTest, RefusesWhatIsNoSolidAndStoresNothing) {
  using Request = v1::ImportShapeRequest;
  // Two of its four faces: a hole as large as what is left.
  const std::string open = Tetrahedron({{0, 2, 1}, {0, 1, 3}});
  const std::string fin = Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 1, 4}});
  const absl::Status not_closed = ImportShape(open, Request::STL).status();
  EXPECT_THAT(std::string(not_closed.message()), HasSubstr(" mm")) << "the place";
  EXPECT_THAT(std::string(ImportShape(fin, Request::STL).status().message()),
              HasSubstr("more than two triangles meet at an edge at ("));
  for (const std::string& file :
       {open, fin, std::string("solid t\n"), std::string("no file"), std::string(84, '\0'),
        std::string(), std::string("\x1f\x8b no gzip"), std::string("solid\nvertex 1 x 2")}) {
    const absl::Status status = ImportShape(file, Request::STL).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    for (const std::string& field : FieldsOf(status)) EXPECT_EQ(field, "file");
  }
  EXPECT_EQ(DetailOf(ImportShape("x", Request::FORMAT_UNSPECIFIED).status()).field, "format");
  EXPECT_EQ(DetailOf(ImportShape(Stool(), Request::STEP).status()).field, "file") << "five solids";
  EXPECT_EQ(DetailOf(ImportShape("ISO-10303-21;", Request::STEP).status()).field, "file");
  // The first shape that the catalog tells of is the first that is good.
  const auto good =
      ImportShape(Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}), Request::STL);
  ASSERT_TRUE(good.ok()) << good.status();
  const auto events = v1::EventService::NewStub(process_.channel());
  v1::FollowEventsRequest follow;
  follow.add_type_prefixes("shape.");
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto reader = events->FollowEvents(&context, follow);
  v1::Event event;
  ASSERT_TRUE(reader->Read(&event));
  EXPECT_EQ(event.subject(), good->name());
  context.TryCancel();
  v1::GetShapeRequest get;
  get.set_name("shapes/" + std::string(64, '0'));
  EXPECT_EQ(Call(*catalog_, &v1::CatalogService::Stub::GetShape, get).status().code(),
            absl::StatusCode::kNotFound);
  get.set_name("shapes/../x");
  EXPECT_EQ(DetailOf(Call(*catalog_, &v1::CatalogService::Stub::GetShape, get).status()).field,
            "name");
}

}  // namespace
}  // namespace mortise::catalog
