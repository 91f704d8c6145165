// Templates in the catalog: what ships, designs and files of every kind, revisions.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/catalog/catalog_service_fixture.h"

namespace mortise::catalog {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST_F(CatalogServiceTest, ShipsACollection) {
  v1::ListTemplatesRequest request;
  v1::ListTemplatesResponse response;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::ListTemplates, request, &response).ok());
  ASSERT_GE(response.templates_size(), 1);
  const v1::Template table = GetTemplate("templates/table");
  EXPECT_EQ(table.revision(), 1);
  EXPECT_EQ(table.digest().size(), 64u);
  EXPECT_GT(table.create_time().seconds(), 0);
  EXPECT_EQ(table.parts_size(), 9);
  for (const v1::Template& listed : response.templates()) EXPECT_EQ(listed.parts_size(), 0);

  v1::GetTemplateBundleRequest bundle_request;
  bundle_request.set_name("templates/table");
  v1::TemplateBundle bundle;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::GetTemplateBundle, bundle_request, &bundle).ok());
  EXPECT_EQ(bundle.items_size(), 3);
  EXPECT_EQ(bundle.materials_size(), 3);
  EXPECT_EQ(bundle.template_().digest(), table.digest());

  v1::GetMaterialRequest material_request;
  material_request.set_name("materials/spruce");
  v1::Material spruce;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::GetMaterial, material_request, &spruce).ok());
  EXPECT_EQ(spruce.density(), 420);
}

// Whatever somebody imports as that, it is said of what the template has.
TEST_F(CatalogServiceTest, ListsSayWhatTemplatesLackToBeAnalysed) {
  v1::Template bare = GetTemplate("templates/table");
  bare.set_name("templates/bare-table");
  bare.clear_boundary_conditions();
  bare.add_analysis_lacks("courage");
  v1::Template imported;
  ASSERT_TRUE(
      Call(&v1::CatalogService::Stub::ImportTemplate, ImportRequest(bare, 0), &imported).ok());
  EXPECT_EQ(imported.analysis_lacks_size(), 0);
  v1::ListTemplatesRequest request;
  request.set_text("table");
  v1::ListTemplatesResponse response;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::ListTemplates, request, &response).ok());
  std::map<std::string, v1::Template> listed;
  for (const v1::Template& message : response.templates()) listed[message.name()] = message;
  EXPECT_THAT(listed["templates/bare-table"].analysis_lacks(), ElementsAre("supports", "loads"));
  EXPECT_EQ(listed["templates/table"].analysis_lacks_size(), 0);
}

TEST_F(CatalogServiceTest, EvaluatesTheTable) {
  v1::EvaluateTemplateRequest request;
  request.set_name("templates/table");
  auto* length = request.add_parameters();
  length->set_name("length");
  length->set_value(1.6004);  // a workshop sets millimetres
  v1::EvaluatedDesign design;
  const grpc::Status status = Call(&v1::CatalogService::Stub::EvaluateTemplate, request, &design);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(design.parts_size(), 9);
  EXPECT_EQ(design.template_revision(), 1);
  ASSERT_EQ(design.parameters_size(), 6);
  EXPECT_NEAR(design.parameters(0).value(), 1.6, 1e-12);
  EXPECT_NEAR(design.parts(8).size().x(), 1.6, 1e-12);
  EXPECT_GT(design.connectors_size(), 30);
  EXPECT_EQ(design.boundary_conditions_size(), 5);
}

TEST_F(CatalogServiceTest, ExportsStepAndGlb) {
  v1::ExportDesignRequest request;
  request.set_name("templates/table");
  request.set_format(v1::ExportDesignRequest::STEP);
  v1::Chunk first;
  const auto step = Export(request, &first);
  ASSERT_TRUE(step.ok()) << step.status();
  EXPECT_EQ(first.file_name(), "table.step");
  const auto assembly = cad::ReadStep(*step);
  ASSERT_TRUE(assembly.ok()) << assembly.status();
  ASSERT_EQ(assembly->parts.size(), 9u);
  EXPECT_EQ(assembly->parts[8].name, "top");

  request.set_format(v1::ExportDesignRequest::GLB);
  const auto glb = Export(request, &first);
  ASSERT_TRUE(glb.ok()) << glb.status();
  EXPECT_EQ(glb->substr(0, 4), "glTF");
  EXPECT_EQ(first.media_type(), "model/gltf-binary");
}

