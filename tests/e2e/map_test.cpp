// A map of the table that ships, by the command line: built by the house's worker, asked, held
// against its evaluator, found, labelled, and deleted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "tests/e2e/command.h"
#include "tests/e2e/running_house.h"
#include "tests/support/opened_page.h"
#include "tests/support/temporary_folder.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

// A mesh that is coarse, so that an evaluation takes no time.
const std::vector<std::string> kCoarse = {"--element-size", "250mm", "--linear"};

class MapTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<RunningHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  void SetUp() override { ASSERT_TRUE(house_->Serving()) << house_->Log(); }

  static CommandResult Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"--gateway", house_->GrpcAddress()});
    return Mortise(arguments);
  }

  // Runs a command with --json that must succeed, and takes its document.
  static Json Ask(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "--json");
    const CommandResult result = Run(std::move(arguments));
    EXPECT_EQ(result.exit_code, 0) << result.out << result.error;
    return Json::parse(result.out, nullptr, false);
  }

  // A map of the table's mass and sag over its length and width.
  static Json Build(std::vector<std::string> more) {
    std::vector<std::string> arguments = {
        "map",    "build",        "table",  "--metric",     "mass", "--metric", "max_displacement",
        "--vary", "length=1:1.4", "--vary", "width=0.6:0.8"};
    arguments.insert(arguments.end(), kCoarse.begin(), kCoarse.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Ask(arguments);
  }

  // What the evaluator itself says of a table.
  static double Evaluated(const std::string& metric, const std::string& length,
                          const std::string& width) {
    std::vector<std::string> arguments = {"analyze", "table",         "--metric",
                                          metric,    "--set",         "length=" + length,
                                          "--set",   "width=" + width};
    arguments.insert(arguments.end(), kCoarse.begin(), kCoarse.end());
    return Ask(arguments)["metrics"][0]["value"].get<double>();
  }

  static std::unique_ptr<RunningHouse> house_;
};

std::unique_ptr<RunningHouse> MapTest::house_;

TEST_F(MapTest, AnswersAsItsEvaluatorDoes) {
  const Json map = Build({"--samples", "24", "--label", "customer=acme"});
  const std::string name = map["name"].get<std::string>();
  EXPECT_THAT(name, ::testing::StartsWith("maps/"));
  EXPECT_EQ(map["parameters"].size(), 2u);
  EXPECT_EQ(map["labels"]["customer"], "acme");

  // A corner is a sample, and metres are millimetres.
  const Json corner = Ask({"map", "evaluate", name, "--at", "length=1.4,width=600mm"});
  EXPECT_NEAR(corner["points"][0]["mass"].get<double>(), Evaluated("mass", "1.4", "0.6"), 1e-9);
  EXPECT_NEAR(corner["points"][0]["max_displacement"].get<double>(),
              Evaluated("max_displacement", "1.4", "0.6"), 1e-12);

  // Between samples, the mass of a table is nearly a plane; heavier the longer it is.
  const Json inside = Ask({"map", "evaluate", name, "--at", "length=1.13,width=0.71", "--at",
                           "width=0.71,length=1.23", "--gradients", "--errors"});
  ASSERT_EQ(inside["points"].size(), 2u);
  const double mass = inside["points"][0]["mass"].get<double>();
  EXPECT_NEAR(mass, Evaluated("mass", "1.13", "0.71"), 0.01 * mass);
  EXPECT_LT(mass, inside["points"][1]["mass"].get<double>());
  EXPECT_GT(inside["gradients"][0]["mass"]["length"].get<double>(), 0);
  EXPECT_GE(inside["errors"][0]["max_displacement"].get<double>(), 0);

  const Json verified = Ask({"map", "verify", name, "--random", "3"});
  EXPECT_EQ(verified["verification"]["points"], "3");
  EXPECT_EQ(Ask({"map", "show", name})["verification"], verified["verification"]);
}

