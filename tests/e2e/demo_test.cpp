// The demo in a temporary folder: the main job from a parametric table to cut parts, through real
// processes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
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

class DemoTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::temp_directory_path() / ("mortise-demo-" + NewIdentifier());
    result_ = Mortise({"demo", "--json", "--out", folder_.string(), "--evaluations", "30",
                       "--time-scale", "500"});
    document_ = Json::parse(result_.out, nullptr, false);
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  void SetUp() override {
    ASSERT_EQ(result_.exit_code, 0) << result_.error << result_.out;
    ASSERT_TRUE(document_.is_object()) << result_.out;
  }

  static std::string File(const std::string& name) { return ReadFile(folder_ / name).value_or(""); }

  static std::filesystem::path folder_;
  static CommandResult result_;
  static Json document_;
};

std::filesystem::path DemoTest::folder_;
CommandResult DemoTest::result_;
Json DemoTest::document_;

TEST_F(DemoTest, MakesEveryFileItPromises) {
  EXPECT_EQ(File("table.glb").substr(0, 4), "glTF");
  EXPECT_EQ(File("table.step").substr(0, 12), "ISO-10303-21");
  EXPECT_NE(File("front.svg").find("<svg"), std::string::npos);
  EXPECT_NE(File("front.csv").find("max_displacement"), std::string::npos);
  EXPECT_EQ(File("stress.png").substr(1, 3), "PNG");
  EXPECT_NE(File("analysis.vtu").find("VTKFile"), std::string::npos);
  for (const char* extension : {".csv", ".svg", ".html"}) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      count += entry.path().extension() == extension ? 1 : 0;
    }
    EXPECT_GE(count, 1) << extension;
  }
}

TEST_F(DemoTest, FrontIsATradeOff) {
  const Json& points = document_["front"]["points"];
  ASSERT_GE(points.size(), 3u);
  for (const Json& a : points) {
    for (const Json& b : points) {
      const bool dominates = a["metrics"][0] < b["metrics"][0] && a["metrics"][1] < b["metrics"][1];
      EXPECT_FALSE(dominates) << a << b;
    }
  }
}

TEST_F(DemoTest, ReactionsCarryTheLoad) {
  const Json& analysis = document_["analysis"];
  const double load = analysis["total_load"]["z"].get<double>();
  EXPECT_LT(load, 0);
  EXPECT_NEAR(analysis["total_reaction"]["z"].get<double>(), -load, 1e-6 * std::abs(load));
}

// Eight parts by the chop saw and one by the jigsaw, as the thesis's table.
TEST_F(DemoTest, PlanHasThePartsOfTheThesisTable) {
  EXPECT_EQ(document_["plan"]["chop_saw_parts"], 8);
  EXPECT_EQ(document_["plan"]["jigsaw_parts"], 1);
  EXPECT_GT(document_["plan"]["pegs"], 8);
  EXPECT_GE(document_["plan"]["steps"].size(), 2u);
  EXPECT_GT(document_["plan"]["total"]["amount"].get<double>(), 0);
}

TEST_F(DemoTest, EveryCutIsMadeOnceByAMachine) {
  EXPECT_EQ(document_["work_order"]["state"], "COMPLETED");
  EXPECT_EQ(document_["work_order"]["cuts_done"], document_["work_order"]["cuts_total"]);
  // What the machines themselves wrote down while cutting, one line a cut.
  const std::string journal = File("house/virtual-cell.cuts");
  std::istringstream lines(journal);
  std::map<std::string, int> cuts;
  for (std::string line; std::getline(lines, line);) ++cuts[line];
  EXPECT_EQ(static_cast<int>(cuts.size()), document_["work_order"]["cuts_total"].get<int>())
      << journal;
  for (const auto& [line, count] : cuts) EXPECT_EQ(count, 1) << line;
}

TEST_F(DemoTest, EventLogIsInOrderWithoutGaps) {
  std::istringstream lines(File("events.jsonl"));
  std::map<std::string, long> latest;
  std::set<std::string> types;
  for (std::string line; std::getline(lines, line);) {
    const Json event = Json::parse(line);
    const std::string stream = event["stream"];
    EXPECT_EQ(std::stol(event["number"].get<std::string>()), ++latest[stream]) << line;
    types.insert(event["type"].get<std::string>());
  }
  EXPECT_THAT(types, ::testing::Contains("operation.succeeded"));
  EXPECT_THAT(types, ::testing::Contains("cut.finished"));
}

// Ctrl-C at a terminal reaches the demo only: its house must end with it, and what runs there.
TEST(InterruptedDemo, EndsItsHouse) {
  const auto folder = std::filesystem::temp_directory_path() / ("mortise-demo-" + NewIdentifier());
  std::filesystem::create_directories(folder);
  const std::string log = (folder / "demo.log").string();
  BackgroundCommand demo({"demo", "--out", (folder / "out").string()}, log);
  ASSERT_TRUE(testing::WaitForFiles(
      folder, [&] { return ReadFile(log).value_or("").find("== Check it") != std::string::npos; },
      absl::Minutes(1)))
      << ReadFile(log).value_or("");
  const auto house = cli::ReadRunningHouse(folder / "out" / "house");
  ASSERT_TRUE(house.ok()) << house.status();
  ::kill(demo.pid(), SIGINT);
  EXPECT_EQ(demo.Wait(), 130) << ReadFile(log).value_or("");
  EXPECT_FALSE(ProcessExists(house->launcher));
  for (const cli::RunningProcess& process : house->processes) {
    EXPECT_FALSE(ProcessExists(process.pid)) << process.name;
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace mortise::e2e
