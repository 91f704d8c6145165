// A house as a person runs it: started, asked, stopped; and what goes wrong, said clearly.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <thread>

#include "cli/launcher/state_folder.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "tests/e2e/command.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class HouseTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::temp_directory_path() / ("mortise-house-" + NewIdentifier());
    std::filesystem::create_directories(folder_);
    house_ = std::make_unique<BackgroundCommand>(
        std::vector<std::string>{"up", "--insecure-development", "--any-ports", "--workers", "1",
                                 "--state", State()},
        (folder_ / "up.log").string());
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!Serving() && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  }
  static void TearDownTestSuite() {
    house_.reset();
    std::filesystem::remove_all(folder_);
  }

  void SetUp() override { ASSERT_TRUE(Serving()) << ReadFile(folder_ / "up.log").value_or(""); }

  static std::string State() { return (folder_ / "state").string(); }

  static bool Serving() {
    const auto house = cli::ReadRunningHouse(State());
    if (!house.ok() || house->processes.empty()) return false;
    for (const auto& process : house->processes) {
      if (!process.serving) return false;
    }
    return true;
  }

  // Runs a command on this house with --json and checks that it printed one document and no more.
  static Json Ask(std::vector<std::string> arguments, int expected_code = 0) {
    arguments.insert(arguments.begin(), {"--json", "--house", State()});
    const CommandResult result = Mortise(arguments);
    EXPECT_EQ(result.exit_code, expected_code) << result.error;
    const Json document = Json::parse(result.out, nullptr, false);
    EXPECT_FALSE(document.is_discarded()) << result.out;
    return document;
  }

  static std::filesystem::path folder_;
  static std::unique_ptr<BackgroundCommand> house_;
};

std::filesystem::path HouseTest::folder_;
std::unique_ptr<BackgroundCommand> HouseTest::house_;

TEST_F(HouseTest, StatusNamesEveryProcess) {
  const Json status = Ask({"status", "--state", State()});
  EXPECT_EQ(status["processes"].size(), 9u);
}

TEST_F(HouseTest, CatalogIsFilledWithTheCollection) {
  EXPECT_GE(Ask({"catalog", "list", "items"}).size(), 5u);
  EXPECT_GE(Ask({"catalog", "list", "materials"}).size(), 2u);
  EXPECT_GE(Ask({"catalog", "list"}).size(), 1u);
  EXPECT_EQ(Ask({"catalog", "show", "templates/table"})["name"], "templates/table");
}

TEST_F(HouseTest, AnyMethodCanBeCalled) {
  const Json answer = Ask({"call", "catalog.GetTemplate", R"({"name": "templates/table"})"});
  EXPECT_EQ(answer["name"], "templates/table");
  const Json house = Ask({"call", "mortise.v1.GatewayService/GetHouse"});
  for (const Json& service : house["services"]) {
    EXPECT_TRUE(service["healthy"].get<bool>()) << service;
  }
}

TEST_F(HouseTest, TableIsEvaluatedAtParameters) {
  const Json design = Ask({"catalog", "evaluate", "table", "--set", "length=1500mm"});
  EXPECT_EQ(design["parts"].size(), 9u);
}

// Metrics alone, without an analysis: some of the shape, one of the loads.
TEST_F(HouseTest, MetricsAreEvaluatedAtParameters) {
  const auto values = [&](const std::string& length) {
    const Json result =
        Ask({"analyze", "table", "--set", "length=" + length, "--metric", "mass", "--metric",
             "toppling_margin", "--metric", "cost", "--metric", "max_displacement"});
    EXPECT_EQ(result["metrics"].size(), 4u);
    EXPECT_EQ(result["metrics"][2]["unit"], "EUR");
    std::vector<double> numbers;
    for (const Json& metric : result["metrics"]) numbers.push_back(metric["value"].get<double>());
    return numbers;
  };
  const std::vector<double> small = values("1200mm"), large = values("1.6m");
  EXPECT_LT(small[0], large[0]);
  EXPECT_NEAR(small[1], large[1], 1e-6);  // across the table, which is as wide as it was
  EXPECT_LT(small[2], large[2]);
  EXPECT_LT(small[3], large[3]);
}

