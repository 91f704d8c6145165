// Labels as a printer draws and another program reads them.
#include "services/fabplanner/documents/labels_pdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "services/fabplanner/planning/planning.h"
#include "tests/support/printed_pages.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(LabelsPdfTest, EachCodeSaysWhatItsLabelSays) {
  const Design table = ExampleTable();
  const FabricationPlan plan = MakePlan(table, ExampleItems(), 1).value();
  for (const std::string address : {"", "https://workshop.example.com/mortise/"}) {
    const auto labels =
        LabelsOf(plan, table, ExampleItems(), {"Table", "plans/0198c17bd2f0", address});
    const auto pdf = LabelsPdf(labels, "Table: labels");
    ASSERT_TRUE(pdf.ok()) << pdf.status();
    testing::KeepToLookAt("labels.pdf", *pdf);
    std::vector<std::string> codes;
    for (const LabelContents& label : labels) codes.push_back(label.code);
    std::sort(codes.begin(), codes.end());
    EXPECT_THAT(testing::CodesOn(*pdf, 1), ElementsAreArray(codes));
    const auto pages = testing::TextPagesOf(*pdf);
    ASSERT_THAT(pages, SizeIs(1));
    EXPECT_THAT(pages[0], HasSubstr("apron_front"));
    EXPECT_THAT(pages[0], HasSubstr("Step 1"));
    EXPECT_THAT(pages[0], HasSubstr("sheet-1 at 10, 10 mm"));
  }
}

TEST(LabelsPdfTest, TwentyFourFillAPage) {
  std::vector<LabelContents> labels;
  for (int i = 1; i <= 49; ++i) {
    labels.push_back({absl::StrCat("slat ", i), 2, "900 × 90 × 20 mm",
                      absl::StrCat("board-", i, " at 10 mm"), "Planed pine",
                      absl::StrCat("plans/0198c1/parts/slat%20", i, "?step=2")});
  }
  const auto pdf = LabelsPdf(labels, "Slats");
  ASSERT_TRUE(pdf.ok()) << pdf.status();
  EXPECT_THAT(testing::TextPagesOf(*pdf), SizeIs(3));
  EXPECT_THAT(testing::CodesOn(*pdf, 2), SizeIs(24));
  EXPECT_THAT(testing::CodesOn(*pdf, 3), SizeIs(1));
}

TEST(LabelsPdfTest, LongNamesAreShortenedAndOddOnesPrinted) {
  std::vector<LabelContents> labels = {
      {std::string(300, 'w'), 12, "1 × 1 × 1 mm", std::string(300, 'x'), std::string(300, 'y'),
       "plans/0198c1/parts/w"},
      {"<script>&\x01 łóżko (1)", 1, "2 × 2 × 2 mm", "made to drawing", "",
       "plans/0198c1/parts/l"}};
  const auto pdf = LabelsPdf(labels, "Odd \xff names");
  ASSERT_TRUE(pdf.ok()) << pdf.status();
  testing::KeepToLookAt("labels-odd.pdf", *pdf);
  EXPECT_THAT(testing::CodesOn(*pdf, 1), SizeIs(2));
  EXPECT_THAT(testing::TextPagesOf(*pdf)[0], HasSubstr("łóżko (1)"));
}

TEST(LabelsPdfTest, ACodeThatHoldsTooMuchIsRefused) {
  const auto pdf = LabelsPdf({{"leg", 1, "", "", "", std::string(3000, 'x')}}, "Legs");
  EXPECT_EQ(pdf.status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace mortise::fabplanner
