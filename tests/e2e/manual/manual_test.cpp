// Runs the commands of README.md and docs/ on a real house, as they stand there. What cannot be run
// literally, and how it is checked instead:
//   ./dev COMMAND           COMMAND is one that `./dev help` lists; `./dev up` as `mortise up`
//   mortise up              with --dry-run
//   mortise-SERVICE …       until it serves, on free ports
//   blocks ```sh not-run    every flag is one that the program's --help lists
//   blocks ```sh costly     with few evaluations instead of as many as they say
//   blocks ```sh secure-…   by secure_house_test
//   blocks ```sh evaluators by evaluator_page_test
//   blocks ```sh integration by integration_page_test
//   blocks ```sh slurm      by slurm_workers_test
//   blocks ```sh kubernetes by kubernetes_manifests_test
//   export PATH=…           left out: the programs are on the PATH
#include "tests/e2e/manual/manual.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "tests/e2e/command.h"
#include "tests/support/file_watch.h"

namespace mortise::e2e {
namespace {

std::filesystem::path Source() {
  const char* folder = std::getenv("MORTISE_SOURCE_DIR");
  return folder == nullptr ? "." : folder;
}

// Marks of blocks that other tests run.
const std::set<std::string> kRunElsewhere = {"secure-house", "evaluators", "integration", "slurm",
                                             "kubernetes"};

class Manual : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::temp_directory_path() / ("mortise-manual-" + NewIdentifier());
    std::filesystem::create_directories(folder_);
    for (const char* part : {"collection", "tools"}) {
      std::filesystem::create_directory_symlink(Source() / part, folder_ / part);
    }
    house_ = BackgroundCommand::InShell(
        "mortise up --insecure-development --any-ports --workers 2 --virtual-cell --time-scale 500",
        folder_, (folder_ / "up.log").string());
    serving_ = AwaitHouse(folder_ / ".mortise");
  }
  static void TearDownTestSuite() {
    house_.reset();
    std::filesystem::remove_all(folder_);
  }

  void SetUp() override { ASSERT_TRUE(serving_) << ReadFile(folder_ / "up.log").value_or(""); }

  static void ExpectSuccess(const std::string& place, const std::string& command,
                            const CommandResult& result) {
    EXPECT_EQ(result.exit_code, 0) << place << ": " << command << "\n"
                                   << result.out << result.error;
  }

  static void CheckDev(const std::string& place, const std::string& command) {
    static const std::string help = Shell("./dev help", Source()).out;
    std::string name = command.substr(6);
    name = name.substr(0, name.find(' '));
    EXPECT_THAT(help, ::testing::ContainsRegex("\n  " + name + " ")) << place << ": " << command;
  }

  static void CheckUp(const std::string& place, const std::string& arguments) {
    ExpectSuccess(place, "mortise up" + arguments,
                  Shell("mortise up --dry-run --any-ports" + arguments, folder_));
  }

  // Every flag of a command that is not run is one its program knows.
  static void CheckFlags(const std::string& place, const std::string& command) {
    const std::string program = command.substr(0, command.find(' '));
    const CommandResult help = Shell(program + " --help", folder_);
    ExpectSuccess(place, program + " --help", help);
    static const std::regex flag("--[a-z][a-z-]*");
    for (auto match = std::sregex_iterator(command.begin(), command.end(), flag);
         match != std::sregex_iterator(); ++match) {
      EXPECT_THAT(help.out, ::testing::HasSubstr(match->str())) << place << ": " << command;
    }
  }

  // The fewest that there are: that the command does what it says shows with them too.
  static std::string WithFewEvaluations(const std::string& command) {
    static const std::regex budget("--evaluations [0-9]+");
    return std::regex_replace(command, budget, "--evaluations 10");
  }

  // Starts a server or a worker and waits until it says that it serves, or works.
  static void CheckServer(const std::string& place, const std::string& command) {
    static const std::regex listener("(--grpc|--http|--listen) 127\\.0\\.0\\.1:[0-9]+");
    const std::string log = (folder_ / ("server-" + NewIdentifier() + ".log")).string();
    const auto server = BackgroundCommand::InShell(
        std::regex_replace(command, listener, "$1 127.0.0.1:0"), folder_, log);
    const auto serves = [&log] {
      const std::string printed = ReadFile(log).value_or("");
      return absl::StrContains(printed, "\"message\":\"serving\"") ||
             absl::StrContains(printed, "\"message\":\"working\"");
    };
    EXPECT_TRUE(testing::WaitForFiles(folder_, serves, absl::Minutes(1)))
        << place << ": " << command << "\n"
        << ReadFile(log).value_or("");
  }

  static void Check(const ManualBlock& block, const ManualCommand& command, StandIns& stand_ins) {
    const std::string place = block.Place(command);
    std::string text = command.text;
    if (absl::StartsWith(text, "build/release/bin/")) text = text.substr(18);
    if (block.mark == "not-run") return CheckFlags(place, text);
    if (block.mark == "costly") text = WithFewEvaluations(text);
    if (absl::StartsWith(text, "export PATH=")) return;
    if (absl::StartsWith(text, "./dev up")) return CheckUp(place, text.substr(8));
    if (absl::StartsWith(text, "./dev ")) return CheckDev(place, text);
    if (absl::StartsWith(text, "mortise up")) return CheckUp(place, text.substr(10));
    if (absl::StartsWith(text, "mortise-")) return CheckServer(place, text);
    const CommandResult result = Shell("TOKEN=none\n" + stand_ins.Replace(text), folder_);
    ExpectSuccess(place, stand_ins.Replace(text), result);
    stand_ins.Learn(result.out);
  }

  static std::filesystem::path folder_;
  static std::unique_ptr<BackgroundCommand> house_;
  static bool serving_;
};

std::filesystem::path Manual::folder_;
std::unique_ptr<BackgroundCommand> Manual::house_;
bool Manual::serving_ = false;

TEST_F(Manual, EveryCommandDoesWhatItSays) {
  int checked = 0;
  for (const std::string& document : ManualDocuments()) {
    StandIns stand_ins(folder_ / ".mortise");
    for (const ManualBlock& block : ReadManual(document)) {
      if (kRunElsewhere.count(block.mark) > 0) continue;
      EXPECT_THAT(block.mark, ::testing::AnyOf("", "not-run", "costly")) << document;
      for (const ManualCommand& command : block.commands) {
        Check(block, command, stand_ins);
        ++checked;
      }
    }
  }
  EXPECT_GE(checked, 15);
}

TEST_F(Manual, MarkedBlocksAreFew) {
  int not_run = 0;
  for (const std::string& document : ManualDocuments()) {
    for (const ManualBlock& block : ReadManual(document)) {
      not_run += block.mark == "not-run" ? 1 : 0;
    }
  }
  EXPECT_LE(not_run, 2);
}

}  // namespace
}  // namespace mortise::e2e
