#include "common/base/text_escapes.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

TEST(TextEscapes, FieldsOfCsvAreQuotedWhereTheyMustBe) {
  EXPECT_EQ(CsvField("pine board"), "pine board");
  EXPECT_EQ(CsvField(""), "");
  EXPECT_EQ(CsvField("1,5"), "\"1,5\"");
  EXPECT_EQ(CsvField("3/4\" pipe"), "\"3/4\"\" pipe\"");
  EXPECT_EQ(CsvField("two\r\nlines"), "\"two\r\nlines\"");
}

TEST(TextEscapes, XmlHasNoCharacterThatMeansSomething) {
  EXPECT_EQ(EscapeXml("a < b & 'c' > \"d\""), "a &lt; b &amp; &#39;c&#39; &gt; &quot;d&quot;");
  EXPECT_EQ(EscapeXml("&amp;"), "&amp;amp;");
}

}  // namespace
}  // namespace mortise
