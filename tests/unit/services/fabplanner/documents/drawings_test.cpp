// Diagrams, step pictures and the guide. With MORTISE_TEST_OUTPUT set, the files are kept there to
// look at.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <set>

#include "common/base/files.h"
#include "common/render/image.h"
#include "services/fabplanner/documents/assembly_guide_html.h"
#include "services/fabplanner/documents/assembly_picture.h"
#include "services/fabplanner/documents/guide_contents.h"
#include "services/fabplanner/documents/layout_svg.h"
#include "services/fabplanner/documents/step_arrangement.h"
#include "services/fabplanner/documents/svg_drawing.h"
#include "services/fabplanner/planning/planning.h"
#include "tests/support/png_image.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

void Keep(const std::string& file_name, const std::string& bytes) {
  if (const char* folder = std::getenv("MORTISE_TEST_OUTPUT")) {
    ASSERT_TRUE(WriteFile(std::filesystem::path(folder) / file_name, bytes).ok());
  }
}

int Count(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

// Tags that open also close, in order; enough to catch broken markup.
void ExpectWellFormed(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    ASSERT_NE(end, std::string::npos);
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag[0] == '?' || tag[0] == '!') continue;
    if (tag[0] == '/') {
      ASSERT_FALSE(open.empty());
      EXPECT_EQ(tag.substr(1), open.back());
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(tag.substr(0, tag.find_first_of(" \n")));
    }
  }
  EXPECT_THAT(open, ::testing::IsEmpty());
}

FabricationPlan PlanOf(int quantity) {
  return MakePlan(ExampleTable(), ExampleItems(), quantity).value();
}

TEST(LayoutSvgTest, BoardsShowPartsLengthsAndOffcuts) {
  const std::string svg = BoardsSvg(PlanOf(1));
  Keep("boards.svg", svg);
  ExpectWellFormed(svg);
  EXPECT_THAT(svg, HasSubstr("apron_front"));
  EXPECT_THAT(svg, HasSubstr(">1110<"));
  EXPECT_THAT(svg, HasSubstr("offcut"));
  EXPECT_THAT(svg, HasSubstr("items/leg-45, 45 × 45 mm"));
  EXPECT_EQ(Count(svg, "class=\"part\""), 8);
}

TEST(LayoutSvgTest, BoardsCutAlikeAreDrawnOnce) {
  const std::string svg = BoardsSvg(PlanOf(12));
  Keep("boards-12.svg", svg);
  ExpectWellFormed(svg);
  EXPECT_THAT(svg, HasSubstr("board-1, 3, 5, 7, 9, 11 (6 alike)"));
  EXPECT_LT(Count(svg, "class=\"part\""), 8 * 12);
}

TEST(LayoutSvgTest, EndsAreDrawnAsTheyRunAndMarkedWithTheirAngles) {
  const EndSlope mitre = SlopeOf(M_PI / 4, 0), bevel = SlopeOf(0, M_PI / 6);
  FabricationPlan plan;
  BoardLayout& board = plan.boards.emplace_back();
  board = {"board-1", "items/apron-20", 0.09, 0.02, 1.2, {}, 0.1};
  // A cut at 45° frees "top" and makes the front of "side"; its rear and "lid" are cut apart.
  board.segments = {{"top", 0.01, 0.4, {{0, 0}, mitre}},
                    {"side", 0.3242, 0.3, {mitre, {0, 0}}},
                    {"lid", 0.6272, 0.2, {bevel, {0, 0}}}};
  const std::string svg = BoardsSvg(plan);
  Keep("boards-sloped.svg", svg);
  ExpectWellFormed(svg);
  // On the lower edge the cut lies 90 mm in front of the point of "top".
  EXPECT_THAT(svg, HasSubstr(">320 ∠ 45°<"));
  EXPECT_EQ(Count(svg, "∠ 45°"), 1);
  EXPECT_THAT(svg, HasSubstr("∠ bevel 30°<"));
  EXPECT_EQ(Count(svg, "class=\"hidden\""), 1);
  EXPECT_THAT(svg, HasSubstr(">400<"));

  Design design = ExampleTable();
  plan = PlanOf(1);
  plan.parts[0].ends = {mitre, bevel};
  const auto contents = ContentsOf(plan, design, ExampleItems(), "Table");
  ASSERT_TRUE(contents.ok()) << contents.status();
  EXPECT_THAT(AssemblyGuideHtml(*contents, {}, {}), HasSubstr("ends 45° and bevel 30°"));
}

