// STEP as people send it, through the catalog as a process: what is mirrored, open, unnamed or
// wrong is told to whoever imports it.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/cad/step/step_reader.h"
#include "common/mesh/mass_properties.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "tests/integration/services/catalog/assembly_service_fixture.h"

namespace mortise::catalog {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

std::string FieldFile(const std::string& name) {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  const std::filesystem::path folder = source == nullptr ? "." : source;
  const auto bytes = ReadFile(folder / "tests/data/step" / name);
  EXPECT_TRUE(bytes.ok()) << bytes.status();
  return bytes.value_or("");
}

class StepFieldImportTest : public AssemblyServiceTest {
 protected:
  absl::StatusOr<v1::ImportAssemblyStepResponse> Import(const std::string& file,
                                                        v1::AssemblyAnnotations annotations = {}) {
    v1::ImportAssemblyStepRequest request;
    request.set_request_id("import-" + std::to_string(++requests_));
    request.set_step(FieldFile(file));
    if (annotations.name().empty()) annotations.set_name("assemblies/field");
    *request.mutable_annotations() = annotations;
    return Call(&Stub::ImportAssemblyStep, request);
  }

  absl::StatusOr<v1::Shape> ImportShape(const std::string& bytes) {
    const auto catalog = v1::CatalogService::NewStub(process_.channel());
    v1::ImportShapeRequest request;
    request.set_request_id("shape-" + std::to_string(++requests_));
    request.set_format(v1::ImportShapeRequest::STEP);
    request.set_file(bytes);
    return testing::Call(*catalog, &v1::CatalogService::Stub::ImportShape, request);
  }
};

// The left part of a pair is a part of its own, in the catalog and in what is exported of it.
TEST_F(StepFieldImportTest, MirroredPartsAreOtherParts) {
  // Each file with the axis that it mirrors.
  const std::map<std::string, int> axes = {{"mirror-assembly.step", 0}, {"mirror-mapped.step", 2}};
  for (const auto& [file, axis] : axes) {
    v1::AssemblyAnnotations annotations;
    annotations.set_name("assemblies/" + file.substr(0, file.find('.')));
    const auto imported = Import(file, annotations);
    ASSERT_TRUE(imported.ok()) << imported.status();
    EXPECT_THAT(imported->notes(), Contains(HasSubstr("mirror image of 'arm'")));
    ASSERT_EQ(imported->assembly().parts_size(), 2);
    EXPECT_NE(imported->assembly().parts(0).shape(), imported->assembly().parts(1).shape());
    v1::ExportAssemblyRequest request;
    request.set_name(annotations.name());
    request.set_format(v1::ExportDesignRequest::STEP);
    grpc::ClientContext context;
    testing::Prepare(context);
    const auto bytes = testing::ReadChunks(*stub_->ExportAssembly(&context, request));
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    const auto again = cad::ReadStep(*bytes);
    ASSERT_TRUE(again.ok()) << again.status();
    ASSERT_EQ(again->parts.size(), 2u);
    EXPECT_EQ(again->products.size(), 2u) << "one cannot be made from the other";
    // The corner that is cut off lies on the other side of the plane between the two.
    std::vector<Eigen::Vector3d> middles;
    for (const cad::StepPart& part : again->parts) {
      ASSERT_GE(part.shape, 0);
      const mesh::DrawnShape& shape = again->shapes[static_cast<std::size_t>(part.shape)];
      middles.push_back(mesh::ComputeMassProperties(mesh::SurfaceIn(shape, shape.size)).centroid);
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(middles[0][i], i == axis ? -middles[1][i] : middles[1][i], 1e-9) << file;
      EXPECT_GT(std::abs(middles[0][i]), 1e-6) << "the arm has no symmetry";
    }
  }
}

TEST_F(StepFieldImportTest, TellsWhatIsLeftOutAndTakenOtherwise) {
  const std::map<std::string, std::string> told = {
      {"open-in-one.step", "'both': body #295 is open"},
      {"hybrid.step", "'hybrid': surface #208"},
      {"no-unit.step", "taken to be in millimetres"},
      {"latin1-names.step", "taken for Latin-1: 'Geh\u00e4use', 'Stra\u00dfe'"}};
  for (const auto& [file, note] : told) {
    v1::AssemblyAnnotations annotations;
    annotations.set_name("assemblies/" + file.substr(0, file.find('.')));
    const auto imported = Import(file, annotations);
    ASSERT_TRUE(imported.ok()) << file << ": " << imported.status();
    EXPECT_THAT(imported->notes(), Contains(HasSubstr(note)));
  }
}

TEST_F(StepFieldImportTest, RefusesWhatContradictsItselfByName) {
  const std::map<std::string, std::string> told = {
      {"plane-5mm-off.step", "'board': its faces, edges and vertices contradict each other"},
      {"four-coordinates.step", "#138, line 145: CARTESIAN_POINT has 4 numbers"},
      {"nan.step", "#10, line 17: NAN is no finite number"},
      {"surface-only.step", "'plate' is a surface"}};
  for (const auto& [file, message] : told) {
    const absl::Status refused = Import(file).status();
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << file << refused;
    EXPECT_EQ(DetailOf(refused).field, "step") << file;
    EXPECT_THAT(std::string(refused.message()), HasSubstr(message)) << file;
  }
}

// Curves that a part was constructed with do not hide its product from annotations.
TEST_F(StepFieldImportTest, AnnotatesProductsThatHaveDatumCurves) {
  v1::AssemblyAnnotations annotations;
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(FieldFile("datum-board.textproto"),
                                                            &annotations));
  const auto imported = Import("datum-curve.step", annotations);
  // They are 20 mm thick, and the item that the annotation names is 18 mm.
  EXPECT_THAT(std::string(imported.status().message()),
              AllOf(HasSubstr("'left board' measures 100"), HasSubstr("'right board' measures")));
  const auto bare = Import("datum-curve.step");
  ASSERT_TRUE(bare.ok()) << bare.status();
  std::vector<std::string> names;
  for (const v1::AssemblyPart& part : bare->assembly().parts()) names.push_back(part.name());
  EXPECT_THAT(names, UnorderedElementsAre("left board", "right board"));
}

TEST_F(StepFieldImportTest, ShapesComeWithNotes) {
  // The body that is closed is a box; with one corner off, it has a shape.
  const auto shape = ImportShape(FieldFile("mirror-assembly.step"));
  EXPECT_THAT(std::string(shape.status().message()), HasSubstr("has 2 solids"));
  std::string arm = FieldFile("mirror-assembly.step");
  const std::size_t left = arm.find("#234 = ");
  arm.erase(left, arm.find('\n', left) - left);
  const auto alone = ImportShape(arm);
  ASSERT_TRUE(alone.ok()) << alone.status();
  EXPECT_THAT(alone->notes(), Contains(AllOf(HasSubstr("'left'"), HasSubstr("no placement"))));
}

}  // namespace
}  // namespace mortise::catalog
