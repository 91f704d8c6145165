// Guide and cut list on paper, as another program reads them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_join.h"
#include "services/fabplanner/documents/assembly_guide_pdf.h"
#include "services/fabplanner/documents/assembly_picture.h"
#include "services/fabplanner/documents/cut_list_pdf.h"
#include "services/fabplanner/planning/planning.h"
#include "tests/support/printed_pages.h"
#include "tests/unit/services/fabplanner/example_wall.h"

namespace mortise::fabplanner {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

std::string GuideOf(const Design& design, const Items& items, const FabricationPlan& plan,
                    const std::string& title) {
  const GuideContents contents = ContentsOf(plan, design, items, title).value();
  std::vector<std::string> pictures;
  for (const AssemblyStep& step : plan.steps) {
    pictures.push_back(
        DrawStep(ArrangeStep(design, items, plan.holes, plan.steps, step.number))->png);
  }
  const auto pdf = AssemblyGuidePdf(contents, pictures);
  EXPECT_TRUE(pdf.ok()) << pdf.status();
  return pdf.value_or("");
}

TEST(AssemblyGuidePdfTest, EachStepHasAPage) {
  const Design table = ExampleTable();
  const FabricationPlan plan = MakePlan(table, ExampleItems(), 2).value();
  const std::string pdf = GuideOf(table, ExampleItems(), plan, "Tisch <ä> & (1)");
  testing::KeepToLookAt("assembly-guide.pdf", pdf);
  const auto pages = testing::TextPagesOf(pdf);
  ASSERT_THAT(pages, SizeIs(1 + 3));
  EXPECT_THAT(pages[0], HasSubstr("Tisch <ä> & (1)"));
  EXPECT_THAT(pages[0], HasSubstr("make 2 of them"));
  EXPECT_THAT(pages[1], HasSubstr("Step 1"));
  EXPECT_THAT(pages[1], HasSubstr("8 ×"));
  EXPECT_THAT(pages[1], HasSubstr("Beech dowel"));
  EXPECT_THAT(pages[3], HasSubstr("Step 3"));
}

TEST(AssemblyGuidePdfTest, AWallOfManyPegsTakesFewPages) {
  const Design wall = ExampleWall();
  const FabricationPlan plan = MakePlan(wall, WallItems(), 1).value();
  const std::string pdf = GuideOf(wall, WallItems(), plan, "Wall");
  testing::KeepToLookAt("wall-guide.pdf", pdf);
  EXPECT_THAT(testing::TextPagesOf(pdf), SizeIs(1 + plan.steps.size()));
  EXPECT_THAT(absl::StrJoin(testing::TextPagesOf(pdf), "\n"), HasSubstr("688 ×"));
}

TEST(CutListPdfTest, TellsStockThatIsCutAlikeOnce) {
  const FabricationPlan plan = MakePlan(ExampleTable(), ExampleItems(), 12).value();
  const auto pdf = CutListPdf(plan, ExampleItems(), "Table");
  ASSERT_TRUE(pdf.ok()) << pdf.status();
  testing::KeepToLookAt("cut-list.pdf", *pdf);
  const std::string text = absl::StrJoin(testing::TextPagesOf(*pdf), "\n");
  EXPECT_THAT(text, HasSubstr("(6 alike)"));
  EXPECT_THAT(text, HasSubstr("Birch plywood 18"));
  EXPECT_THAT(text, HasSubstr("apron_front"));
  EXPECT_THAT(text, HasSubstr("1110"));
  EXPECT_THAT(text, HasSubstr("Bill of materials"));
  EXPECT_THAT(text, HasSubstr("EUR"));
}

TEST(CutListPdfTest, NamesArePrintedAsTheyAreAndAnEmptyPlanIsAFile) {
  FabricationPlan plan = MakePlan(ExampleTable(), ExampleItems(), 1).value();
  plan.boards[0].segments[0].part = "<b>Tür & \"łóżko\"\x01";
  plan.handwork = {"turn the leg"};
  const auto pdf = CutListPdf(plan, ExampleItems(), "\xff");
  ASSERT_TRUE(pdf.ok()) << pdf.status();
  const std::string text = absl::StrJoin(testing::TextPagesOf(*pdf), "\n");
  EXPECT_THAT(text, HasSubstr("<b>Tür & \"łóżko\""));
  EXPECT_THAT(text, HasSubstr("turn the leg"));
  EXPECT_THAT(testing::TextPagesOf(CutListPdf({}, {}, "Nothing").value()), SizeIs(1));
}

}  // namespace
}  // namespace mortise::fabplanner
