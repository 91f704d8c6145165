// Tables and paragraphs over pages.
#include "services/fabplanner/paper/pdf_flow.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "tests/support/printed_pages.h"

namespace mortise::fabplanner {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(PdfFlowTest, ALongTableNamesItsColumnsOnEachPage) {
  PdfFlow flow = PdfFlow::Begin("Long list").value();
  std::vector<PdfRow> rows;
  for (int i = 0; i < 200; ++i) rows.push_back({{absl::StrCat("row ", i), "leg", "720"}});
  ASSERT_TRUE(flow.Table({"Line", "Part", "Length"}, rows).ok());
  const std::string pdf = flow.Finish().value();
  const auto pages = testing::TextPagesOf(pdf);
  ASSERT_GT(pages.size(), 3u);
  for (std::size_t page = 0; page < pages.size(); ++page) {
    EXPECT_THAT(pages[page], HasSubstr("Length"));
    EXPECT_THAT(pages[page], HasSubstr("Long list"));
    EXPECT_THAT(pages[page], HasSubstr(absl::StrCat(page + 1, "/", pages.size())));
  }
  EXPECT_THAT(pages.front(), HasSubstr("row 0"));
  EXPECT_THAT(pages.back(), HasSubstr("row 199"));
}

TEST(PdfFlowTest, LinesAreBrokenBetweenWordsAndWithinLongOnes) {
  const PdfDocument document = PdfDocument::Begin("Lines").value();
  const auto broken = [&](const std::string& text, double width) {
    return BrokenIntoLines(document, PdfFace::kPlain, 10, text, width);
  };
  EXPECT_EQ(broken("", 20), std::vector<std::string>{""});
  const auto words = broken("put the left side in place from above", 30);
  EXPECT_GT(words.size(), 1u);
  std::string joined;
  for (const std::string& line : words) {
    EXPECT_LE(document.TextWidth(PdfFace::kPlain, 10, line), 30);
    joined += (joined.empty() ? "" : " ") + line;
  }
  EXPECT_EQ(joined, "put the left side in place from above");
  std::string letters;
  for (const std::string& line : broken(std::string(100, 'w'), 25)) {
    EXPECT_LE(document.TextWidth(PdfFace::kPlain, 10, line), 25);
    letters += line;
  }
  EXPECT_EQ(letters, std::string(100, 'w'));
}

TEST(PdfFlowTest, WideCellsGiveWay) {
  PdfFlow flow = PdfFlow::Begin("Wide").value();
  std::string instruction;
  for (int i = 0; i < 60; ++i) absl::StrAppend(&instruction, "word", i, " ");
  ASSERT_TRUE(flow.Table({"Step", "What"}, {{{"first", instruction}}}).ok());
  const auto pages = testing::TextPagesOf(flow.Finish().value());
  ASSERT_EQ(pages.size(), 1u);
  EXPECT_THAT(pages[0], HasSubstr("first"));
  EXPECT_THAT(pages[0], HasSubstr("word59"));
}

TEST(PdfFlowTest, ACellIsNeverMoreThanAPage) {
  PdfFlow flow = PdfFlow::Begin("Much").value();
  std::string much = "first ";
  for (int i = 0; i < 5000; ++i) absl::StrAppend(&much, "word ");
  ASSERT_TRUE(flow.Table({"", ""}, {{{"a", much}}, {{"b", "end"}}}).ok());
  const auto pages = testing::TextPagesOf(flow.Finish().value());
  ASSERT_LE(pages.size(), 2u);
  EXPECT_THAT(pages[0], HasSubstr("…"));
  EXPECT_THAT(pages.back(), HasSubstr("end"));
}

TEST(PdfFlowTest, AHeadingStaysWithWhatItIsOver) {
  PdfFlow flow = PdfFlow::Begin("Headings").value();
  flow.Space(kPaperHeight - 15 - 18 - 10);
  flow.Heading("Boards", true);
  flow.Paragraph("The first of them.");
  const auto pages = testing::TextPagesOf(flow.Finish().value());
  ASSERT_EQ(pages.size(), 2u);
  EXPECT_THAT(pages[0], Not(HasSubstr("Boards")));
  EXPECT_THAT(pages[1], HasSubstr("Boards"));
}

}  // namespace
}  // namespace mortise::fabplanner
