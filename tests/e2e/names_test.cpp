// What somebody is told who names what there is not, gives a file to the wrong command, or analyses
// what nobody has said how to hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/base/files.h"
#include "tests/e2e/command.h"
#include "tests/e2e/running_house.h"
#include "tests/support/temporary_folder.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

class NamesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<RunningHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }
  void SetUp() override { ASSERT_TRUE(house_->Serving()) << house_->Log(); }

  // Runs a command on this house with --json; the document that it printed.
  static Json Ask(std::vector<std::string> arguments, int expected_code = 0) {
    arguments.insert(arguments.begin(), {"--json", "--gateway", house_->GrpcAddress()});
    const CommandResult result = Mortise(arguments);
    EXPECT_EQ(result.exit_code, expected_code) << result.out << result.error;
    Json document = Json::parse(result.out, nullptr, false);
    EXPECT_FALSE(document.is_discarded()) << result.out;
    return document;
  }

  static std::unique_ptr<RunningHouse> house_;
  const mortise::testing::TemporaryFolder folder_;
};

std::unique_ptr<RunningHouse> NamesTest::house_;

// It says nothing of how it is held and loaded.
constexpr char kPlainBoard[] =
    "# proto-file: mortise/v1/template.proto\n"
    "# proto-message: mortise.v1.Template\n"
    "name: 'templates/plain-board' title: 'Plain board' "
    "parameters { name: 'length' unit: 'm' minimum: 0.4 maximum: 0.8 default_value: 0.5 } "
    "parts { name: 'board' item: 'items/spruce-planed-2400' length_axis: X thickness_axis: Z "
    "box { x { from: '0' to: 'length' } y { from: '0' to: '0.2' } z { from: '0' to: '0.04' } } }";

// What the template lacks is told, and an analysis can bring it.
TEST_F(NamesTest, AnAnalysisCanBringSupportsAndLoads) {
  const std::string file = (folder_.path() / "board.textproto").string();
  ASSERT_TRUE(WriteFile(file, kPlainBoard).ok());
  Ask({"catalog", "import", file});
  const std::vector<std::string> list = {"catalog", "list", "templates", "--text", "plain board"};
  const Json listed = Ask(list);
  ASSERT_EQ(listed.size(), 1u);
  EXPECT_EQ(listed[0]["analysis_lacks"], Json::array({"supports", "loads"}));
  const CommandResult table =
      Mortise({"--gateway", house_->GrpcAddress(), "catalog", "list", "templates"});
  EXPECT_THAT(table.out, HasSubstr("lacks supports and loads to be analysed"));
  EXPECT_THAT(table.out, HasSubstr("can be analysed"));

  const Json refused = Ask({"analyze", "plain-board", "--linear"}, 1);
  EXPECT_THAT(refused["error"]["message"].get<std::string>(), HasSubstr("--support"));
  const Json analysis = Ask({"analyze", "plain-board", "--linear", "--support", "x_min", "--load",
                             "board/x_max=0,0,-4N"});
  EXPECT_NEAR(analysis["total_load"]["z"].get<double>(), -4, 1e-6);
  ASSERT_EQ(analysis["setup"]["boundary_conditions"].size(), 2u);
  EXPECT_EQ(analysis["setup"]["boundary_conditions"][0]["part"], "board");
  const Json wrong = Ask({"analyze", "plain-board", "--support", "x_minn"}, 1);
  EXPECT_EQ(wrong["error"]["field"], "--support x_minn");
  EXPECT_THAT(wrong["error"]["message"].get<std::string>(), HasSubstr("did you mean 'x_min'?"));
}

// Whatever is named, and whoever asks.
TEST_F(NamesTest, NamesThatAreNotThereAreOfferedOthers) {
  const auto told = [](std::vector<std::string> arguments, int code = 1) {
    return Ask(std::move(arguments), code)["error"]["message"].get<std::string>();
  };
  EXPECT_THAT(told({"catalog", "evaluate", "tabel"}), HasSubstr("did you mean 'templates/table'?"));
  EXPECT_THAT(told({"analyze", "tabel"}), HasSubstr("did you mean 'templates/table'?"));
  EXPECT_THAT(told({"plan", "tabel"}), HasSubstr("did you mean 'templates/table'?"));
  EXPECT_THAT(told({"pareto", "describe", "tabel"}), HasSubstr("did you mean 'templates/table'?"));
  EXPECT_THAT(told({"plan", "table", "--set", "lenght=1m"}), HasSubstr("did you mean 'length'?"));
  EXPECT_THAT(told({"catalog", "list", "--item", "dowel-8x53"}), HasSubstr("did you mean 'items/"));
  EXPECT_THAT(told({"call", "catalog.GetTemplat", "{}"}), HasSubstr("GetTemplate"));
  EXPECT_THAT(told({"call", "catalog.GetTemplate", R"({"nam": "templates/table"})"}),
              HasSubstr("did you mean 'name'?"));
  EXPECT_THAT(told({"catlog", "list"}, 2), HasSubstr("did you mean 'catalog'?"));
}

// A mesh is no template, and an assembly no bundle of items.
TEST_F(NamesTest, AFileIsTakenToTheCommandThatTakesIt) {
  const std::string mesh = (folder_.path() / "chair.obj").string();
  ASSERT_TRUE(WriteFile(mesh, "v 0 0 0\n").ok());
  const Json refused = Ask({"analyze", mesh}, 1);
  EXPECT_EQ(refused["error"]["field"], mesh);
  EXPECT_THAT(refused["error"]["message"].get<std::string>(),
              HasSubstr("mortise assembly import " + mesh));
  const Json imported = Ask({"catalog", "import", mesh}, 1);
  EXPECT_THAT(imported["error"]["message"].get<std::string>(), HasSubstr("mortise search " + mesh));
}

TEST_F(NamesTest, StatusHeedsTheGatewayOfTheEnvironment) {
  const std::string gateway = house_->GrpcAddress();
  const std::string begin = "MORTISE_GATEWAY=" + gateway + " mortise status --json";
  const CommandResult there = Shell(begin, folder_.path());
  ASSERT_EQ(there.exit_code, 0) << there.error;
  EXPECT_EQ(Json::parse(there.out)["gateway_grpc"], gateway);
  // A folder that somebody names is meant.
  const CommandResult folder = Shell(begin + " --state nowhere", folder_.path());
  EXPECT_EQ(folder.exit_code, 1);
  EXPECT_THAT(folder.error, HasSubstr("no house runs on nowhere"));
}

TEST_F(NamesTest, ACallThatIsNotWaitedForSaysHow) {
  const Json late = Ask({"call", "operation.ListOperations", "{}", "--seconds", "1e-9"}, 1);
  EXPECT_THAT(late["error"]["message"].get<std::string>(), HasSubstr("--seconds"));
}

}  // namespace
}  // namespace mortise::e2e
