// Pages of maps: that they are whole, and that nothing in a map can change what they are. What they
// do in a browser is in tests/integration/cli/explore_page_test.cpp.
#include "cli/explore/map_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/unit/cli/explore/vase_map.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

// The document that a page carries about its map.
Json MapOf(const std::string& page) {
  const std::string begin = "id=\"map\">";
  const std::size_t first = page.find(begin) + begin.size();
  return Json::parse(page.substr(first, page.find("</script>", first) - first), nullptr, false);
}

TEST(MapPageTest, SaysWhatTheMapIsOf) {
  v1::DesignMap map = VaseMap();
  v1::MapFailure& failure = *map.add_failures();
  failure.set_count(3);
  failure.set_message("it falls over");
  map.mutable_shapes()->set_unmapped(2);
  map.mutable_shapes()->add_unmapped_failures()->set_message("it has a hole");
  const auto page = MapPage(map, {OneElement()});
  ASSERT_TRUE(page.ok()) << page.status();
  const Json written = MapOf(*page);
  EXPECT_EQ(written["title"], "vase");
  EXPECT_EQ(written["parameters"][1]["name"], "waist");
  EXPECT_EQ(written["metrics"][0]["maximum"], 3);
  EXPECT_EQ(written["failures"][0]["message"], "it falls over");
  EXPECT_EQ(written["unmapped"], 2);
  EXPECT_EQ(written["unmappedFailures"][0]["message"], "it has a hole");
  EXPECT_EQ(written["structures"].size(), 1u);
  EXPECT_FALSE(written["structures"][0].contains("shapes"));
  EXPECT_THAT(*page, HasSubstr("id=\"pack-0\""));
}

