// Solids, STEP and GLB: what is written is what is read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/errors.h"
#include "common/cad/glb_writer.h"
#include "common/cad/solid.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "common/design/part_shapes.h"
#include "tests/unit/common/files/table.h"

namespace mortise::cad {
namespace {

class ExchangeTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto table = parametric::TemplateFunction::Create(parametric::TableBundle());
    ASSERT_TRUE(table.ok()) << table.status();
    auto design = table->Evaluate(table->Defaults());
    ASSERT_TRUE(design.ok()) << design.status();
    design_ = *std::move(design);
  }

  parametric::EvaluatedDesign design_;
};

TEST_F(ExchangeTest, SolidsHaveTheVolumesOfTheParts) {
  const std::vector<mesh::PartShape> shapes = parametric::PartShapes(design_);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto solid = Solid::FromPart(shapes[i]);
    ASSERT_TRUE(solid.ok()) << solid.status();
    EXPECT_NEAR(solid->Volume(), design_.parts[i].volume, 1e-12);
    EXPECT_TRUE(solid->CentreOfMass().isApprox(
        (design_.parts[i].minimum + design_.parts[i].maximum) / 2, 1e-9));
  }
}

TEST_F(ExchangeTest, StepKeepsNamesPlacesAndVolumes) {
  std::vector<AssemblyPart> parts;
  for (const mesh::PartShape& shape : parametric::PartShapes(design_)) {
    parts.push_back({*Solid::FromPart(shape), {0.8, 0.6, 0.4}});
  }
  const auto step = WriteStep("table", parts);
  ASSERT_TRUE(step.ok()) << step.status();
  const auto assembly = ReadStep(*step);
  ASSERT_TRUE(assembly.ok()) << assembly.status();
  EXPECT_EQ(assembly->name, "table");
  EXPECT_THAT(assembly->schema, testing::HasSubstr("AP242"));
  ASSERT_EQ(assembly->parts.size(), design_.parts.size());
  for (std::size_t i = 0; i < assembly->parts.size(); ++i) {
    EXPECT_EQ(assembly->parts[i].name, design_.parts[i].name);
    EXPECT_NEAR(assembly->parts[i].volume, design_.parts[i].volume, 1e-9);
    EXPECT_LT((assembly->parts[i].minimum - design_.parts[i].minimum).norm(), 1e-6);
    EXPECT_LT((assembly->parts[i].maximum - design_.parts[i].maximum).norm(), 1e-6);
  }
}

TEST(StepReader, RefusesWhatIsNoStep) {
  for (const char* text : {"", "hello", "ISO-10303-21;\nHEADER;\nENDSEC;\n",
                           "ISO-10303-21;HEADER;FILE_SCHEMA(('X'));ENDSEC;DATA;#1=FOO(;ENDSEC;"}) {
    const auto assembly = ReadStep(text);
    EXPECT_EQ(assembly.status().code(), absl::StatusCode::kInvalidArgument) << text;
  }
}

TEST_F(ExchangeTest, GlbHoldsOneNamedNodeAPart) {
  std::vector<GlbPart> parts;
  for (const parametric::EvaluatedPart& part : design_.parts) {
    parts.push_back({part.name, parametric::PartSurface(part), {0.8, 0.6, 0.4}});
  }
  const auto glb = WriteGlb("table", parts);
  ASSERT_TRUE(glb.ok()) << glb.status();
  // Header: magic, version 2, total length; then a JSON chunk.
  ASSERT_GT(glb->size(), 20u);
  EXPECT_EQ(glb->substr(0, 4), "glTF");
  std::uint32_t version = 0, length = 0, json_length = 0;
  std::memcpy(&version, glb->data() + 4, 4);
  std::memcpy(&length, glb->data() + 8, 4);
  std::memcpy(&json_length, glb->data() + 12, 4);
  EXPECT_EQ(version, 2u);
  EXPECT_EQ(length, glb->size());
  const auto json = nlohmann::json::parse(glb->substr(20, json_length));
  ASSERT_EQ(json["nodes"].size(), parts.size() + 1);
  EXPECT_EQ(json["nodes"][0]["name"], "table");
  EXPECT_EQ(json["nodes"][0]["children"].size(), parts.size());
  std::set<std::string> names;
  for (const auto& node : json["nodes"]) names.insert(node["name"].get<std::string>());
  for (const auto& part : design_.parts) EXPECT_EQ(names.count(part.name), 1u) << part.name;
  // The height of the table is in the file, in metres, as z (the root node turns it).
  double highest = 0;
  for (const auto& accessor : json["accessors"]) {
    if (accessor.contains("max")) highest = std::max(highest, accessor["max"][2].get<double>());
  }
  EXPECT_NEAR(highest, 0.74, 1e-6);
}

TEST(GlbWriter, RefusesBadMeshes) {
  EXPECT_FALSE(WriteGlb("x", {}).ok());
  GlbPart part{"p", {}, {1, 1, 1}};
  EXPECT_EQ(DetailOf(WriteGlb("x", {part}).status()).field, "parts[0].surface");
  part.surface.vertices = Eigen::Matrix3Xd::Zero(3, 3);
  part.surface.triangles = Eigen::Vector3i(0, 1, 3);
  EXPECT_FALSE(WriteGlb("x", {part}).ok());
  part.surface.triangles = Eigen::Vector3i(0, 1, 2);
  part.surface.vertices(0, 0) = NAN;
  EXPECT_FALSE(WriteGlb("x", {part}).ok());
}

}  // namespace
}  // namespace mortise::cad
