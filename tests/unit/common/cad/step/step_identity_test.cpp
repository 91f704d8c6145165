// Ids, revisions and the header of written files, as Open CASCADE's own reader finds them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <APIHeaderSection_MakeHeader.hxx>
#include <STEPControl_Reader.hxx>
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <StepData_StepModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <algorithm>
#include <string>
#include <vector>

#include "common/base/files.h"
#include "common/cad/step/step_writer.h"
#include "tests/support/temporary_folder.h"

namespace mortise::cad {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;

struct FoundFile {
  std::string name, time_stamp;
  std::vector<std::string> products;  // "name | id | revision | description", sorted
};

FoundFile FindIn(const std::string& step) {
  const testing::TemporaryFolder folder;
  const std::string path = (folder.path() / "file.step").string();
  EXPECT_TRUE(WriteFile(path, step).ok());
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
  const Handle(StepData_StepModel) model = reader.StepModel();
  FoundFile found;
  const APIHeaderSection_MakeHeader header(model);
  found.name = header.Name()->ToCString();
  found.time_stamp = header.TimeStamp()->ToCString();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto formation = Handle(StepBasic_ProductDefinitionFormation)::DownCast(model->Value(i));
    if (formation.IsNull()) continue;
    const Handle(StepBasic_Product) product = formation->OfProduct();
    const auto description = product->Description();
    found.products.push_back(std::string(product->Name()->ToCString()) + " | " +
                             product->Id()->ToCString() + " | " + formation->Id()->ToCString() +
                             " | " + (description.IsNull() ? "" : description->ToCString()));
  }
  std::sort(found.products.begin(), found.products.end());
  return found;
}

Solid NamedBox(const std::string& name) {
  mesh::PartShape box;
  box.name = name;
  box.outline.resize(2, 4);
  box.outline << 0, 0.1, 0.1, 0, 0, 0, 0.1, 0.1;
  box.height = 0.1;
  box.face_names = {"y_min", "x_max", "y_max", "x_min", "z_min", "z_max"};
  return *Solid::FromPart(box);
}

// A frame in which a post, an article that is bought, stands twice; a product is called as a
// number.
StepAssembly FrameWithPosts() {
  StepAssembly assembly;
  assembly.name = "table";
  assembly.identity = {"100-4711/A", "3", ""};
  assembly.time_stamp = "2026-11-26T20:25:30";
  assembly.groups = {{"table", -1}, {"frame", 0}};
  assembly.products.push_back({"post", NamedBox("post"), std::nullopt});
  assembly.products.back().identity = {"P-1", "5", "items/post, revision 5, materials/pine"};
  assembly.products.push_back({"0", NamedBox("0"), std::nullopt});
  assembly.products.back().identity = {"", "3", "materials/steel"};
  for (int i = 0; i < 3; ++i) {
    StepPart part;
    part.name = i < 2 ? "post " + std::to_string(i + 1) : "foot";
    part.group = i < 2 ? 1 : 0;
    part.product = i < 2 ? 0 : 1;
    part.placement.translation().x() = 0.5 * i;
    assembly.parts.push_back(part);
  }
  return assembly;
}

TEST(StepIdentity, ProductsHaveTheirIdsAndRevisions) {
  const auto step = WriteStep(FrameWithPosts());
  ASSERT_TRUE(step.ok()) << step.status();
  EXPECT_THAT(FindIn(*step).products,
              ElementsAre("0 | 0 | 3 | materials/steel", "frame | frame |  | ",
                          "post | P-1 | 5 | items/post, revision 5, materials/pine",
                          "table | 100-4711/A | 3 | "));
}

TEST(StepIdentity, NamesInAnyScriptKeepTheirIds) {
  StepAssembly assembly = FrameWithPosts();
  assembly.name = assembly.groups[0].name = "стол";
  assembly.products[0].name = "棚";
  const auto step = WriteStep(assembly);
  ASSERT_TRUE(step.ok()) << step.status();
  EXPECT_THAT(FindIn(*step).products, Contains("стол | 100-4711/A | 3 | "));
  EXPECT_THAT(FindIn(*step).products,
              Contains("棚 | P-1 | 5 | items/post, revision 5, materials/pine"));
}

TEST(StepIdentity, TheHeaderTellsOfTheRevisionAndNotOfTheWriting) {
  const auto step = WriteStep(FrameWithPosts());
  ASSERT_TRUE(step.ok()) << step.status();
  const FoundFile found = FindIn(*step);
  EXPECT_EQ(found.name, "table");
  EXPECT_EQ(found.time_stamp, "2026-11-26T20:25:30");
  const auto again = WriteStep(FrameWithPosts());
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(*again, *step);
}

TEST(StepIdentity, WithoutAnyProductsAreCalledByTheirNames) {
  StepAssembly assembly = FrameWithPosts();
  assembly.identity = {};
  assembly.time_stamp.clear();
  for (StepProduct& product : assembly.products) product.identity = {};
  const auto step = WriteStep(assembly);
  ASSERT_TRUE(step.ok()) << step.status();
  const FoundFile found = FindIn(*step);
  EXPECT_EQ(found.time_stamp, "1970-01-01T00:00:00");
  EXPECT_THAT(found.products, ElementsAre("0 | 0 |  | ", "frame | frame |  | ", "post | post |  | ",
                                          "table | table |  | "));
}

}  // namespace
}  // namespace mortise::cad
