// Comma-separated values as RFC 4180 has them, and what is not.
#include "common/files/csv_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mortise::parametric {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<std::vector<std::string>> Texts(const CsvTable& table) {
  std::vector<std::vector<std::string>> texts;
  for (const CsvRow& row : table.rows) {
    texts.emplace_back();
    for (const CsvCell& cell : row) texts.back().push_back(cell.text);
  }
  return texts;
}

// The one finding of a text.
FieldViolation FaultOf(std::string_view text) {
  const CsvTable table = ParseCsv(text);
  EXPECT_THAT(table.findings, SizeIs(1)) << text;
  return table.findings.empty() ? FieldViolation{} : table.findings[0];
}

TEST(CsvTable, ReadsPlainAndQuotedCells) {
  const CsvTable table = ParseCsv("a,b,c\r\n1,\"two, 2\",\"say \"\"3\"\"\"\r\n,\"\",x\r\n");
  EXPECT_THAT(table.findings, IsEmpty());
  EXPECT_THAT(Texts(table),
              ElementsAre(ElementsAre("a", "b", "c"), ElementsAre("1", "two, 2", "say \"3\""),
                          ElementsAre("", "", "x")));
}

TEST(CsvTable, ReadsLineBreaksInQuotesAndCountsThem) {
  const CsvTable table = ParseCsv("a,b\n\"one\ntwo\r\nthree\",2\nx,y");
  ASSERT_THAT(table.findings, IsEmpty());
  ASSERT_THAT(table.rows, SizeIs(3));
  EXPECT_EQ(table.rows[1][0].text, "one\ntwo\r\nthree");
  EXPECT_EQ(table.rows[1][0].line, 2);
  EXPECT_EQ(table.rows[1][1].line, 4);
  EXPECT_EQ(PlaceOf(table.rows[2][1]), "line 5, column 2");
}

TEST(CsvTable, NumbersAreDecimal) {
  EXPECT_EQ(ParseCsvNumber("16").value_or(0), 16);
  EXPECT_EQ(ParseCsvNumber("2440.5", true).value_or(0), 2.4405);
  for (const char* const text :
       {"0x10", "0x1EAA", "0X1p4", "inf", "-inf", "nan", "1e400", "1_000", "1,5", " 1", "1 EUR"}) {
    EXPECT_FALSE(ParseCsvNumber(text).ok()) << text;
    EXPECT_FALSE(ParseCsvNumber(text, true).ok()) << text;
  }
}

TEST(CsvTable, NamesOtherEncodings) {
  using std::string_view_literals::operator""sv;
  const FieldViolation fault = FaultOf("\xFF\xFEn\0a\0m\0e\0\n\0"sv);
  EXPECT_EQ(fault.field, "line 1");
  EXPECT_THAT(fault.message, HasSubstr("is UTF-16, not UTF-8; save it as UTF-8"));
}

TEST(CsvTable, TakesWhatSpreadsheetsWrite) {
  // A byte order mark, LF alone, empty lines, no line break at the end.
  const CsvTable table = ParseCsv(
      "\xEF\xBB\xBF"
      "a,b\n\n1,2\r\n\r\n\n3,4");
  EXPECT_THAT(table.findings, IsEmpty());
  EXPECT_THAT(Texts(table),
              ElementsAre(ElementsAre("a", "b"), ElementsAre("1", "2"), ElementsAre("3", "4")));
  EXPECT_THAT(ParseCsv("").rows, IsEmpty());
  EXPECT_THAT(ParseCsv("\xEF\xBB\xBF").rows, IsEmpty());
  EXPECT_THAT(Texts(ParseCsv("a,\n")), ElementsAre(ElementsAre("a", "")));
}

TEST(CsvTable, TakesTheLineThatNamesTheComma) {
  const CsvTable table = ParseCsv("sep=,\r\na,b\r\n1,2\r\n");
  EXPECT_THAT(table.findings, IsEmpty());
  EXPECT_THAT(Texts(table), ElementsAre(ElementsAre("a", "b"), ElementsAre("1", "2")));
  EXPECT_EQ(table.rows[0][0].line, 2);
}

TEST(CsvTable, RowsOfCommasAreEmptyLines) {
  const CsvTable table = ParseCsv(",,\r\na,b\r\n,\r\n1,2\r\n,,,,\r\n\"\",\r\n,");
  EXPECT_THAT(table.findings, IsEmpty());
  // Cells that are quoted are there, though they are empty.
  EXPECT_THAT(Texts(table),
              ElementsAre(ElementsAre("a", "b"), ElementsAre("1", "2"), ElementsAre("", "")));
  EXPECT_EQ(table.rows[1][0].line, 4);
}

TEST(CsvTable, NamesThePlaceOfEveryFault) {
  EXPECT_EQ(FaultOf("a,b\n1,2\"\n").field, "line 2, column 2");
  EXPECT_THAT(FaultOf("a,b\n1,2\"\n").message, HasSubstr("quote inside"));
  EXPECT_THAT(FaultOf("a,b\n\"1\"x,2\n").message, HasSubstr("after its closing quote"));
  EXPECT_THAT(FaultOf("a,b\n1,\"2\n3,4\n").message, HasSubstr("never closed"));
  EXPECT_EQ(FaultOf("a,b\n1,\"2\n3,4\n").field, "line 2, column 2");
  EXPECT_THAT(FaultOf("a,b\n1\r2,3\n").message, HasSubstr("carriage return"));
  EXPECT_THAT(FaultOf(std::string_view("a,b\n1,\0\n", 8)).message, HasSubstr("NUL"));
  EXPECT_THAT(FaultOf("a,b\n1,caf\xE9\n").message, HasSubstr("UTF-8"));
  EXPECT_THAT(FaultOf("a,b\n1,\xC0\x80\n").message, HasSubstr("UTF-8"));
  EXPECT_THAT(FaultOf("a,b\n1,\xED\xA0\x80\n").message, HasSubstr("UTF-8"));
  EXPECT_THAT(FaultOf("a,b\n1,\xF4\x90\x80\x80\n").message, HasSubstr("UTF-8"));
  EXPECT_THAT(FaultOf("a,b\n1,2,3\n").message, HasSubstr("3 cells, the first one 2"));
}

TEST(CsvTable, GoesOnAfterAFault) {
  const CsvTable table = ParseCsv("a,b\n1\n2,3\n4\"5,6\n7,8\n9,10,11\n");
  EXPECT_THAT(table.findings, SizeIs(3));
  EXPECT_THAT(Texts(table),
              ElementsAre(ElementsAre("a", "b"), ElementsAre("2", "3"), ElementsAre("7", "8")));
}

TEST(CsvTable, StopsAtAHeaderThatIsNone) {
  const CsvTable table = ParseCsv("a,b\"\n1,2\n3,4,5\n");
  EXPECT_THAT(table.findings, SizeIs(1));
  EXPECT_THAT(table.rows, IsEmpty());
}

TEST(CsvTable, LimitsItsFindings) {
  std::string text = "a,b\n";
  for (int i = 0; i < 1000; ++i) text += "1\n";
  EXPECT_THAT(ParseCsv(text).findings, SizeIs(100));
  EXPECT_EQ(ParseCsv(text).unlisted, 900u);
}

}  // namespace
}  // namespace mortise::parametric