// What people read of an analysis: an error in per cent and what helps against it, and no rounding.
TEST_F(HouseTest, AnalysesAreToldInWords) {
  const CommandResult told =
      Mortise({"--house", State(), "analyze", "table", "--linear", "--relative-error", "0.5"});
  ASSERT_EQ(told.exit_code, 0) << told.error;
  EXPECT_THAT(told.out, ::testing::ContainsRegex("relative_error +[0-9]+ %"));
  EXPECT_THAT(told.out, HasSubstr("note: stresses may be off by about"));
  EXPECT_THAT(told.out, HasSubstr("--relative-error 0.05"));
  EXPECT_THAT(told.out, ::testing::Not(::testing::ContainsRegex("e-1[0-9] mm")));
  const Json document = Ask({"analyze", "table", "--linear", "--relative-error", "0.5"});
  for (const Json& metric : document["metrics"]) {
    if (metric["name"] != "relative_error") continue;
    EXPECT_LE(metric["value"].get<double>(), 0.5);
  }
}

// The sun on one side, air on the other: the thicker, the warmer in the sun, and the heavier.
constexpr char kWarmBoard[] =
    "# proto-file: mortise/v1/template.proto\n"
    "# proto-message: mortise.v1.Template\n"
    "name: 'templates/warm-board' title: 'Board in the sun' "
    "parameters { name: 'thickness' unit: 'm' minimum: 0.02 maximum: 0.1 default_value: 0.04 } "
    "parameters { name: 'length' unit: 'm' minimum: 0.4 maximum: 0.8 default_value: 0.5 } "
    "parts { name: 'board' item: 'items/spruce-planed-2400' length_axis: X thickness_axis: Z "
    "box { x { from: '0' to: 'length' } y { from: '0' to: '0.2' } z { from: '0' to: 'thickness' } "
    "} } boundary_conditions { name: 'sun' kind: HEAT_FLUX part: 'board' face: 'z_max' "
    "components: '500' } boundary_conditions { name: 'air' kind: CONVECTION part: 'board' "
    "face: 'z_min' components: '10' components: '293.15' }";

// Temperatures and where the heat goes, of a whole analysis and of an optimisation.
TEST_F(HouseTest, AHeatedDesignIsAnalysedAndOptimised) {
  const std::string out = (folder_ / "drum").string();
  const Json analysis =
      Ask({"analyze", "drum-brake", "--linear", "--element-size", "20mm", "--out", out});
  const double supplied = analysis["heat"]["supplied"].get<double>();
  EXPECT_GT(supplied, 400);
  EXPECT_NEAR(analysis["heat"]["convected"][0].get<double>(), supplied, 1e-6 * supplied);
  EXPECT_EQ(ReadFile(out + "/heat.png").value_or("").substr(1, 3), "PNG");
  EXPECT_THAT(ReadFile(out + "/heat.vtu").value_or(""), HasSubstr("temperature"));
  EXPECT_EQ(ReadFile(out + "/stress.png").value_or("").substr(1, 3), "PNG");
  const Json error =
      Ask({"analyze", "wrench", "--metric", "heat_dissipation", "--linear"}, 1)["error"];
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("HEAT_FLUX"));
  const std::string board = (folder_ / "board.textproto").string();
  ASSERT_TRUE(WriteFile(board, kWarmBoard).ok());
  Ask({"catalog", "import", board});
  const std::string specification = (folder_ / "board.json").string();
  ASSERT_TRUE(WriteFile(specification,
                        R"({"subject": "templates/warm-board", "seed": 1, "evaluations": 20,
                            "objectives": [{"metric": "mass"},
                                           {"metric": "max_temperature", "maximize": true}],
                            "mesh": {"linear": true, "element_size": 0.1}})")
                  .ok());
  const Json front = Ask({"pareto", "run", specification});
  ASSERT_GE(front["points"].size(), 2u) << front;
  for (const Json& point : front["points"]) {
    const double thickness = point["parameters"][0].get<double>();
    EXPECT_NEAR(point["metrics"][1].get<double>(), 293.15 + 500 / 10.0 + 500 * thickness / 0.12,
                1e-3);
  }
}

