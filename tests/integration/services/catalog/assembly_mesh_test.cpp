// Meshes to assemblies through the catalog as a process: everything that assemblies can do, and
// files that are none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "tests/integration/services/catalog/assembly_service_fixture.h"
#include "tests/support/box_scenes.h"

namespace mortise::catalog {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

class AssemblyMeshTest : public AssemblyServiceTest {
 protected:
  v1::ImportAssemblyMeshRequest Request(const std::string& file, const std::string& name) {
    v1::ImportAssemblyMeshRequest request;
    request.set_request_id(absl::StrCat("mesh-", ++requests_));
    request.set_file(file);
    request.set_file_name("table.obj");
    request.mutable_annotations()->set_name("assemblies/" + name);
    return request;
  }

  absl::StatusOr<v1::ImportAssemblyMeshResponse> Import(
      const v1::ImportAssemblyMeshRequest& request) {
    return Call(&Stub::ImportAssemblyMesh, request);
  }

  absl::StatusOr<std::string> Export(const std::string& name,
                                     v1::ExportDesignRequest::Format format) {
    v1::ExportAssemblyRequest request;
    request.set_name(name);
    request.set_format(format);
    grpc::ClientContext context;
    testing::Prepare(context);
    return testing::ReadChunks(*stub_->ExportAssembly(&context, request));
  }