// A cube in a cage that is a cube itself, and grows in width.
constexpr char kBlock[] = R"(name: "templates/block" cage {
  name: "templates/block" title: "Block" material: "materials/beech"
  parameters { name: "width" unit: "m" minimum: 0.1 maximum: 0.4 default_value: 0.1 }
  surface {
    vertices: [0.02, 0.02, 0.02, 0.08, 0.02, 0.02, 0.02, 0.08, 0.02, 0.08, 0.08, 0.02,
               0.02, 0.02, 0.08, 0.08, 0.02, 0.08, 0.02, 0.08, 0.08, 0.08, 0.08, 0.08]
    faces { name: "all" triangles: [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5] }
  }
  cage {
    vertices { x: "0" y: "0" z: "0" } vertices { x: "width" y: "0" z: "0" }
    vertices { x: "0" y: "0.1" z: "0" } vertices { x: "width" y: "0.1" z: "0" }
    vertices { x: "0" y: "0" z: "0.1" } vertices { x: "width" y: "0" z: "0.1" }
    vertices { x: "0" y: "0.1" z: "0.1" } vertices { x: "width" y: "0.1" z: "0.1" }
    triangles: [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5]
  }
})";

TEST_F(CatalogServiceTest, ExportsAMeshInACage) {
  v1::Template block;
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(kBlock, &block));
  const grpc::Status stored =
      Call(&v1::CatalogService::Stub::ImportTemplate, ImportRequest(block, 0), &block);
  ASSERT_TRUE(stored.ok()) << stored.error_message();
  v1::ExportDesignRequest request;
  request.set_name("templates/block");
  auto* width = request.add_parameters();
  width->set_name("width");
  width->set_value(0.2);
  request.set_format(v1::ExportDesignRequest::STEP);
  v1::Chunk first;
  const auto step = Export(request, &first);
  ASSERT_TRUE(step.ok()) << step.status();
  const auto read = cad::ReadStep(*step);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->parts.size(), 1u);
  EXPECT_EQ(read->parts[0].name, "block");
  EXPECT_TRUE(read->parts[0].is_box) << "of planes";
  EXPECT_NEAR(read->parts[0].volume, 0.12 * 0.06 * 0.06, 1e-6 * 0.12 * 0.06 * 0.06);
  EXPECT_NEAR(read->parts[0].maximum.x(), 0.16, 1e-6);

  request.set_format(v1::ExportDesignRequest::STL);
  const auto stl = Export(request, &first);
  ASSERT_TRUE(stl.ok()) << stl.status();
  EXPECT_EQ(stl->size(), 84u + 12u * 50u);
}

TEST_F(CatalogServiceTest, TemplatesOfEveryKindAreListedAndEvaluated) {
  v1::ListTemplatesRequest list;
  list.set_page_size(100);
  v1::ListTemplatesResponse listed;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::ListTemplates, list, &listed).ok());
  std::map<v1::Template::KindCase, int> kinds;
  for (const v1::Template& message : listed.templates()) {
    ++kinds[message.kind_case()];
    EXPECT_FALSE(message.title().empty()) << message.name();
    EXPECT_GE(message.parameters_size(), 1) << message.name();
  }
  EXPECT_GE(kinds[v1::Template::KIND_NOT_SET], 1);
  EXPECT_GE(kinds[v1::Template::kAssembly], 14);
  EXPECT_GE(kinds[v1::Template::kCad], 9);
  EXPECT_GE(kinds[v1::Template::kCage], 1);

  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name("templates/wrench");
  auto* length = evaluate.add_parameters();
  length->set_name("handle_length");
  length->set_value(0.2);
  v1::EvaluatedDesign wrench;
  grpc::Status status = Call(&v1::CatalogService::Stub::EvaluateTemplate, evaluate, &wrench);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(wrench.parts_size(), 1);
  EXPECT_EQ(wrench.parts(0).material(), "materials/steel");
  EXPECT_GT(wrench.parts(0).faceted().triangles_size(), 300);
  EXPECT_GT(wrench.mass(), 0.05);

  v1::EvaluatedDesign shelf;
  evaluate.Clear();
  evaluate.set_name("templates/bookshelf");
  status = Call(&v1::CatalogService::Stub::EvaluateTemplate, evaluate, &shelf);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_GT(shelf.parts_size(), 10);
  EXPECT_GT(shelf.mass(), 1);
}

