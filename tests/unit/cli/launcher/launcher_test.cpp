#include "cli/launcher/launcher.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <thread>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "common/base/process.h"

namespace mortise::cli {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class LauncherTest : public testing::Test {
 protected:
  LauncherTest() {
    options_.state = std::filesystem::path(testing::TempDir()) / NewIdentifier();
    std::filesystem::create_directories(options_.state / "ports");
  }
  ~LauncherTest() override { std::filesystem::remove_all(options_.state); }

  // A process that says that it serves and then waits to be ended.
  HouseProcess Serving(const std::string& name) {
    const std::filesystem::path file = options_.state / "ports" / name;
    return {name, {"/bin/sh", "-c", "echo up > " + file.string() + "; exec sleep 1000"}, "x", file};
  }

  // Lets the launcher work until `done`, for at most ten seconds.
  template <typename Condition>
  bool SuperviseUntil(Launcher& launcher, Condition done) {
    const auto deadline = Launcher::Clock::now() + seconds(10);
    while (Launcher::Clock::now() < deadline) {
      status_ = launcher.Supervise();
      if (!status_.ok()) return false;
      if (done()) return true;
      std::this_thread::yield();
    }
    return false;
  }

  HouseOptions options_;
  absl::Status status_;
};

// Each process keeps its own log from growing without end.
TEST_F(LauncherTest, TellsEachProcessItsLogFile) {
  options_.log_megabytes = 2.5;
  const std::filesystem::path file = options_.state / "ports" / "one";
  HousePlan plan;
  plan.processes = {
      {"one",
       {"/bin/sh", "-c",
        "echo $MORTISE_LOG_FILE $MORTISE_LOG_MEGABYTES > " + file.string() + ".new; mv " +
            file.string() + ".new " + file.string() + "; exec sleep 1000"},
       "x",
       file}};
  Launcher launcher(options_, std::move(plan), [](const RunningHouse&) {});
  ASSERT_TRUE(launcher.Start().ok());
  ASSERT_TRUE(SuperviseUntil(launcher, [&] { return launcher.Serving(); })) << status_;
  EXPECT_EQ(ReadFile(file).value_or(""), (options_.state / "logs" / "one.log").string() + " 2.5\n");
}

TEST_F(LauncherTest, StartsEverythingAndStopsEverything) {
  HousePlan plan;
  plan.processes = {Serving("one"), Serving("two")};
  std::vector<pid_t> pids;
  {
    Launcher launcher(options_, std::move(plan), [](const RunningHouse&) {});
    ASSERT_TRUE(launcher.Start().ok());
    ASSERT_TRUE(SuperviseUntil(launcher, [&] { return launcher.Serving(); })) << status_;
    for (const RunningProcess& process : launcher.house().processes) pids.push_back(process.pid);
  }
  ASSERT_EQ(pids.size(), 2u);
  for (const pid_t pid : pids) EXPECT_FALSE(ProcessExists(pid));
}

TEST_F(LauncherTest, StartsAgainWhatIsKilled) {
  HousePlan plan;
  plan.processes = {Serving("one")};
  Launcher launcher(options_, std::move(plan), [](const RunningHouse&) {});
  ASSERT_TRUE(launcher.Start().ok());
  ASSERT_TRUE(SuperviseUntil(launcher, [&] { return launcher.Serving(); })) << status_;
  const pid_t first = launcher.house().processes[0].pid;
  ::kill(first, SIGKILL);
  ASSERT_TRUE(SuperviseUntil(launcher, [&] {
    return launcher.Serving() && launcher.house().processes[0].pid != first;
  })) << status_;
  EXPECT_EQ(launcher.house().processes[0].restarts, 1);
}

TEST_F(LauncherTest, GivesUpOnWhatNeverServesAndShowsItsLog) {
  HousePlan plan;
  plan.processes = {{"broken",
                     {"/bin/sh", "-c", "echo the disk is full >&2; exit 3"},
                     "x",
                     options_.state / "ports" / "broken"}};
  Launcher launcher(options_, std::move(plan), [](const RunningHouse&) {});
  ASSERT_TRUE(launcher.Start().ok());
  EXPECT_FALSE(SuperviseUntil(launcher, [] { return false; }));
  EXPECT_EQ(DetailOf(status_).reason, "PROCESS_KEEPS_DYING");
  EXPECT_NE(status_.message().find("the disk is full"), absl::string_view::npos) << status_;
  EXPECT_NE(status_.message().find("exit code 3"), absl::string_view::npos) << status_;
}

TEST_F(LauncherTest, KillsWhatDoesNotDrain) {
  const std::filesystem::path file = options_.state / "ports" / "stubborn";
  HousePlan plan;
  plan.processes = {{"stubborn",
                     {"/bin/sh", "-c",
                      "trap '' TERM; echo up > " + file.string() + "; while :; do sleep 1; done"},
                     "x",
                     file}};
  Launcher launcher(options_, std::move(plan), [](const RunningHouse&) {});
  ASSERT_TRUE(launcher.Start().ok());
  ASSERT_TRUE(SuperviseUntil(launcher, [&] { return launcher.Serving(); })) << status_;
  const pid_t pid = launcher.house().processes[0].pid;
  launcher.Stop(milliseconds(50));
  EXPECT_FALSE(ProcessExists(pid));
}

}  // namespace
}  // namespace mortise::cli