TEST_F(HouseTest, FaultsNameWhatIsWrong) {
  Json error = Ask({"catalog", "show", "templates/nothing"}, 1)["error"];
  EXPECT_EQ(error["code"], "NOT_FOUND");
  EXPECT_EQ(error["field"], "templates/nothing");
  error = Ask({"catalog", "evaluate", "table", "--set", "length=-3"}, 1)["error"];
  EXPECT_EQ(error["code"], "INVALID_ARGUMENT");
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("length"));
  error = Ask({"catalog", "evaluate", "table", "--set", "girth=1"}, 1)["error"];
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("girth"));
  EXPECT_EQ(error["field"], "--set girth");
  error = Ask({"call", "catalog.Nothing"}, 1)["error"];
  EXPECT_EQ(error["code"], "NOT_FOUND");
  error = Ask({"call", "catalog.ListItems", R"({"pageSize": "many", "page_size": 3, "mass": 1})"},
              1)["error"];
  for (const char* const field : {"request: page_size", "is there twice", "request: mass"}) {
    EXPECT_THAT(error.dump(), HasSubstr(field));
  }
}

// What a service says of its fields is told of the flags that gave them.
TEST_F(HouseTest, FaultsNameTheFlag) {
  const std::vector<std::string> minimize = {"--minimize", "mass", "--minimize",
                                             "max_displacement"};
  const auto fault = [&](std::vector<std::string> arguments, bool with_objectives = false) {
    if (with_objectives) arguments.insert(arguments.end(), minimize.begin(), minimize.end());
    return Ask(arguments, 1)["error"]["field"].get<std::string>();
  };
  EXPECT_EQ(fault({"catalog", "evaluate", "table", "--set", "width=0.8", "--set", "length=9"}),
            "--set length");
  EXPECT_EQ(fault({"catalog", "list", "--material", "nosuch"}), "--material");
  EXPECT_EQ(fault({"catalog", "list", "--kind", "nosuch"}), "--kind");
  EXPECT_EQ(fault({"analyze", "table", "--element-size", "-3mm"}), "--element-size");
  EXPECT_EQ(fault({"analyze", "table", "--size-scale", "3"}), "--size-scale");
  EXPECT_EQ(fault({"analyze", "table", "--metric", "mass", "--metric", "beauty"}),
            "--metric beauty");
  EXPECT_EQ(fault({"analyze", "table", "--metric", "mass", "--set", "girth=1"}), "--set girth");
  EXPECT_EQ(fault({"analyze", "table", "--modes", "101"}), "--modes");
  EXPECT_EQ(fault({"analyze", "table", "--metric", "mass", "--out", "x"}), "--out");
  EXPECT_EQ(fault({"plan", "table", "--quantity", "-1"}), "--quantity");
  EXPECT_EQ(fault({"plan", "table", "--kerf", "-3mm"}), "--kerf");
  EXPECT_EQ(fault({"plan", "table", "--kerf", "3deg"}), "--kerf");
  EXPECT_EQ(fault({"plan", "table", "--mitre-limit", "45mm"}), "--mitre-limit");
  EXPECT_EQ(fault({"pareto", "run", "table", "--minimize", "mass"}), "--minimize");
  EXPECT_EQ(fault({"pareto", "run", "table", "--fix", "width=0.8", "--range", "length=1:9"}, true),
            "--range length");
  EXPECT_EQ(fault({"pareto", "run", "table", "--evaluations", "3"}, true), "--evaluations");
  const std::string file = (folder_ / "specification.json").string();
  ASSERT_TRUE(WriteFile(file, R"({"subject": "templates/table", "seed": 1, "evaluations": 20,
                                  "bounds": [{"parameter": "girth"}]})")
                  .ok());
  EXPECT_EQ(fault({"pareto", "run", file}, true), file + ": bounds[0].parameter");
}