// What is best for a length and for another, by one map of an integral of a field (§6.7.1).
TEST_F(MapTest, FindsWhereTheIntegralOfStressIsLeastAndHasItEvaluated) {
  const std::string integral = "von_mises_integral";
  const Json map = Build({"--metric", integral, "--metric", "mean_von_mises", "--samples", "24"});
  const std::string name = map["name"].get<std::string>();
  for (const std::string length : {"1.1", "1.35"}) {
    const Json found = Ask({"map", "optimize", name, "--minimize", integral, "--limit",
                            "mean_von_mises=1kPa:10MPa", "--fix", "length=" + length});
    const double width = found["parameters"]["width"].get<double>();
    const double evaluated = found["evaluated"][integral].get<double>();
    EXPECT_EQ(found["evaluated_objective"], evaluated);
    EXPECT_NEAR(evaluated, Evaluated(integral, length, absl::StrFormat("%.17g", width)),
                1e-9 * evaluated);
    EXPECT_NEAR(found["objective"].get<double>(), evaluated, 0.1 * evaluated);
    EXPECT_EQ(found["missed"], Json::object());
    for (const std::string other : {"0.6", "0.7", "0.8"}) {
      EXPECT_LE(found["objective"].get<double>(),
                Ask({"map", "evaluate", name, "--at",
                     "length=" + length + ",width=" + other})["points"][0][integral]
                        .get<double>() *
                    (1 + 1e-9));
    }
  }
}

TEST_F(MapTest, IsTheSameForTheSameSeed) {
  const std::string first = Build({"--samples", "16", "--seed", "3"})["name"].get<std::string>();
  const std::string second = Build({"--samples", "16", "--seed", "3"})["name"].get<std::string>();
  const auto values = [](const std::string& name) {
    return Ask({"map", "evaluate", name, "--at", "length=1.13,width=0.71", "--errors"});
  };
  EXPECT_NE(first, second);
  EXPECT_EQ(values(first), values(second));
}

TEST_F(MapTest, IsAPageThatSaysTheSameInABrowser) {
  const std::string name = Build({"--samples", "20"})["name"].get<std::string>();
  const testing::TemporaryFolder folder;
  const auto page = folder.path() / "table.html";
  const Json written = Ask({"map", "explore", name, "--output", page.string()});
  EXPECT_EQ(written["structures"], 1);
  EXPECT_EQ(written["bytes"], std::filesystem::file_size(page));
  const std::vector<std::vector<double>> designs = {
      {1, 0.6}, {1.13, 0.71}, {1.4, 0.8}, {1.2, 0.7}, {1.3333, 0.6001}};
  const Json opened = testing::OpenPage(page, designs);
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const Json asked =
        Ask({"map", "evaluate", name, "--errors", "--at",
             absl::StrFormat("length=%.17g,width=%.17g", designs[i][0], designs[i][1])});
    const std::vector<std::string> metrics = {"mass", "max_displacement"};
    for (std::size_t m = 0; m < metrics.size(); ++m) {
      const double value = asked["points"][0][metrics[m]].get<double>();
      EXPECT_NEAR(opened["answers"][i]["values"][m].get<double>(), value, 1e-9 * std::abs(value));
      EXPECT_EQ(opened["answers"][i]["errors"][m], asked["errors"][0][metrics[m]]);
    }
  }
}

TEST_F(MapTest, IsFoundLabelledAndDeletedAsAnyResource) {
  const std::string name =
      Build({"--samples", "10", "--external-id", "M-17"})["name"].get<std::string>();
  EXPECT_EQ(Ask({"map", "list", "--external-id", "M-17"})[0]["name"], name);
  EXPECT_EQ(Ask({"list", "maps", "--subject", "templates/table", "--external-id", "M-17"}).size(),
            1u);
  Ask({"label", name, "state=draft"});
  EXPECT_EQ(Ask({"map", "show", name})["labels"]["state"], "draft");
  EXPECT_THAT(Run({"find", "M-17"}).out, HasSubstr(name));
  Ask({"map", "delete", name});
  EXPECT_THAT(Run({"map", "show", name}).error, HasSubstr(name));
}

TEST_F(MapTest, FaultsNameTheFlag) {
  const auto expect = [](std::vector<std::string> arguments, const std::string& what) {
    const CommandResult result = Run(arguments);
    EXPECT_NE(result.exit_code, 0);
    EXPECT_THAT(result.error, HasSubstr(what));
  };
  expect({"map", "build", "table", "--metric", "beauty"}, "--metric beauty");
  expect({"map", "build", "table", "--metric", "mass", "--vary", "depth"}, "--vary depth");
  expect({"map", "build", "table", "--metric", "mass", "--vary", "length=3:4"}, "--vary length");
  expect({"map", "evaluate", "maps/none", "--at", "length=1"}, "maps/none");
}

}  // namespace
}  // namespace mortise::e2e
