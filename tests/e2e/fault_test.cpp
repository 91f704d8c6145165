// kill -9 of each service in turn while the demo runs: the launcher starts it again, and the demo
// ends with the same result.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "absl/time/time.h"
#include "cli/launcher/state_folder.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "common/base/process.h"
#include "tests/e2e/command.h"
#include "tests/support/file_watch.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;

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

class FaultTest : public ::testing::Test {
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

  // Waits until the process serves (again) and returns its pid; 0 if the house ends first.
  pid_t WaitForProcess(const std::filesystem::path& state, const std::string& name, pid_t other,
                       pid_t demo) const {
    pid_t found = 0;
    const auto serves = [&] {
      const auto house = cli::ReadRunningHouse(state);
      if (!house.ok()) return false;
      for (const auto& process : house->processes) {
        if (process.name == name && process.serving && process.pid != other) found = process.pid;
      }
      return found != 0;
    };
    const testing::ProcessEnd end(demo);
    // The demo begins with a new folder; one that it removes cannot be watched.
    std::filesystem::create_directories(state.parent_path());
    const auto begun = [&] { return std::filesystem::exists(state); };
    testing::WaitForFiles(state.parent_path(), begun, absl::Minutes(5), end.descriptor());
    if (!begun()) return 0;
    testing::WaitForFiles(state, serves, absl::Minutes(5), end.descriptor());
    return found;
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