TEST_F(CatalogServiceTest, ExportsASolidOfFeaturesExactly) {
  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name("templates/wrench");
  v1::EvaluatedDesign wrench;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::EvaluateTemplate, evaluate, &wrench).ok());
  v1::ExportDesignRequest request;
  request.set_name("templates/wrench");
  request.set_format(v1::ExportDesignRequest::STEP);
  v1::Chunk first;
  const auto step = Export(request, &first);
  ASSERT_TRUE(step.ok()) << step.status();
  const auto read = cad::ReadStep(*step);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->parts.size(), 1u);
  EXPECT_NEAR(read->parts[0].volume / wrench.parts(0).volume(), 1, 1e-6);
  request.set_format(v1::ExportDesignRequest::GLB);
  EXPECT_TRUE(Export(request, &first).ok());
}

TEST_F(CatalogServiceTest, ImportsTemplatesOfEveryKindOrSaysWhyNot) {
  using Stub = v1::CatalogService::Stub;
  v1::Template wrench = GetTemplate("templates/wrench");
  wrench.set_name("templates/spanner");
  wrench.mutable_cad()->clear_name();
  wrench.mutable_cad()->mutable_definitions(0)->set_value("0.017");
  v1::Template spanner;
  ASSERT_TRUE(Call(&Stub::ImportTemplate, ImportRequest(wrench, 0), &spanner).ok());
  EXPECT_EQ(spanner.cad().name(), "templates/spanner");
  EXPECT_NE(spanner.digest(), GetTemplate("templates/wrench").digest());
  wrench.set_name("templates/broken");
  wrench.mutable_cad()->mutable_features(0)->set_name("");
  wrench.mutable_cad()->mutable_definitions(0)->set_value("1 / 0");
  const Failure broken = Fail(&Stub::ImportTemplate, ImportRequest(wrench, 0));
  EXPECT_EQ(broken.code, absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(broken.message, HasSubstr("template.cad.features[0].name"));
  EXPECT_THAT(broken.message, HasSubstr("template.cad.definitions[0].value"));
  // Numbers that are none are told with all else, each once.
  wrench.mutable_cad()->mutable_parameters(0)->set_minimum(std::nan(""));
  wrench.mutable_cad()->mutable_parameters(1)->set_maximum(INFINITY);
  const Failure worse = Fail(&Stub::ImportTemplate, ImportRequest(wrench, 0));
  for (const char* field :
       {"5 findings", "template.cad.parameters[0].minimum", "template.cad.parameters[1].maximum",
        "template.cad.features[0].name", "template.cad.definitions[0].value"}) {
    EXPECT_THAT(worse.message, HasSubstr(field));
  }

  v1::Template shelf;
  shelf.set_name("templates/narrow-shelf");
  shelf.mutable_assembly()->set_assembly("assemblies/bookshelf");
  v1::Template stored;
  ASSERT_TRUE(Call(&Stub::ImportTemplate, ImportRequest(shelf, 0), &stored).ok());
  EXPECT_EQ(stored.assembly().revision(), 1);
  EXPECT_EQ(stored.assembly().handles_size(), stored.parameters_size());
  // What the service filled in may be sent back; it is the same content then.
  v1::Template again;
  ASSERT_TRUE(Call(&Stub::ImportTemplate, ImportRequest(stored, 1), &again).ok());
  EXPECT_EQ(again.revision(), 1);
  shelf.mutable_assembly()->set_assembly("assemblies/none");
  EXPECT_EQ(Fail(&Stub::ImportTemplate, ImportRequest(shelf, 1)).field,
            "template.assembly.assembly");
  shelf.mutable_assembly()->set_assembly("assemblies/bookshelf");
  shelf.mutable_assembly()->set_revision(7);
  EXPECT_EQ(Fail(&Stub::ImportTemplate, ImportRequest(shelf, 1)).field,
            "template.assembly.revision");
}

// A group of an assembly by itself, through all that is asked of templates.
TEST_F(CatalogServiceTest, SubTreesAreTemplates) {
  using Stub = v1::CatalogService::Stub;
  v1::Template shelves;
  shelves.set_name("templates/shelves");
  shelves.mutable_assembly()->set_assembly("assemblies/bookshelf");
  shelves.mutable_assembly()->set_group("chimney");
  EXPECT_EQ(Fail(&Stub::ImportTemplate, ImportRequest(shelves, 0)).field,
            "template.assembly.group");
  shelves.mutable_assembly()->set_group("shelves");
  v1::Template stored;
  ASSERT_TRUE(Call(&Stub::ImportTemplate, ImportRequest(shelves, 0), &stored).ok());
  EXPECT_EQ(stored.assembly().group(), "shelves");
  EXPECT_THAT(stored.title(), HasSubstr(": shelves"));
  v1::GetTemplateBundleRequest asked;
  asked.set_name(stored.name());
  v1::TemplateBundle bundle;
  ASSERT_TRUE(Call(&Stub::GetTemplateBundle, asked, &bundle).ok());
  EXPECT_EQ(bundle.template_().assembly().group(), "shelves");
  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name(stored.name());
  v1::EvaluatedDesign design;
  ASSERT_TRUE(Call(&Stub::EvaluateTemplate, evaluate, &design).ok());
  EXPECT_EQ(design.parts_size(), 6);
  EXPECT_EQ(design.faults_size(), 0);
  EXPECT_EQ(design.structure().description(), "shelf 1: 6");
  // The whole has its sides and screws as before.
  evaluate.set_name("templates/bookshelf");
  ASSERT_TRUE(Call(&Stub::EvaluateTemplate, evaluate, &design).ok());
  EXPECT_GT(design.parts_size(), 20);
  EXPECT_EQ(design.structure().key().size(), 64u);
  EXPECT_THAT(design.structure().description(), HasSubstr("shelf 1: 6"));
}

// A slider before a wall with a narrow ridge, which it touches nowhere. Neither the ends of where
// it may stand nor the few places between them that are tried before a design is stored show that
// it runs into the ridge.
constexpr char kTrack[] = R"(name: "assemblies/track"
parts { name: "base" position { y: -0.01 z: -0.02 } size { x: 2 y: 0.05 z: 0.02 } }
parts { name: "wall" size { x: 2 y: 0.02 z: 0.03 } }
parts { name: "slider" position { x: 0.7 y: 0.015 } size { x: 0.001 y: 0.02 z: 0.02 } })";

