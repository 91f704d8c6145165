// The bill as a workbook, read by a reader that shares nothing with what writes it.
#include "services/fabplanner/documents/bill_workbook.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/printed_pages.h"
#include "tests/unit/services/fabplanner/documents/small_bill.h"

namespace mortise::fabplanner {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A part of the workbook as XML.
std::string PartOf(const std::string& workbook, const std::string& part) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "bill.xlsx";
  EXPECT_TRUE(WriteFile(file, workbook).ok());
  return testing::OutputOf(
      {"/usr/bin/python3", "-c",
       "import sys, zipfile\n"
       "sys.stdout.buffer.write(zipfile.ZipFile(sys.argv[1]).read(sys.argv[2]))",
       file.string(), part});
}

std::string SmallWorkbook() {
  const auto workbook = BillWorkbook(SmallBill(), "A table");
  EXPECT_TRUE(workbook.ok()) << workbook.status();
  return workbook.value_or("");
}

TEST(BillWorkbookTest, NumbersAreNumbersAndTextsAreTexts) {
  const std::string sheet = PartOf(SmallWorkbook(), "xl/worksheets/sheet1.xml");
  EXPECT_THAT(sheet, HasSubstr("<c r=\"G4\"><v>0.375</v></c>"));  // share of a board
  EXPECT_THAT(sheet, HasSubstr("<v>28.5</v>"));
  EXPECT_THAT(sheet, Not(HasSubstr("<f>")));  // no formula
  const std::string texts = PartOf(SmallWorkbook(), "xl/sharedStrings.xml");
  EXPECT_THAT(texts, HasSubstr("<t>=1+1</t>"));
  EXPECT_THAT(texts, HasSubstr("<t>P-1; P-2</t>"));
  EXPECT_THAT(texts, HasSubstr("<t>2400 × 45 × 45 mm</t>"));
}

TEST(BillWorkbookTest, RowsFoldByTheirLevelAndTheHeaderStays) {
  const std::string sheet = PartOf(SmallWorkbook(), "xl/worksheets/sheet1.xml");
  EXPECT_THAT(sheet, HasSubstr("outlineLevel=\"1\""));
  EXPECT_THAT(sheet, HasSubstr("outlineLevel=\"2\""));
  EXPECT_THAT(sheet, HasSubstr("summaryBelow=\"0\""));
  EXPECT_THAT(sheet, HasSubstr("state=\"frozen\""));
  EXPECT_THAT(sheet, HasSubstr("<cols>"));
  EXPECT_THAT(PartOf(SmallWorkbook(), "xl/styles.xml"), HasSubstr("#,##0.00"));
}

TEST(BillWorkbookTest, TheSameTreeGivesTheSameBytes) {
  EXPECT_EQ(SmallWorkbook(), SmallWorkbook());
  EXPECT_THAT(PartOf(SmallWorkbook(), "docProps/core.xml"), HasSubstr("2023-11-14T22:13:20Z"));
}

TEST(BillWorkbookTest, TextsThatNoCellHoldsAreCutOff) {
  BillTree tree = SmallBill();
  for (int i = 0; i < 4000; ++i) tree.nodes[1].parts.push_back("größer leg");
  const auto workbook = BillWorkbook(tree, "A\ntable");
  ASSERT_TRUE(workbook.ok()) << workbook.status();
  EXPECT_THAT(PartOf(*workbook, "xl/sharedStrings.xml"), HasSubstr("…</t>"));
}

}  // namespace
}  // namespace mortise::fabplanner