// Cases and meshes in files: what is wrong is told of the file and its place.
TEST_F(HouseTest, FaultsOfACaseNameItsFile) {
  const std::string file = (folder_ / "case.json").string();
  const std::string mesh = (folder_ / "block.inp").string();
  ASSERT_TRUE(WriteFile(mesh,
                        "*NODE\n1, 0, 0, 0\n2, 9, 0, 0\n3, 0, 9, 0\n4, 0, 0, 9\n"
                        "*ELEMENT, TYPE=C3D4, ELSET=body\n1, 1, 2, 3, 4\n"
                        "*NSET, NSET=base\n1, 2, 3\n*NSET, NSET=tip\n4\n")
                  .ok());
  const auto ask = [&](const std::string& end, int code) {
    EXPECT_TRUE(WriteFile(file, R"({"length_unit": "mm", "materials": [{"material":
        "materials/steel"}], "supports": [{"groups": ["base"], "fixed": true}], "load_cases":
        [{"name": "push", "nodal_forces": [{"groups": ["tip"], "force": {"z": -1}}]}])" +
                                    end + "}")
                    .ok());
    return Ask({"analyze", file, "--mesh", mesh}, code);
  };
  const Json analysis = ask("", 0);
  EXPECT_NEAR(analysis["cases"][0]["total_reaction"]["z"].get<double>(), 1, 1e-9);
  EXPECT_EQ(ask(R"(, "colour": "red")", 1)["error"]["field"], file + ": colour");
  EXPECT_EQ(ask(R"(, "probes": [{"name": "a", "size": 1}])", 1)["error"]["field"],
            file + ": probes[0].size");
  EXPECT_EQ(ask(R"(, "modes": -1)", 1)["error"]["field"], file + ": modes");
  EXPECT_EQ(ask(R"(, "probes": [{"name": "a", "groups": ["Base"]}])", 1)["error"]["field"],
            file + ": probes[0].groups[0]");
  EXPECT_EQ(Ask({"analyze", file}, 1)["error"]["field"], "--mesh");
  ASSERT_TRUE(WriteFile(mesh, "*NODE\n1, 0, 0\n*INCLUDE, INPUT=x\n").ok());
  const Json error = ask("", 1)["error"];
  EXPECT_EQ(error["field"], mesh);
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("line 3: *INCLUDE"));
}

TEST_F(HouseTest, SecondLauncherIsRefused) {
  const CommandResult second =
      Mortise({"up", "--insecure-development", "--any-ports", "--state", State()});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.error, HasSubstr("another launcher runs on"));
}

TEST(Up, RefusesAnUnwritableStateFolder) {
  const auto folder = std::filesystem::temp_directory_path() / ("mortise-file-" + NewIdentifier());
  ASSERT_TRUE(WriteFile(folder, "a file where a folder should be").ok());
  const CommandResult result =
      Mortise({"up", "--insecure-development", "--any-ports", "--state", folder.string()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.error, HasSubstr(folder.string()));
  std::filesystem::remove(folder);
}

TEST(CommandLine, EveryCommandHasHelpAndMistakesAreExplained) {
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{},
                                             {"up"},
                                             {"down"},
                                             {"status"},
                                             {"demo"},
                                             {"catalog"},
                                             {"catalog", "import"},
                                             {"catalog", "list"},
                                             {"catalog", "show"},
                                             {"catalog", "evaluate"},
                                             {"analyze"},
                                             {"pareto"},
                                             {"pareto", "run"},
                                             {"pareto", "show"},
                                             {"pareto", "pick"},
                                             {"pareto", "benchmark"},
                                             {"plan"},
                                             {"fab"},
                                             {"fab", "release"},
                                             {"fab", "watch"},
                                             {"fab", "show"},
                                             {"fab", "hold"},
                                             {"fab", "resume"},
                                             {"events"},
                                             {"call"},
                                             {"completion"},
                                             {"keys"},
                                             {"health"}}) {
    std::vector<std::string> arguments = command;
    arguments.push_back("--help");
    const CommandResult result = Mortise(arguments);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.out, HasSubstr("Usage:"));
    EXPECT_THAT(result.out, HasSubstr("Example: "));
  }
  EXPECT_EQ(Mortise({"nonsense"}).exit_code, 2);
  EXPECT_EQ(Mortise({"analyze"}).exit_code, 2);
}

