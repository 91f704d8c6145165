#include "cli/files/compose_script.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/base/violation_lists.h"
#include "tests/support/status_assertions.h"

namespace mortise::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// The lines at fault.
std::vector<std::string> FaultyLines(const std::string& text) {
  std::vector<std::string> lines;
  for (const FieldViolation& each : AllViolationsOf(ParseComposeScript(text).status())) {
    lines.push_back(each.field);
  }
  return lines;
}

TEST(ComposeScript, WordsArePartedByBlanksAndQuotesKeepThemTogether) {
  ASSERT_OK_AND_ASSIGN(
      const ComposeScript script,
      ParseComposeScript("new desk --title \"My 'own'  desk\"\n"
                         "\tadd  bookshelf --at '0.4, 0.2, 0.5' --group=\"a b\"\r\n"
                         "save --title ''\n"));
  EXPECT_EQ(script.model, "desk");
  ASSERT_EQ(script.lines.size(), 3u);
  EXPECT_THAT(script.lines[0].words, ElementsAre("new", "desk", "--title", "My 'own'  desk"));
  EXPECT_THAT(script.lines[1].words,
              ElementsAre("add", "bookshelf", "--at", "0.4, 0.2, 0.5", "--group=a b"));
  EXPECT_THAT(script.lines[2].words, ElementsAre("save", "--title", ""));
}

TEST(ComposeScript, CommentsAndEmptyLinesCountAsLinesOnly) {
  ASSERT_OK_AND_ASSIGN(const ComposeScript script,
                       ParseComposeScript("# A desk \\\n"
                                          "\n"
                                          "new desk  # begins here\n"
                                          "  # \"not closed\n"
                                          "snap a#b \"# no comment\"\n"));
  ASSERT_EQ(script.lines.size(), 2u);
  EXPECT_EQ(script.lines[0].number, 3);
  EXPECT_EQ(script.lines[0].text, "new desk");
  EXPECT_EQ(script.lines[1].number, 5);
  EXPECT_THAT(script.lines[1].words, ElementsAre("snap", "a#b", "# no comment"));
}

TEST(ComposeScript, LinesGoOnBehindABackslash) {
  ASSERT_OK_AND_ASSIGN(const ComposeScript script, ParseComposeScript("new desk\n"
                                                                      "add bookshelf \\\n"
                                                                      "    --id shelf\n"
                                                                      "snap shelf\n"));
  ASSERT_EQ(script.lines.size(), 3u);
  EXPECT_THAT(script.lines[1].words, ElementsAre("add", "bookshelf", "--id", "shelf"));
  EXPECT_EQ(script.lines[1].number, 2);
  EXPECT_EQ(script.lines[2].number, 4);
}

TEST(ComposeScript, AllFaultyLinesAreNamed) {
  EXPECT_THAT(FaultyLines("new desk\nadd \"table\nsnap 'top\n"), ElementsAre("line 2", "line 3"));
  EXPECT_THAT(FaultyLines("new desk\nnew table\n"), ElementsAre("line 2"));
  EXPECT_THAT(FaultyLines("new --title \"Desk\"\n"), ElementsAre("line 1"));
  EXPECT_THAT(FaultyLines("# none\nadd table\n"), ElementsAre("line 2"));
  EXPECT_THAT(FaultyLines(""), ElementsAre("line 1"));
  EXPECT_THAT(FaultyLines("new desk\nsave\n"), IsEmpty());
}

}  // namespace
}  // namespace mortise::cli