// The shape of a prism, as the catalog has it.
absl::StatusOr<v1::Shape> ImportPrism(const mesh::PartShape& prism,
                                      v1::CatalogService::Stub& catalog) {
  MORTISE_ASSIGN_OR_RETURN(const cad::Solid solid, cad::Solid::FromPart(prism));
  v1::ImportShapeRequest request;
  request.set_request_id("prism");
  request.set_format(v1::ImportShapeRequest::STEP);
  MORTISE_ASSIGN_OR_RETURN(*request.mutable_file(), cad::WriteStep(prism.name, {{solid}}));
  return testing::Call(catalog, &v1::CatalogService::Stub::ImportShape, request);
}

template <typename Message>
Message Parse(const std::string& text) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

// As AssemblyService tells of the assembly's own designs.
TEST_F(CatalogServiceTest, TellsTheFaultsOfATemplatesDesign) {
  mesh::PartShape ridge;
  ridge.name = "wall";
  ridge.height = 0.03;
  ridge.outline.resize(2, 7);
  ridge.outline << 0, 2, 2, 0.3005, 0.3, 0.2995, 0, 0, 0, 0.01, 0.01, 0.02, 0.01, 0.01;
  for (int i = 0; i < 9; ++i) ridge.face_names.push_back("face" + std::to_string(i));
  const auto wall = ImportPrism(ridge, *stub_);
  ASSERT_TRUE(wall.ok()) << wall.status();
  v1::ImportAssemblyRequest track;
  track.set_request_id(NewRequestId());
  *track.mutable_assembly() = Parse<v1::Assembly>(kTrack);
  track.mutable_assembly()->mutable_parts(1)->set_shape(wall->name());
  const auto assemblies = v1::AssemblyService::NewStub(process_.channel());
  const auto drawn = testing::Call(*assemblies, &v1::AssemblyService::Stub::ImportAssembly, track);
  ASSERT_TRUE(drawn.ok()) << drawn.status();
  const auto message = Parse<v1::Template>(
      "name: 'templates/track' assembly { assembly: 'assemblies/track' "
      "handles { parameter: 'place' measure { element: 'slider' axis: X kind: CENTER } } }");
  const auto stored =
      testing::Call(*stub_, &v1::CatalogService::Stub::ImportTemplate, ImportRequest(message, 0));
  ASSERT_TRUE(stored.ok()) << stored.status();
  const auto evaluate = [this](const std::string& asked) {
    return testing::Call(*stub_, &v1::CatalogService::Stub::EvaluateTemplate,
                         Parse<v1::EvaluateTemplateRequest>(asked));
  };
  const auto sound = evaluate("name: 'templates/track'");
  ASSERT_TRUE(sound.ok()) << sound.status();
  EXPECT_EQ(sound->faults_size(), 0);

  const std::string on_ridge = "name: 'templates/track' parameters { name: 'place' value: 0.3 } ";
  const auto crowded = evaluate(on_ridge);
  ASSERT_TRUE(crowded.ok()) << crowded.status();
  EXPECT_THAT(crowded->faults(), ElementsAre(AllOf(HasSubstr("'wall'"), HasSubstr("'slider'"))));
  const auto bytes = Export(Parse<v1::ExportDesignRequest>(on_ridge + "format: DESIGN"));
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  v1::EvaluatedDesign whole;
  ASSERT_TRUE(whole.ParseFromString(*bytes));
  EXPECT_EQ(whole.SerializeAsString(), crowded->SerializeAsString());

  const auto unseen = evaluate(on_ridge + "without_faults: true");
  ASSERT_TRUE(unseen.ok()) << unseen.status();
  EXPECT_EQ(unseen->faults_size(), 0);
  EXPECT_EQ(unseen->parts_size(), crowded->parts_size());
}

