#include "common/base/isolated_child.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <string>
#include <string_view>

#include "tests/support/temporary_folder.h"

namespace mortise {
namespace {

// Asks a shell that runs these commands.
ChildAnswer Ask(const std::string& commands, const std::string& question,
                ChildOptions options = {}) {
  const testing::TemporaryFolder folder;
  options.program = "/bin/sh";
  options.argument = folder.path() / "commands";
  std::ofstream(options.argument) << commands << "\n";
  const auto answer = AskChild(question, options);
  EXPECT_TRUE(answer.ok()) << answer.status();
  return answer.ok() ? *answer : ChildAnswer{};
}

TEST(IsolatedChild, AnswersMoreThanASocketHolds) {
  const std::string question(3 << 20, 'q');
  const ChildAnswer answer = Ask("cat", question);
  EXPECT_TRUE(answer.bytes == question);
  EXPECT_EQ(answer.end, ChildAnswer::End::kFinished);
  EXPECT_EQ(answer.signal, 0);
}

TEST(IsolatedChild, AnswersAnEmptyQuestion) { EXPECT_EQ(Ask("cat; echo end", "").bytes, "end\n"); }

TEST(IsolatedChild, IsAnsweredByOneThatDoesNotReadTheQuestion) {
  EXPECT_EQ(Ask("echo enough", std::string(3 << 20, 'q')).bytes, "enough\n");
}

TEST(IsolatedChild, SaysBySignalHowTheChildCrashed) {
  const ChildAnswer answer = Ask("echo begun; kill -SEGV $$", "");
  EXPECT_EQ(answer.bytes, "begun\n");
  EXPECT_EQ(answer.end, ChildAnswer::End::kFinished);
  EXPECT_EQ(answer.signal, SIGSEGV);
}

TEST(IsolatedChild, KillsOneWhoseTimeIsUp) {
  ChildOptions options;
  options.time_limit = std::chrono::seconds(0);
  EXPECT_EQ(Ask("while true; do :; done", "", options).end, ChildAnswer::End::kOutOfTime);
}

TEST(IsolatedChild, IsHeardWhileItAnswers) {
  ChildOptions options;
  std::string heard;
  options.heard = [&](std::string_view piece) { heard += piece; };
  const ChildAnswer answer = Ask("echo begun; cat; echo done", "question\n", options);
  EXPECT_EQ(answer.bytes, "begun\nquestion\ndone\n");
  EXPECT_EQ(heard, answer.bytes);
}

TEST(IsolatedChild, KillsOneThatNobodyWaitsForAnyMore) {
  ChildOptions options;
  bool has_begun = false;
  options.heard = [&](std::string_view) { has_begun = true; };
  options.is_given_up = [&] { return has_begun; };
  const ChildAnswer answer = Ask("echo begun; while true; do :; done", "", options);
  EXPECT_EQ(answer.end, ChildAnswer::End::kGivenUp);
  EXPECT_EQ(answer.bytes, "begun\n");
}

TEST(IsolatedChild, KillsOneThatAnswersWithoutEnd) {
  ChildOptions options;
  options.max_answer = 100'000;
  const ChildAnswer answer = Ask("while true; do echo more; done", "", options);
  EXPECT_EQ(answer.end, ChildAnswer::End::kAnswerTooLong);
  EXPECT_LT(answer.bytes.size(), 200'000u);
}

TEST(IsolatedChild, IsAnErrorWhereTheProgramIsMissing) {
  ChildOptions options;
  options.program = "/nonexistent/program";
  EXPECT_EQ(AskChild("x", options).status().code(), absl::StatusCode::kInternal);
}

TEST(IsolatedChild, KnowsItsMappedMemory) { EXPECT_GT(MappedMemory(), std::size_t{1} << 20); }

}  // namespace
}  // namespace mortise
