// Logs that do not grow without end: what a process writes, in files of a limited size.
#include "common/base/log_rotation.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/files.h"
#include "common/base/logging.h"
#include "tests/support/temporary_folder.h"

namespace mortise {
namespace {

constexpr int kThreads = 4;
constexpr int kLinesOfEach = 200;

class LogRotationTest : public ::testing::Test {
 protected:
  // Runs `work` in a child whose output goes to the file, as that of a launcher's children does.
  template <typename Work>
  void InChild(const Work& work) const {
    const pid_t child = ::fork();
    if (child == 0) {
      const int file = ::open(File().c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
      ::dup2(file, STDOUT_FILENO);
      ::dup2(file, STDERR_FILENO);
      work();
      ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }

  // kLinesOfEach of each of kThreads, of 1 kB.
  static void WriteLines() {
    std::vector<std::thread> threads;
    for (int t = 0; t < kThreads; ++t) {
      threads.emplace_back([t] {
        for (int i = 0; i < kLinesOfEach; ++i) {
          Log(LogLevel::kInfo, absl::StrCat("line ", t, " ", i),
              {{"filler", std::string(900, 'x')}});
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  }

  std::string File() const { return (folder_.path() / "probe.log").string(); }

  // The lines of the file that is so many files old; none if there is none.
  std::vector<std::string> Lines(int age) const {
    const auto text = ReadFile(age == 0 ? File() : absl::StrCat(File(), ".", age));
    if (!text.ok()) return {};
    return absl::StrSplit(*text, '\n', absl::SkipEmpty());
  }

  testing::TemporaryFolder folder_;
};

TEST_F(LogRotationTest, KeepsEveryLineWhole) {
  InChild([this] {
    ::setenv("MORTISE_LOG_FILE", File().c_str(), 1);
    ::setenv("MORTISE_LOG_MEGABYTES", "0.25", 1);
    ConfigureLogging("probe", LogLevel::kInfo);
    WriteLines();
  });
  std::size_t lines = 0;
  for (int age = 0; age <= kKeptLogFiles; ++age) {
    for (const std::string& line : Lines(age)) {
      EXPECT_EQ(line.front(), '{');
      EXPECT_EQ(line.back(), '}');
    }
    lines += Lines(age).size();
    std::error_code ignored;
    const auto size =
        std::filesystem::file_size(age == 0 ? File() : absl::StrCat(File(), ".", age), ignored);
    EXPECT_TRUE(ignored || size < 252'000u) << size;
  }
  EXPECT_EQ(lines, static_cast<std::size_t>(kThreads * kLinesOfEach));
  EXPECT_FALSE(Lines(3).empty());
}

TEST_F(LogRotationTest, KeepsSoManyFilesAndTheNewestLines) {
  InChild([this] {
    ::setenv("MORTISE_LOG_FILE", File().c_str(), 1);
    ::setenv("MORTISE_LOG_MEGABYTES", "0.05", 1);
    ConfigureLogging("probe", LogLevel::kInfo);
    WriteLines();
    Log(LogLevel::kInfo, "the last line");
  });
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    EXPECT_LT(entry.file_size(), 52'000u);
    ++files;
  }
  EXPECT_EQ(files, kKeptLogFiles + 1);
  ASSERT_FALSE(Lines(0).empty());
  EXPECT_NE(Lines(0).back().find("the last line"), std::string::npos);
}

// What libraries print stands in the same files.
TEST_F(LogRotationTest, TakesWhatOthersPrintToo) {
  InChild([this] {
    ::setenv("MORTISE_LOG_FILE", File().c_str(), 1);
    ::setenv("MORTISE_LOG_MEGABYTES", "0.01", 1);
    ConfigureLogging("probe", LogLevel::kInfo);
    const std::string chatter(20'000, 'c');
    if (::write(STDOUT_FILENO, chatter.data(), chatter.size()) < 0) ::_exit(1);
    Log(LogLevel::kInfo, "full");
    if (::write(STDOUT_FILENO, "printed\n", 8) < 0) ::_exit(1);
  });
  EXPECT_EQ(Lines(1).size(), 1u);
  EXPECT_EQ(Lines(0), std::vector<std::string>{"printed"});
}

// A child that inherits the environment must not rename the file of its parent.
TEST_F(LogRotationTest, LeavesAloneWhatIsNotItsOwn) {
  const std::string other = (folder_.path() / "other.log").string();
  ASSERT_TRUE(WriteFile(other, "of another").ok());
  InChild([&] {
    ::setenv("MORTISE_LOG_FILE", other.c_str(), 1);
    ::setenv("MORTISE_LOG_MEGABYTES", "0.01", 1);
    ConfigureLogging("probe", LogLevel::kInfo);
    WriteLines();
  });
  EXPECT_EQ(*ReadFile(other), "of another");
  EXPECT_EQ(Lines(0).size(), static_cast<std::size_t>(kThreads * kLinesOfEach));
}

}  // namespace
}  // namespace mortise