  static std::string Table(double scale = 1) {
    return testing::ObjOf(testing::OneComponent(testing::TableParts()), scale);
  }
};

TEST_F(AssemblyMeshTest, BecomesAnAssemblyWithAllThatOneCanDo) {
  v1::ImportAssemblyMeshRequest request = Request(Table(100), "mesh-table");
  request.mutable_annotations()->add_external_ids("web-17");
  (*request.mutable_annotations()->mutable_labels())["site"] = "web";
  const auto imported = Import(request);
  ASSERT_TRUE(imported.ok()) << imported.status();
  const v1::Assembly& assembly = imported->assembly();
  EXPECT_EQ(assembly.parts_size(), 5);
  EXPECT_EQ(assembly.title(), "table");
  EXPECT_EQ(assembly.external_ids(0), "web-17");
  EXPECT_EQ(assembly.labels().at("site"), "web");
  EXPECT_NEAR(assembly.parts(0).size().x(), 1.2, 1e-6);
  EXPECT_THAT(imported->notes(), Contains(HasSubstr("centimetres")));

  const v1::Parametrization made = ParametrizationOf("assemblies/mesh-table");
  EXPECT_GT(made.relationships_size(), 0);
  v1::AdjustAssemblyRequest adjust;
  adjust.set_name("assemblies/mesh-table");
  v1::MeasureDemand& demand = *adjust.add_demands();
  demand.mutable_measure()->set_element("part 1");
  demand.mutable_measure()->set_axis(v1::X);
  demand.set_value(1.6);
  const auto wider = Call(&Stub::AdjustAssembly, adjust);
  ASSERT_TRUE(wider.ok()) << wider.status();
  EXPECT_NEAR(wider->reached(0), 1.6, 1e-9);
  EXPECT_EQ(wider->faults_size(), 0);

  for (const auto format :
       {v1::ExportDesignRequest::GLB, v1::ExportDesignRequest::OBJ, v1::ExportDesignRequest::STL}) {
    const auto file = Export("assemblies/mesh-table", format);
    EXPECT_TRUE(file.ok()) << file.status();
  }
  // Its legs are open at the top: there is no solid to write.
  const absl::Status step = Export("assemblies/mesh-table", v1::ExportDesignRequest::STEP).status();
  EXPECT_THAT(std::string(step.message()), HasSubstr("only a surface")) << step;
}

TEST_F(AssemblyMeshTest, CanBeTheAssemblyOfATemplate) {
  ASSERT_TRUE(Import(Request(Table(), "mesh-table")).ok());
  const auto catalog = v1::CatalogService::NewStub(process_.channel());
  using Catalog = v1::CatalogService::Stub;
  v1::ImportTemplateRequest request;
  request.set_request_id("of-mesh");
  request.mutable_template_()->set_name("templates/mesh-table");
  request.mutable_template_()->mutable_assembly()->set_assembly("assemblies/mesh-table");
  const auto made = testing::Call(*catalog, &Catalog::ImportTemplate, request);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_GE(made->parameters_size(), 3);
  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name("templates/mesh-table");
  v1::ParameterValue& value = *evaluate.add_parameters();
  value.set_name(made->parameters(0).name());
  value.set_value(0.5 * (made->parameters(0).minimum() + made->parameters(0).maximum()));
  const auto design = testing::Call(*catalog, &Catalog::EvaluateTemplate, evaluate);
  ASSERT_TRUE(design.ok()) << design.status();
  EXPECT_EQ(design->parts_size(), 5);
}

// Closed parts are solids: the file can be written, and what it is made of is known.
TEST_F(AssemblyMeshTest, TakesAnnotationsByTheNamesOfParts) {
  mesh::Scene scene;
  scene.components = testing::TableParts();
  for (std::size_t leg = 1; leg < 5; ++leg) {
    const Eigen::Vector3d low = scene.components[leg].vertices.rowwise().minCoeff();
    scene.components[leg] = testing::Box(absl::StrCat("leg ", leg), low, {0.05, 0.05, 0.7});
  }
  v1::ImportAssemblyMeshRequest request = Request(testing::ObjOf(scene), "solid-table");
  request.set_length_unit("m");
  v1::PartAnnotation& top = *request.mutable_annotations()->add_parts();
  top.add_parts("top");
  top.set_title("Table top");
  v1::PartAnnotation& away = *request.mutable_annotations()->add_parts();
  away.add_parts("leg 4");
  away.set_left_out(true);
  const auto imported = Import(request);
  ASSERT_TRUE(imported.ok()) << imported.status();
  ASSERT_EQ(imported->assembly().parts_size(), 4);
  EXPECT_EQ(imported->assembly().parts(0).title(), "Table top");
  const auto step = Export("assemblies/solid-table", v1::ExportDesignRequest::STEP);
  EXPECT_TRUE(step.ok()) << step.status();

  request = Request(testing::ObjOf(scene), "another");
  request.mutable_annotations()->add_parts()->add_parts("no such part");
  EXPECT_EQ(DetailOf(Import(request).status()).field, "annotations.parts[0].parts[0]");
}

TEST_F(AssemblyMeshTest, IsTurnedUprightAndLimited) {
  v1::ImportAssemblyMeshRequest request = Request(Table(), "turned");
  request.set_length_unit("m");
  request.set_up(v1::Y);
  request.set_most_parts(2);
  const auto imported = Import(request);
  ASSERT_TRUE(imported.ok()) << imported.status();
  EXPECT_LE(imported->assembly().parts_size(), 2);
  EXPECT_THAT(imported->notes(), Contains(HasSubstr("more than 2 parts")));
  double top = 0;
  for (const v1::AssemblyPart& part : imported->assembly().parts()) {
    top = std::max(top, part.position().z() + part.size().z());
  }
  EXPECT_NEAR(top, 0.7, 1e-6);
}

TEST_F(AssemblyMeshTest, TakesAFileThatWasUploaded) {
  const std::string file = Table();
  grpc::ClientContext context;
  testing::Prepare(context);
  v1::UploadDrawingResponse response;
  const auto writer = stub_->UploadDrawing(&context, &response);
  v1::Chunk chunk;
  chunk.set_data(file);
  chunk.set_total_size(static_cast<int64_t>(file.size()));
  chunk.set_sha256(Sha256Hex(file));
  writer->Write(chunk);
  writer->WritesDone();
  ASSERT_TRUE(writer->Finish().ok());
  v1::ImportAssemblyMeshRequest request = Request("", "uploaded");
  request.set_drawing(response.sha256());
  const auto imported = Import(request);
  ASSERT_TRUE(imported.ok()) << imported.status();
  EXPECT_EQ(imported->assembly().parts_size(), 5);
  request = Request(file, "both");
  request.set_drawing(response.sha256());
  EXPECT_EQ(DetailOf(Import(request).status()).field, "drawing");
}

// Each refusal names what is wrong, and leaves nothing behind.
TEST_F(AssemblyMeshTest, RefusesWhatIsNoMesh) {
  const auto refused = [&](const v1::ImportAssemblyMeshRequest& request) {
    const absl::Status status = Import(request).status();
    EXPECT_FALSE(status.ok());
    v1::GetAssemblyRequest get;
    get.set_name(request.annotations().name());
    EXPECT_TRUE(absl::IsNotFound(Call(&Stub::GetAssembly, get).status())) << status;
    return status;
  };
  const auto of_file = [&](const std::string& file) {
    const absl::Status status = refused(Request(file, "none"));
    EXPECT_EQ(DetailOf(status).field, "file") << status;
    return std::string(status.message());
  };
  EXPECT_THAT(of_file(""), HasSubstr("empty"));
  EXPECT_THAT(of_file("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("flat"));
  EXPECT_THAT(of_file("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("2"));
  EXPECT_THAT(of_file("v 0 0 0\nv 1 0 0\nf 1 2 3\n"), HasSubstr("3"));
  EXPECT_THAT(of_file("ISO-10303-21;\nHEADER;\n"), HasSubstr("STEP"));
  v1::ImportAssemblyMeshRequest wrong = Request(Table(), "Not An Id");
  wrong.set_length_unit("cubit");
  wrong.set_most_parts(1000);
  std::vector<std::string> fields;
  for (const FieldViolation& each : AllViolationsOf(Import(wrong).status())) {
    fields.push_back(each.field);
  }
  EXPECT_THAT(fields, ::testing::IsSupersetOf({"annotations.name", "length_unit", "most_parts"}));
}

// Cut off or changed anywhere, a file becomes an assembly or is refused with its name.
TEST_F(AssemblyMeshTest, TakesOrRefusesDamagedFiles) {
  std::mt19937 random(3);
  const std::string whole = Table();
  int taken = 0;
  for (int i = 0; i < 30; ++i) {
    std::string file = whole;
    if (i % 2 == 0) {
      file.resize(random() % file.size());
    } else {
      file[random() % file.size()] = "0123456789.-ef \n"[random() % 16];
    }
    const auto imported = Import(Request(file, absl::StrCat("damaged-", i)));
    taken += imported.ok() ? 1 : 0;
    if (!imported.ok()) {
      EXPECT_EQ(DetailOf(imported.status()).field, "file") << i << ": " << imported.status();
    }
  }
  EXPECT_GT(taken, 0);
}

}  // namespace
}  // namespace mortise::catalog