TEST_F(CatalogServiceTest, KeepsRevisionsAsTheyWere) {
  v1::Template table = GetTemplate("templates/table");
  table.mutable_parameters(0)->set_maximum(1.9);
  v1::Template second;
  const auto request = ImportRequest(table, 1);
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::ImportTemplate, request, &second).ok());
  EXPECT_EQ(second.revision(), 2);
  EXPECT_NE(second.digest(), table.digest());

  // The same request again gets the same answer; another one on the old revision is refused.
  v1::Template repeated;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::ImportTemplate, request, &repeated).ok());
  EXPECT_EQ(repeated.revision(), 2);
  table.mutable_parameters(0)->set_maximum(1.8);
  const Failure stale = Fail(&v1::CatalogService::Stub::ImportTemplate, ImportRequest(table, 1));
  EXPECT_EQ(stale.code, absl::StatusCode::kAborted);
  EXPECT_EQ(stale.reason, "STALE_REVISION");

  // Importing what is there already changes nothing.
  v1::Template same;
  ASSERT_TRUE(
      Call(&v1::CatalogService::Stub::ImportTemplate, ImportRequest(second, 2), &same).ok());
  EXPECT_EQ(same.revision(), 2);

  EXPECT_EQ(GetTemplate("templates/table", 1).parameters(0).maximum(), 2.0);
  EXPECT_EQ(GetTemplate("templates/table").parameters(0).maximum(), 1.9);

  // A change of a material's item is not seen by revisions that exist.
  v1::UpdateItemRequest update;
  update.set_request_id(NewRequestId());
  *update.mutable_item() = GetItem("items/panel-spruce");
  update.mutable_item()->set_material("materials/beech");
  update.mutable_update_mask()->add_paths("material");
  v1::Item changed;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::UpdateItem, update, &changed).ok());
  EXPECT_EQ(changed.revision(), 2);
  EXPECT_EQ(changed.title(), update.item().title());
  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name("templates/table");
  v1::EvaluatedDesign before, after;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::EvaluateTemplate, evaluate, &before).ok());
  v1::Template third;
  ASSERT_TRUE(
      Call(&v1::CatalogService::Stub::ImportTemplate, ImportRequest(second, 2), &third).ok());
  EXPECT_EQ(third.revision(), 3);
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::EvaluateTemplate, evaluate, &after).ok());
  EXPECT_GT(after.mass(), before.mass());
}

}  // namespace
}  // namespace mortise::catalog
