// A customer's evaluator, the manual's in Python, behind the gateway as at a customer's: it takes
// its tasks there, and a trade-off of what only it can compute is found through the same door.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "absl/strings/str_replace.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "tests/e2e/command.h"
#include "tests/e2e/http_post.h"
#include "tests/e2e/running_house.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;

std::filesystem::path Source() {
  const char* folder = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::absolute(folder == nullptr ? "." : folder);
}

// The page's commands: how to generate code, and how to start the evaluator.
std::pair<std::string, std::string> PageCommands() {
  const std::string page = ReadFile(Source() / "docs/evaluators.md").value();
  const std::string fence = "```sh evaluators\n";
  const std::size_t begin = page.find(fence) + fence.size();
  const std::string block = page.substr(begin, page.find("```", begin) - begin);
  const std::size_t split = block.find("PYTHONPATH");
  return {block.substr(0, split), block.substr(split)};
}

TEST(CustomersEvaluator, IsExploredThroughTheGateway) {
  const RunningHouse house;
  ASSERT_TRUE(house.Serving()) << house.Log();
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("mortise-evaluator-" + NewIdentifier());
  std::filesystem::create_directories(folder);
  for (const char* name : {"protos", "docs"}) {
    std::filesystem::create_symlink(Source() / name, folder / name);
  }
  const auto [generate, start] = PageCommands();
  const CommandResult generated = Shell(generate, folder);
  ASSERT_EQ(generated.exit_code, 0) << generated.error;
  {
    const auto evaluator = BackgroundCommand::InShell(
        "env " + absl::StrReplaceAll(start, {{"127.0.0.1:7700", house.GrpcAddress()}}), folder,
        (folder / "spring.log").string());
    // It registers itself; who comes earlier is told that it is not there.
    const auto ask = [&house](std::vector<std::string> arguments) {
      arguments.insert(arguments.begin(), {"--json", "--gateway", house.GrpcAddress()});
      return Mortise(arguments);
    };
    CommandResult run;
    for (int i = 0; i < 100; ++i) {
      run = ask({"pareto", "run", "evaluators/spring", "--evaluations", "400", "--minimize", "mass",
                 "--maximize", "stiffness"});
      if (run.error.find("NOT_FOUND") == std::string::npos) break;
    }
    ASSERT_EQ(run.exit_code, 0) << run.error << ReadFile(folder / "spring.log").value_or("");
    const Json front = Json::parse(run.out, nullptr, false);
    ASSERT_FALSE(front.is_discarded()) << run.out;
    ASSERT_EQ(front["parameter_names"],
              (std::vector<std::string>{"wire", "diameter", "turns", "material"}));
    ASSERT_EQ(front["parameter_choices"][3]["names"],
              (std::vector<std::string>{"steel", "titanium"}));
    EXPECT_EQ(front["combinations"]["possible"], "16") << "8 numbers of turns of 2 materials";
    ASSERT_GE(front["points"].size(), 10u);
    std::set<std::string> materials;
    for (const Json& point : front["points"]) {
      const double wire = point["parameters"][0], diameter = point["parameters"][1];
      // The fewest turns and the narrowest are both lightest and stiffest: only the wire and the
      // material are traded.
      EXPECT_NEAR(diameter, 0.02, 2e-4);
      EXPECT_EQ(point["parameters"][2], 3);
      const std::string material = point["choices"][3];
      materials.insert(material);
      EXPECT_EQ(point["parameters"][3], material == "steel" ? 0 : 1);
      const double modulus = material == "steel" ? 80e9 : 44e9;
      const double stiffness = modulus * std::pow(wire, 4) / (8 * std::pow(diameter, 3) * 3);
      EXPECT_NEAR(point["metrics"][1].get<double>(), stiffness, 1e-9 * stiffness);
    }
    // Titanium is lighter as far as its thickest wire is stiff.
    EXPECT_EQ(materials, (std::set<std::string>{"steel", "titanium"}));

    const Json described = Json::parse(ask({"pareto", "describe", "evaluators/spring"}).out);
    EXPECT_EQ(described["parameters"][3]["choices"][1], "titanium");
    const auto run_with = [&](const std::string& option, const std::string& value) {
      return ask({"pareto", "run", "evaluators/spring", "--evaluations", "40", "--minimize", "mass",
                  "--maximize", "stiffness", option, value});
    };
    const Json steel = Json::parse(run_with("--fix", "material=steel").out, nullptr, false);
    ASSERT_FALSE(steel.is_discarded());
    for (const Json& point : steel["points"]) EXPECT_EQ(point["choices"][3], "steel");
    const CommandResult unknown = run_with("--fix", "material=oak");
    EXPECT_NE(unknown.exit_code, 0);
    EXPECT_THAT(unknown.error + unknown.out, testing::HasSubstr("steel, titanium"));
    const CommandResult ranged = run_with("--range", "material=0:1");
    EXPECT_NE(ranged.exit_code, 0);
    EXPECT_THAT(ranged.error + ranged.out, testing::HasSubstr("is a choice"));
    const Json titanium = Json::parse(run_with("--allow", "material=titanium").out, nullptr, false);
    ASSERT_FALSE(titanium.is_discarded());
    for (const Json& point : titanium["points"]) EXPECT_EQ(point["choices"][3], "titanium");
    EXPECT_NE(run_with("--allow", "turns=3,4").exit_code, 0) << "a number";
  }
  std::filesystem::remove_all(folder);
}

