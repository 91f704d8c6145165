// kill -9 of each service in turn while the demo runs: the launcher starts it again, and the demo
// ends with the same result.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "cli/process.h"
#include "cli/state_folder.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "tests/e2e/command.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

// What of a demo must not depend on what died meanwhile.
Json Essence(const Json& document) {
  Json points = Json::array();
  for (const Json& point : document["front"]["points"]) {
    points.push_back({point["parameters"], point["metrics"]});
  }
  return {{"points", points},
          {"cuts", document["work_order"]["cuts_done"]},
          {"state", document["work_order"]["state"]},
          {"total", document["plan"]["total"]}};
}

class FaultTest : public testing::Test {
 protected:
  FaultTest()
      : folder_(std::filesystem::temp_directory_path() / ("mortise-fault-" + NewIdentifier())) {
    std::filesystem::create_directories(folder_);
  }
  ~FaultTest() override { std::filesystem::remove_all(folder_); }

  std::vector<std::string> Arguments(const std::string& name) const {
    return {"demo",          "--json", "--out",        (folder_ / name).string(),
            "--evaluations", "24",     "--time-scale", "100"};
  }

  // A child that has ended still counts as a process until somebody waits for it.
  static bool Runs(pid_t child) {
    siginfo_t ended = {};
    ::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT);
    return ended.si_pid == 0;
  }

  // Waits until the process serves (again) and returns its pid; 0 if the house ends first.
  pid_t WaitForProcess(const std::filesystem::path& state, const std::string& name, pid_t other,
                       pid_t demo) const {
    while (Runs(demo)) {
      const auto house = cli::ReadRunningHouse(state);
      if (house.ok()) {
        for (const auto& process : house->processes) {
          if (process.name == name && process.serving && process.pid != other) return process.pid;
        }
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return 0;
  }

  static void ResumeEveryWorkOrder(const std::filesystem::path& state) {
    const CommandResult list =
        Mortise({"--json", "--house", state.string(), "call", "fabplanner.ListWorkOrders"});
    const Json document = Json::parse(list.out, nullptr, false);
    for (const Json& order : document.value("work_orders", Json::array())) {
      Mortise({"--house", state.string(), "fab", "resume", order["name"].get<std::string>()});
    }
  }

  const std::filesystem::path folder_;
};

TEST_F(FaultTest, DemoEndsTheSameWhenEachServiceIsKilledInTurn) {
  const CommandResult undisturbed = Mortise(Arguments("undisturbed"));
  ASSERT_EQ(undisturbed.exit_code, 0) << undisturbed.error;

  const std::string out = (folder_ / "disturbed.json").string();
  const std::filesystem::path state = folder_ / "disturbed" / "house";
  BackgroundCommand demo(Arguments("disturbed"), out);
  int killed = 0;
  for (const char* name : {"simulator-worker-1", "pareto", "simulator", "gateway", "catalog",
                           "fabplanner", "hwbridge"}) {
    const pid_t pid = WaitForProcess(state, name, 0, demo.pid());
    if (pid == 0) break;
    ASSERT_EQ(::kill(pid, SIGKILL), 0) << name;
    ++killed;
    if (WaitForProcess(state, name, pid, demo.pid()) == 0) break;
    // A bridge that lost power holds its cuts until a person has looked: here, this test.
    if (std::string(name) == "hwbridge") ResumeEveryWorkOrder(state);
  }
  ASSERT_EQ(demo.Wait(), 0) << ReadFile(out).value_or("");
  EXPECT_GE(killed, 5) << "the demo ended before the services could be killed";
  const std::string text = ReadFile(out).value_or("");
  const Json document = Json::parse(text.substr(text.find('{')), nullptr, false);
  ASSERT_TRUE(document.is_object()) << text;
  EXPECT_EQ(Essence(document), Essence(Json::parse(undisturbed.out)));

  std::istringstream journal(ReadFile(folder_ / "disturbed/house/virtual-cell.cuts").value_or(""));
  std::map<std::string, int> cuts;
  for (std::string line; std::getline(journal, line);) ++cuts[line];
  for (const auto& [line, count] : cuts) EXPECT_EQ(count, 1) << line;
}

}  // namespace
}  // namespace mortise::e2e