TEST(LayoutSvgTest, SheetsShowOutlinesWithSizeAndPlace) {
  FabricationPlan plan = PlanOf(1);
  plan.sheets[0].placements.push_back(
      {"bracket", {{1.4, 0.8}, {1.9, 0.8}, {1.9, 1.0}, {1.6, 1.0}, {1.6, 1.2}, {1.4, 1.2}}});
  const std::string svg = SheetsSvg(plan);
  Keep("sheets.svg", svg);
  ExpectWellFormed(svg);
  EXPECT_THAT(svg, HasSubstr(">1300 × 800<"));
  EXPECT_THAT(svg, HasSubstr(">at 10, 10<"));
  EXPECT_THAT(svg, HasSubstr(">2500<"));
}

TEST(LayoutSvgTest, NamesAreEscapedAndEmptyPlansDraw) {
  FabricationPlan plan = PlanOf(1);
  plan.boards[0].segments[0].part = "<script>&\"\x01";
  const std::string svg = BoardsSvg(plan);
  ExpectWellFormed(svg);
  EXPECT_THAT(svg, Not(HasSubstr("<script>")));
  ExpectWellFormed(BoardsSvg({}));
  ExpectWellFormed(SheetsSvg({}));
}

TEST(AssemblyPictureTest, AddedPartsMoveAgainstTheirPegs) {
  const Design design = ExampleTable();
  const FabricationPlan plan = PlanOf(1);
  const auto offset = [&](const std::string& part, int number) {
    return ExplodedOffset(part, design, plan.steps, number, 0.3);
  };
  EXPECT_EQ(offset("top", 3), Eigen::Vector3d(0, 0, 0.3));
  EXPECT_EQ(offset("leg_1", 3), Eigen::Vector3d::Zero());
  // In the first step the aprons pull away from the legs on both sides.
  EXPECT_NEAR((offset("leg_2", 1) - offset("leg_1", 1) - Eigen::Vector3d(0.6, 0, 0)).norm(), 0,
              1e-12);
  // In the second, the back frame moves in one piece, behind the side aprons.
  EXPECT_EQ(offset("leg_1", 2), Eigen::Vector3d::Zero());
  EXPECT_EQ(offset("apron_left", 2), Eigen::Vector3d(0, 0.3, 0));
  for (const char* part : {"leg_3", "leg_4", "apron_back"}) {
    EXPECT_EQ(offset(part, 2), Eigen::Vector3d(0, 0.6, 0)) << part;
  }
}

TEST(AssemblyPictureTest, EachStepHasADifferentPictureAndTheGuideHoldsThem) {
  const Design design = ExampleTable();
  const FabricationPlan plan = PlanOf(2);
  std::vector<std::string> pictures;
  for (const AssemblyStep& step : plan.steps) {
    const auto picture =
        DrawStep(ArrangeStep(design, ExampleItems(), plan.holes, plan.steps, step.number));
    ASSERT_TRUE(picture.ok()) << picture.status();
    Keep("step-" + std::to_string(step.number) + ".png", picture->png);
    const auto image = testing::DecodePng(picture->png);
    ASSERT_TRUE(image.ok()) << image.status();
    EXPECT_EQ(image->width, 900);
    EXPECT_GT(std::set(image->pixels.begin(), image->pixels.end()).size(), 10);
    pictures.push_back(picture->png);
  }
  EXPECT_NE(pictures[0], pictures[1]);

  const auto contents = ContentsOf(plan, design, ExampleItems(), "Table <for two>");
  ASSERT_TRUE(contents.ok()) << contents.status();
  const std::string html = AssemblyGuideHtml(*contents, pictures, {});
  Keep("assembly.html", html);
  EXPECT_THAT(html, StartsWith("<!DOCTYPE html>"));
  EXPECT_EQ(Count(html, "width=\"900\" height=\"675\" src=\"data:image/png;base64,"), 3);
  EXPECT_THAT(html, HasSubstr("Table &lt;for two&gt;"));
  EXPECT_THAT(html, HasSubstr("make 2 of them"));
  EXPECT_THAT(html, HasSubstr("3 ×</td><td>Beech dowel"));
  // Needs nothing from elsewhere: what names a host is the name of a format.
  EXPECT_EQ(Count(html, "http://"), Count(html, "http://www.w3.org/2000/svg"));
  EXPECT_THAT(html, Not(HasSubstr("https://")));
}

}  // namespace
}  // namespace mortise::fabplanner