TEST(CommandLine, WrongCommandLinesAreOneDocumentWithJson) {
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
           {"--json"},
           {"nonsense", "--json"},
           {"--json", "catalog", "list", "--bogus"},
           {"--json", "events", "--since", "abc"},
           {"--json", "up", "--workers", "-4", "--dry-run"},
           {"--json", "up", "--time-scale", "nan", "--dry-run"},
           {"--json", "demo", "--evaluations", "-3"},
           {"--json", "pareto", "run", "table", "--evaluations", "0"}}) {
    const CommandResult result = Mortise(wrong);
    EXPECT_EQ(result.exit_code, 2) << wrong.back();
    const auto document = nlohmann::json::parse(result.out, nullptr, false);
    ASSERT_TRUE(document.is_object()) << result.out;
    EXPECT_EQ(document["error"]["code"], "INVALID_ARGUMENT");
    EXPECT_EQ(document["error"]["field"], "arguments");
  }
  const CommandResult help = Mortise({"--json", "analyze", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(nlohmann::json::parse(help.out)["text"].get<std::string>(), HasSubstr("Example"));
}

TEST(CommandLine, WithoutAHouseSaysHowToStartOne) {
  const CommandResult result = Mortise({"--house", "/nonexistent", "catalog", "list"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.error, HasSubstr("mortise up"));
}

// Every point holds what its parameters give by the published formula.
TEST(CommandLine, BenchmarksPrintEveryPointThatNoneDominates) {
  const std::vector<std::string> run = {"pareto", "benchmark", "zdt1",   "--dims",        "6",
                                        "--seed", "3",         "--json", "--evaluations", "150"};
  const CommandResult result = Mortise(run);
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json document = Json::parse(result.out);
  EXPECT_EQ(document["problem"], "ZDT1");
  EXPECT_EQ(document["evaluations"], 150);
  EXPECT_NEAR(document["share"].get<double>(),
              document["hypervolume"].get<double>() / document["true_hypervolume"].get<double>(),
              1e-12);
  ASSERT_GE(document["points"].size(), 10u);
  for (const Json& point : document["points"]) {
    const auto x = point["parameters"].get<std::vector<double>>();
    ASSERT_EQ(x.size(), 6u);
    double g = 1;
    for (std::size_t i = 1; i < x.size(); ++i) g += 9 * x[i] / 5;
    EXPECT_DOUBLE_EQ(point["metrics"][0].get<double>(), x[0]);
    EXPECT_NEAR(point["metrics"][1].get<double>(), g * (1 - std::sqrt(x[0] / g)), 1e-12 * g);
  }
  EXPECT_EQ(Json::parse(Mortise(run).out)["points"], document["points"]) << "the same seed";
}

TEST(CommandLine, BenchmarksOfManyMetricsAreWrittenAsFiles) {
  const auto folder = std::filesystem::temp_directory_path() / ("mortise-" + NewIdentifier());
  const CommandResult result = Mortise({"--json", "pareto", "benchmark", "DTLZ2", "--metrics", "4",
                                        "--evaluations", "150", "--out", folder.string()});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json document = Json::parse(result.out);
  EXPECT_EQ(document["dims"], 13);
  EXPECT_EQ(document["points"][0]["metrics"].size(), 4u);
  EXPECT_EQ(ReadFile(folder / "front.csv")->rfind("x1,x2,", 0), 0u);
  EXPECT_NE(ReadFile(folder / "front.svg")->find("best f3"), std::string::npos);
  EXPECT_EQ(ReadFile(folder / "front.png")->substr(1, 3), "PNG");
  std::filesystem::remove_all(folder);
}

TEST(CommandLine, BenchmarksJudgePiecesAndPoints) {
  const CommandResult affine = Mortise({"pareto", "benchmark", "ZDT1", "--dims", "30",
                                        "--evaluations", "60", "--gradients", "--dense", "--json"});
  ASSERT_EQ(affine.exit_code, 0) << affine.error;
  const Json dense = Json::parse(affine.out);
  EXPECT_EQ(dense["evaluations"], 60);
  EXPECT_GT(dense["dense_evaluations"], 100);
  EXPECT_GT(dense["dense_share"], dense["share"]);
  EXPECT_GT(dense["dense_share"], 0.999);
  EXPECT_FALSE(dense.contains("front_error_worst"));
  const CommandResult waves = Mortise(
      {"pareto", "benchmark", "Fourier", "--evaluations", "600", "--front-error", "--json"});
  ASSERT_EQ(waves.exit_code, 0) << waves.error;
  const Json error = Json::parse(waves.out);
  const auto decades = error["front_error_decades"].get<std::vector<int>>();
  const auto points = error["front_error_points"].get<double>();
  EXPECT_EQ(std::accumulate(decades.begin(), decades.end(), 0), points);
  EXPECT_NEAR(error["front_error_share_below_1e_5"],
              std::accumulate(decades.begin(), decades.begin() + 6, 0) / points, 1e-12);
  EXPECT_GT(error["front_error_worst"], 0);
  EXPECT_FALSE(error.contains("dense_share"));
}

TEST(CommandLine, BenchmarksSayWhatConstraintsAre) {
  const CommandResult result =
      Mortise({"pareto", "benchmark", "BNH", "--evaluations", "100", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json document = Json::parse(result.out);
  ASSERT_GE(document["points"].size(), 5u);
  for (const Json& point : document["points"]) {
    const auto x = point["parameters"].get<std::vector<double>>();
    const auto g = point["constraints"].get<std::vector<double>>();
    ASSERT_EQ(g.size(), 2u);
    EXPECT_NEAR(g[0], (x[0] - 5) * (x[0] - 5) + x[1] * x[1] - 25, 1e-9);
    EXPECT_NEAR(g[1], 7.7 - (x[0] - 8) * (x[0] - 8) - (x[1] + 3) * (x[1] + 3), 1e-9);
    EXPECT_LE(std::max(g[0], g[1]), 0);
  }
}

TEST(CommandLine, BenchmarksSayWhatIsWrong) {
  const auto fault = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"--json", "pareto", "benchmark"});
    const CommandResult result = Mortise(arguments);
    EXPECT_EQ(result.exit_code, 1);
    return Json::parse(result.out)["error"]["field"].get<std::string>();
  };
  EXPECT_EQ(fault({"ZDT5"}), "name");
  EXPECT_EQ(fault({"ZDT1", "--dims", "1"}), "--dims");
  EXPECT_EQ(fault({"ZDT1", "--dims", "1000"}), "--dims");
  EXPECT_EQ(fault({"ZDT1", "--evaluations", "-5"}), "--evaluations");
  EXPECT_EQ(fault({"ZDT1", "--window", "0"}), "--window");
  EXPECT_EQ(fault({"Kursawe", "--rotated"}), "--rotated");
  EXPECT_EQ(fault({"DTLZ2", "--metrics", "7"}), "--metrics");
  EXPECT_EQ(fault({"BNH", "--front-error"}), "--front-error");
}

TEST(Completion, IsAScriptThatBashAccepts) {
  const CommandResult result = Mortise({"completion", "bash"});
  ASSERT_EQ(result.exit_code, 0);
  const auto script = std::filesystem::temp_directory_path() / ("mortise-" + NewIdentifier());
  ASSERT_TRUE(WriteFile(script, result.out).ok());
  EXPECT_EQ(std::system(("bash -n " + script.string()).c_str()), 0);
  // What bash offers after these words.
  const auto offered = [&](const std::string& words) {
    return Shell("source '" + script.string() + "'; COMP_WORDS=(mortise " + words +
                     "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _mortise; echo \"${COMPREPLY[*]}\"",
                 script.parent_path())
        .out;
  };
  EXPECT_EQ(offered("cat"), "catalog\n");
  EXPECT_EQ(offered("--house x catalog ev"), "evaluate\n");
  EXPECT_EQ(offered("catalog list --ki"), "--kind\n");
  EXPECT_EQ(offered("fab hold --js"), "--json\n");
  std::filesystem::remove(script);
}

TEST(Completion, KnowsOtherShells) {
  for (const char* shell : {"zsh", "fish"}) {
    const CommandResult result = Mortise({"completion", shell});
    ASSERT_EQ(result.exit_code, 0) << shell;
    EXPECT_THAT(result.out, HasSubstr("'catalog list'")) << shell;
    EXPECT_THAT(result.out, HasSubstr("Only items of this kind, such as bolt")) << shell;
  }
  EXPECT_EQ(Mortise({"completion", "csh"}).exit_code, 2);
}

}  // namespace
}  // namespace mortise::e2e
