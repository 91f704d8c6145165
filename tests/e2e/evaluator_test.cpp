// A customer's evaluator, the manual's in Python, behind the gateway as at a customer's: it takes
// its tasks there, and a trade-off of what only it can compute is found through the same door.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "absl/strings/str_replace.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "tests/e2e/command.h"
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
      run = ask({"pareto", "run", "evaluators/spring", "--evaluations", "200", "--minimize", "mass",
                 "--maximize", "stiffness"});
      if (run.error.find("NOT_FOUND") == std::string::npos) break;
    }
    ASSERT_EQ(run.exit_code, 0) << run.error << ReadFile(folder / "spring.log").value_or("");
    const Json front = Json::parse(run.out, nullptr, false);
    ASSERT_FALSE(front.is_discarded()) << run.out;
    ASSERT_EQ(front["parameter_names"], (std::vector<std::string>{"wire", "diameter", "turns"}));
    ASSERT_GE(front["points"].size(), 10u);
    for (const Json& point : front["points"]) {
      const double wire = point["parameters"][0];
      // The fewest turns and the narrowest are both lightest and stiffest: only the wire is traded.
      EXPECT_NEAR(point["parameters"][1].get<double>(), 0.02, 2e-4);
      EXPECT_NEAR(point["parameters"][2].get<double>(), 3, 0.03);
      const double turns = point["parameters"][2], diameter = point["parameters"][1];
      const double stiffness = 80e9 * std::pow(wire, 4) / (8 * std::pow(diameter, 3) * turns);
      EXPECT_NEAR(point["metrics"][1].get<double>(), stiffness, 1e-9 * stiffness);
    }
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace mortise::e2e
