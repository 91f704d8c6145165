#include "common/base/text_escapes.h"

#include <gtest/gtest.h>

#include <string_view>

namespace mortise {
namespace {

TEST(TextEscapes, FieldsOfCsvAreQuotedWhereTheyMustBe) {
  EXPECT_EQ(CsvField("pine board"), "pine board");
  EXPECT_EQ(CsvField(""), "");
  EXPECT_EQ(CsvField("1,5"), "\"1,5\"");
  EXPECT_EQ(CsvField("3/4\" pipe"), "\"3/4\"\" pipe\"");
  EXPECT_EQ(CsvField("two\r\nlines"), "\"two\r\nlines\"");
}

TEST(TextEscapes, TerminalsGetNoControlCharacters) {
  EXPECT_EQ(EscapeControls("plain Stühle\n\tand more"), "plain Stühle\n\tand more");
  EXPECT_EQ(EscapeControls("\x1b[31mred\x07"), "\\x1b[31mred\\x07");
  EXPECT_EQ(EscapeControls("over\rwritten\x7f"), "over\\x0dwritten\\x7f");
  EXPECT_EQ(EscapeControls("\xC2\x9B"
                           "2J"),
            "\\x9b2J");
  EXPECT_EQ(EscapeControls(std::string_view("a\0b", 3)), "a\\x00b");
}

TEST(TextEscapes, SpreadsheetsRunNoText) {
  for (const char* text : {"=1+1", "=HYPERLINK(\"http://a.example\")", "@SUM(A1)",
                           "+cmd|' /C calc'!A0", "-2+3+cmd|' /C calc'!A0", "+49-711-123456", "+1/2",
                           "-E5", "-shelf", "\t=1", "\r=1", "'=1", "''-shelf"}) {
    const std::string cell = SpreadsheetText(text);
    EXPECT_EQ(cell, std::string("'") + text);
    EXPECT_EQ(FromSpreadsheetText(cell), text);
  }
}

TEST(TextEscapes, NumbersAndOtherTextsAreCellsAsTheyAre) {
  for (const char* text : {"", "pine board", "-22.5", "+1e-3", "-0.5 0.5 0.7", "'", "'tis", "''",
                           "a=b", "'-22.5", "100-4711/A"}) {
    EXPECT_EQ(SpreadsheetText(text), text);
    EXPECT_EQ(FromSpreadsheetText(text), text);
  }
}

TEST(TextEscapes, XmlHasNoCharacterThatMeansSomething) {
  EXPECT_EQ(EscapeXml("a < b & 'c' > \"d\""), "a &lt; b &amp; &#39;c&#39; &gt; &quot;d&quot;");
  EXPECT_EQ(EscapeXml("&amp;"), "&amp;amp;");
}

}  // namespace
}  // namespace mortise