// Through the JSON door, where NaN is a string. What waits is told from the first report of each
// design, long before leases of a minute run out.
TEST(CustomersEvaluator, MayReportNaN) {
  const RunningHouse house;
  ASSERT_TRUE(house.Serving()) << house.Log();
  const auto send = [&house](const std::string& method, const Json& body) {
    return Post(house.HttpAddress(), "/mortise.v1." + method, "application/json", body.dump());
  };
  const Json width = {{"name", "width"}, {"maximum", 1}};
  const Json space = {{"parameters", {width}},
                      {"metrics", {{{"name", "mass"}}, {{"name", "cost"}}}}};
  const Json evaluator = {{"name", "evaluators/useless"}, {"version", "1"}, {"space", space}};
  const HttpAnswer created = send("EvaluatorService/CreateEvaluator",
                                  {{"requestId", NewIdentifier()}, {"evaluator", evaluator}});
  ASSERT_EQ(created.status, 200) << created.body;
  CommandResult run;
  std::atomic<bool> ended = false;
  std::thread asking([&] {
    run = Mortise({"--gateway", house.GrpcAddress(), "pareto", "run", "evaluators/useless",
                   "--minimize", "mass", "--minimize", "cost", "--evaluations", "12"});
    ended = true;
  });
  int reports = 0;
  while (!ended) {
    const HttpAnswer leased =
        send("SimulatorService/LeaseTasks", {{"evaluator", "evaluators/useless"},
                                             {"worker", "useless"},
                                             {"limit", 4},
                                             {"leaseSeconds", 60},
                                             {"waitSeconds", 1}});
    const Json tasks = Json::parse(leased.body, nullptr, false).value("tasks", Json::array());
    for (const Json& task : tasks) {
      EXPECT_EQ(task["attempt"], 1);
      const Json metrics = {
          {{"name", "mass"}, {"value", 1}},
          {{"name", "cost"}, {"value", ++reports % 2 == 0 ? "NaN" : "-Infinity"}}};
      const HttpAnswer told = send(
          "SimulatorService/ReportTask",
          {{"task", {{"name", task["name"]}, {"attempt", 1}}}, {"result", {{"metrics", metrics}}}});
      EXPECT_EQ(told.status, 400);
      EXPECT_THAT(told.body, testing::HasSubstr("result.metrics[1].value"));
    }
  }
  asking.join();
  EXPECT_EQ(reports, 12);
  EXPECT_NE(run.exit_code, 0);
  EXPECT_THAT(run.error, testing::HasSubstr("12 NOT_FINITE, such as: not a finite number: cost"));
}

}  // namespace
}  // namespace mortise::e2e
