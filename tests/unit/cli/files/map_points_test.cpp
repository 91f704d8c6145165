// Designs of a map as people write them: on the command line, and in tables.
#include "cli/files/map_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "tests/support/status_assertions.h"

namespace mortise::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Varies a width and a material; the height is fixed.
v1::DesignMap Map() {
  v1::DesignMap map;
  map.set_name("maps/m");
  auto& width = *map.add_parameters();
  width.set_name("width");
  width.set_unit("m");
  width.set_minimum(0.2);
  width.set_maximum(0.5);
  auto& material = *map.add_parameters();
  material.set_name("material");
  material.set_whole(true);
  material.set_maximum(1);
  material.add_choices("oak");
  material.add_choices("birch");
  auto& height = *map.add_fixed();
  height.set_name("height");
  height.set_value(0.72);
  return map;
}

// Why a design is refused; what it is refused for must be --at.
std::string Refusal(const std::string& text) {
  const absl::Status status = ParseMapPoint(Map(), text, "--at").status();
  EXPECT_EQ(DetailOf(status).field, "--at") << text;
  return std::string(status.message());
}

TEST(MapPoint, IsReadWithUnitsAndNamesInAnyOrder) {
  ASSERT_OK_AND_ASSIGN(const auto point, ParseMapPoint(Map(), "material=birch, width=250mm", ""));
  EXPECT_THAT(point, ElementsAre(0.25, 1));
  ASSERT_OK_AND_ASSIGN(const auto numbers, ParseMapPoint(Map(), "width=0.3,material=0", ""));
  EXPECT_THAT(numbers, ElementsAre(0.3, 0));
}

TEST(MapPoint, MayNameWhatIsFixedWithItsValueAlone) {
  EXPECT_TRUE(ParseMapPoint(Map(), "width=0.3,material=oak,height=72cm", "").ok());
  EXPECT_THAT(Refusal("width=0.3,material=oak,height=0.8"), HasSubstr("fixed at 0.72"));
}

TEST(MapPoint, NeedsAllThatVariesOnce) {
  EXPECT_THAT(Refusal("material=oak"), HasSubstr("lacks width: 0.2 to 0.5 m"));
  EXPECT_THAT(Refusal("width=0.3"), HasSubstr("lacks material: oak, birch"));
  EXPECT_THAT(Refusal("width=0.3,width=0.4,material=oak"), HasSubstr("twice"));
}

TEST(MapPoint, RefusesWhatTheMapDoesNotKnow) {
  EXPECT_THAT(Refusal("depth=0.3"), HasSubstr("no parameter 'depth', but width, material"));
  EXPECT_THAT(Refusal("material=pine"), HasSubstr("'pine' is none of oak, birch"));
  EXPECT_THAT(Refusal("width=wide"), HasSubstr("'wide' is not a number"));
  EXPECT_THAT(Refusal("width=3 miles"), HasSubstr("'miles' is not a unit"));
  for (const char* const text : {"", "width", "=0.3", "width=0.3,,material=oak"}) {
    EXPECT_THAT(Refusal(text), HasSubstr("NAME=VALUE")) << text;
  }
}

TEST(MapPoints, AreTheRowsOfATable) {
  ASSERT_OK_AND_ASSIGN(
      const auto points,
      ParseMapPoints(Map(), "material, width,height\noak,0.2,0.72\nbirch,30cm,0.72\n", "p.csv"));
  EXPECT_THAT(points, ElementsAre(0.2, 0, 0.3, 1));
}

TEST(MapPoints, AreReadFromWhatPagesSave) {
  v1::DesignMap map = Map();
  map.add_metrics()->set_name("mass");
  map.mutable_metrics(0)->set_unit("kg");
  const std::string table =
      "width,material,mass [kg],mass error [kg]\r\n0.25,birch,1.5,1e-7\r\n0.3,oak,,\r\n";
  ASSERT_OK_AND_ASSIGN(const auto points, ParseMapPoints(map, table, "design.csv"));
  EXPECT_THAT(points, ElementsAre(0.25, 1, 0.3, 0));
  EXPECT_THAT(ParseMapPoints(map, "width,material,cost [kg]\n0.2,oak,1\n", "").status().message(),
              HasSubstr("no parameter 'cost [kg]'"));
}

TEST(MapPoints, TellEachPlaceThatIsAtFault) {
  const absl::Status status =
      ParseMapPoints(Map(), "width,material\n0.2,oak\n0.3,pine\nwide,oak\n0.3\n", "p.csv").status();
  std::vector<std::string> places;
  for (const FieldViolation& each : AllViolationsOf(status)) places.push_back(each.field);
  EXPECT_THAT(places,
              ::testing::UnorderedElementsAre("p.csv: line 3, column 2", "p.csv: line 4, column 1",
                                              "p.csv: line 5, column 1"));
  EXPECT_THAT(ParseMapPoints(Map(), "width\n0.2\n", "p.csv").status().message(),
              HasSubstr("lacks material"));
}

TEST(MapPoints, AreNoneInAnEmptyTable) {
  for (const char* const table : {"", "width,material\n"}) {
    EXPECT_THAT(ParseMapPoints(Map(), table, "p.csv").status().message(),
                HasSubstr("p.csv: has no designs"))
        << table;
  }
}

}  // namespace
}  // namespace mortise::cli