TEST(MapPageTest, NeedsNothingFromElsewhere) {
  ExportedStructure structure = OneElement();
  AddVases(structure);
  v1::DesignMap map = VaseMap();
  *map.mutable_shapes() = VaseShapes();
  const std::string page = MapPage(map, {structure}).value();
  EXPECT_THAT(page, Not(HasSubstr("@@")));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  // Names of the drawing's language are no addresses that anything is fetched from.
  const std::string rest = std::regex_replace(page, std::regex("http://www.w3.org/2000/svg"), "");
  EXPECT_THAT(rest, Not(HasSubstr("http:")));
  EXPECT_THAT(rest, Not(HasSubstr("https:")));
  EXPECT_THAT(rest, Not(HasSubstr("\nimport ")));
  EXPECT_THAT(rest, Not(HasSubstr("\nexport ")));
  // 4 vases of 1922 nodes with 5 numbers each beside the 3 coordinates, of 16 bits: packed and in
  // base64 they are no larger than they were.
  EXPECT_LT(page.size(), 4u * 1922 * 8 * 2 + 100'000);
  EXPECT_EQ(MapOf(page)["fields"].size(), 3u);
}

// Errors of fields come in the map's order, whatever order the fields themselves come in.
TEST(MapPageTest, FieldsAreInTheOrderOfTheMap) {
  ExportedStructure structure = OneElement();
  AddVases(structure);
  for (v1::MapExportPart::Sample& sample : structure.samples) {
    sample.mutable_fields()->SwapElements(0, 2);
  }
  v1::DesignMap map = VaseMap();
  *map.mutable_shapes() = VaseShapes();
  const Json written = MapOf(MapPage(map, {structure}).value());
  ASSERT_EQ(written["fields"].size(), 3u);
  for (int f = 0; f < 3; ++f) {
    EXPECT_EQ(written["fields"][static_cast<std::size_t>(f)]["name"],
              map.shapes().fields(f).name());
  }
}

TEST(MapPageTest, TextsOfOthersCannotChangeThePage) {
  v1::DesignMap map = VaseMap();
  map.mutable_specification()->set_subject("evaluators/</script><script>alert(1)</script>");
  v1::MapFailure& failure = *map.add_failures();
  failure.set_message("</script><!-- @@PACKS@@ \xff");
  const std::string page = MapPage(map, {OneElement()}).value();
  EXPECT_THAT(page, Not(HasSubstr("alert(1)</script>")));
  EXPECT_THAT(page, Not(HasSubstr("</script><!--")));
  const Json written = MapOf(page);
  EXPECT_EQ(written["title"], "</script><script>alert(1)</script>");
  EXPECT_THAT(written["failures"][0]["message"].get<std::string>(), HasSubstr("@@PACKS@@"));
}

TEST(MapPageTest, RefusesWhatDidNotComeWhole) {
  ExportedStructure structure = OneElement();
  structure.tree.mutable_weights()->RemoveLast();
  EXPECT_TRUE(absl::IsDataLoss(MapPage(VaseMap(), {structure}).status()));
  structure = OneElement();
  structure.tree.set_more(true);
  EXPECT_TRUE(absl::IsDataLoss(MapPage(VaseMap(), {structure}).status()));
  v1::DesignMap map = VaseMap();
  *map.mutable_shapes() = VaseShapes();
  structure = OneElement();
  AddVases(structure);
  structure.samples[1].mutable_positions()->pop_back();
  EXPECT_TRUE(absl::IsDataLoss(MapPage(map, {structure}).status()));
  structure = OneElement();
  AddVases(structure);
  structure.samples[2].set_mesh(7);
  EXPECT_TRUE(absl::IsDataLoss(MapPage(map, {structure}).status()));
  structure = OneElement();
  AddVases(structure);
  structure.meshes[0].set_nodes(10);
  EXPECT_TRUE(absl::IsDataLoss(MapPage(map, {structure}).status()));
}

TEST(AddPartTest, PutsTogetherWhatOneMessageCannotHold) {
  const v1::MapTree tree = OneElement().tree;
  const v1::MapMesh mesh = VaseMesh();
  ExportedStructure structure;
  v1::MapExportPart part;
  *part.mutable_tree() = tree;
  part.mutable_tree()->clear_weights();
  part.mutable_tree()->set_more(true);
  AddPart(part, structure);
  part.Clear();
  part.mutable_tree()->set_dimension(2);
  *part.mutable_tree()->mutable_weights() = tree.weights();
  AddPart(part, structure);
  EXPECT_EQ(structure.tree.SerializeAsString(), tree.SerializeAsString());
  part.Clear();
  *part.mutable_mesh() = mesh;
  part.mutable_mesh()->set_triangles(mesh.triangles().substr(0, 240));
  part.mutable_mesh()->set_more(true);
  part.mutable_mesh()->clear_parts();
  AddPart(part, structure);
  *part.mutable_mesh() = mesh;
  part.mutable_mesh()->set_triangles(mesh.triangles().substr(240));
  part.mutable_mesh()->clear_part_names();
  AddPart(part, structure);
  ASSERT_EQ(structure.meshes.size(), 1u);
  EXPECT_EQ(structure.meshes[0].triangles(), mesh.triangles());
  EXPECT_EQ(structure.meshes[0].nodes(), mesh.nodes());
  EXPECT_FALSE(structure.meshes[0].more());
  AddPart(part, structure);
  EXPECT_EQ(structure.meshes.size(), 2u);
  for (const int sample : {3, 4}) {
    const v1::MapExportPart::Sample shape = VaseAt(sample, 0.2, 0.7);
    part.Clear();
    part.mutable_sample()->set_sample(sample);
    part.mutable_sample()->set_positions(shape.positions().substr(0, 8));
    AddPart(part, structure);
    part.mutable_sample()->set_positions(shape.positions().substr(8));
    *part.mutable_sample()->add_fields() = shape.fields(0);
    part.mutable_sample()->mutable_fields(0)->set_values(shape.fields(0).values().substr(0, 4));
    AddPart(part, structure);
    *part.mutable_sample() = shape;
    part.mutable_sample()->clear_positions();
    part.mutable_sample()->mutable_fields(0)->set_values(shape.fields(0).values().substr(4));
    AddPart(part, structure);
    EXPECT_EQ(structure.samples.back().SerializeAsString(), shape.SerializeAsString());
  }
  EXPECT_EQ(structure.samples.size(), 2u);
}

TEST(AddPartTest, JoinsRegionsOfOneName) {
  ExportedStructure structure;
  const auto add = [&](const std::vector<std::pair<const char*, const char*>>& regions, bool more) {
    v1::MapExportPart part;
    part.mutable_mesh()->set_more(more);
    for (const auto& [name, triangles] : regions) {
      v1::MapMesh::Region& region = *part.mutable_mesh()->add_regions();
      region.set_name(name);
      region.set_triangles(triangles);
    }
    AddPart(part, structure);
  };
  add({{"held", "aaaa"}, {"pulled", "bbbb"}}, true);
  add({{"pulled", "cccc"}}, true);
  add({{"pulled", "dddd"}, {"empty", ""}}, false);
  // Of another mesh.
  add({{"held", "eeee"}}, false);
  ASSERT_EQ(structure.meshes.size(), 2u);
  const v1::MapMesh& mesh = structure.meshes[0];
  ASSERT_EQ(mesh.regions_size(), 3);
  EXPECT_EQ(mesh.regions(0).triangles(), "aaaa");
  EXPECT_EQ(mesh.regions(1).name(), "pulled");
  EXPECT_EQ(mesh.regions(1).triangles(), "bbbbccccdddd");
  EXPECT_EQ(mesh.regions(2).name(), "empty");
  EXPECT_EQ(structure.meshes[1].regions(0).triangles(), "eeee");
}

}  // namespace
}  // namespace mortise::cli
