// A house with TLS and tokens, made and used as docs/gateway.md says: who gets in, who may do what,
// and what those are told who may not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "cli/launcher/state_folder.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "tests/e2e/command.h"
#include "tests/e2e/manual/manual.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

// The blocks of the manual's section: what makes keys and tokens, the start, what is done then.
struct Manual {
  std::string preparation;
  std::string start;
  std::vector<std::pair<std::string, std::string>> use;  // place and command
};

Manual ReadSection() {
  Manual manual;
  for (const ManualBlock& block : ReadManual("docs/gateway.md")) {
    if (block.mark != "secure-house") continue;
    if (block.text.rfind("mortise up", 0) == 0) {
      manual.start = block.commands.front().text;
    } else if (manual.start.empty()) {
      manual.preparation += block.text;
    } else {
      for (const ManualCommand& command : block.commands) {
        manual.use.emplace_back(block.Place(command), command.text);
      }
    }
  }
  return manual;
}

class SecureHouse : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::temp_directory_path() / ("mortise-secure-" + NewIdentifier());
    std::filesystem::create_directories(folder_);
    const Manual manual = ReadSection();
    // Beside the manual's, callers whom it does not need.
    prepared_ = Shell(manual.preparation +
                          "token vera viewer 28800 > vera.token\n"
                          "token alma admin 28800 > alma.token\n"
                          "token late admin -60 > late.token\n"
                          "openssl genpkey -algorithm ed25519 -out other.key\n"
                          "cp tokens.key kept.key && cp other.key tokens.key\n"
                          "token mallory admin 28800 > mallory.token\n"
                          "mv kept.key tokens.key\n",
                      folder_);
    if (prepared_.exit_code != 0) return;
    house_ = BackgroundCommand::InShell(manual.start + " --any-ports --workers 1 --time-scale 500",
                                        folder_, Log());
    serving_ = AwaitHouse(State());
  }
  static void TearDownTestSuite() {
    house_.reset();
    std::filesystem::remove_all(folder_);
  }

  void SetUp() override {
    ASSERT_EQ(prepared_.exit_code, 0) << prepared_.error;
    ASSERT_TRUE(serving_) << ReadFile(Log()).value_or("");
  }

  static std::string State() { return (folder_ / ".mortise").string(); }
  static std::string Log() { return (folder_ / "up.log").string(); }
  static std::string File(const std::string& name) { return (folder_ / name).string(); }

  // A command's document; `token` is the holder's name, empty for none.
  static Json Ask(const std::string& token, std::vector<std::string> arguments,
                  int expected_code = 0) {
    std::vector<std::string> command = {"--json", "--house", State()};
    if (!token.empty()) command.insert(command.end(), {"--token-file", File(token + ".token")});
    command.insert(command.end(), arguments.begin(), arguments.end());
    const CommandResult result = Mortise(command);
    EXPECT_EQ(result.exit_code, expected_code) << result.out << result.error;
    Json document = Json::parse(result.out, nullptr, false);
    EXPECT_FALSE(document.is_discarded()) << result.out;
    return document;
  }

  // The code of the error that a command must end with.
  static std::string Refusal(const std::string& token, std::vector<std::string> arguments) {
    return Ask(token, std::move(arguments), 1)["error"]["code"];
  }

  static std::string NewPlan() {
    return Ask("ada", {"plan", "table", "--set", "length=1400mm"})["name"];
  }

  static std::filesystem::path folder_;
  static CommandResult prepared_;
  static std::unique_ptr<BackgroundCommand> house_;
  static bool serving_;
};

std::filesystem::path SecureHouse::folder_;
CommandResult SecureHouse::prepared_;
std::unique_ptr<BackgroundCommand> SecureHouse::house_;
bool SecureHouse::serving_ = false;

TEST_F(SecureHouse, IsUsedAsTheManualSays) {
  StandIns stand_ins(State());
  const Manual manual = ReadSection();
  ASSERT_GE(manual.use.size(), 5u);
  for (const auto& [place, command] : manual.use) {
    const CommandResult result = Shell(stand_ins.Replace(command), folder_);
    EXPECT_EQ(result.exit_code, 0) << place << ": " << command << "\n"
                                   << result.out << result.error;
    stand_ins.Learn(result.out);
  }
}

TEST_F(SecureHouse, StatusSaysThatItsDoorsAreClosed) {
  const CommandResult status = Mortise({"status", "--state", State()});
  EXPECT_EQ(status.exit_code, 0) << status.error;
  EXPECT_THAT(status.out, HasSubstr("HTTP https://"));
}

TEST_F(SecureHouse, NobodyGetsInWithoutAToken) {
  EXPECT_EQ(Refusal("", {"catalog", "list"}), "UNAUTHENTICATED");
  EXPECT_EQ(Refusal("", {"plan", "table"}), "UNAUTHENTICATED");
}

TEST_F(SecureHouse, TokensThatDoNotHoldAreRefusedWithTheReason) {
  const Json expired = Ask("late", {"catalog", "list"}, 1)["error"];
  EXPECT_EQ(expired["code"], "UNAUTHENTICATED");
  EXPECT_THAT(expired["message"].get<std::string>(), HasSubstr("expired"));
  const Json forged = Ask("mallory", {"catalog", "list"}, 1)["error"];
  EXPECT_EQ(forged["code"], "UNAUTHENTICATED");
  EXPECT_THAT(forged["message"].get<std::string>(), HasSubstr("signature"));
}

TEST_F(SecureHouse, ViewerLooksAndTouchesNothing) {
  const std::size_t items = Ask("vera", {"catalog", "list", "items"}).size();
  EXPECT_GE(items, 5u);
  ASSERT_TRUE(WriteFile(folder_ / "peg.textproto", R"(
items {
  name: "items/dowel-7x35"
  title: "Beech dowel peg, 7 x 35 mm"
  kind: DOWEL
  material: "materials/beech"
  dimensions { axis: X size: 0.035 }
  dimensions { axis: Y size: 0.007 }
  dimensions { axis: Z size: 0.007 }
  price { currency: "EUR" amount: 0.05 }
  price_basis: PER_PIECE
  price_date: "2026-01-15"
  supplier: "Example Timber Merchant"
}
)")
                  .ok());
  const std::string file = File("peg.textproto");
  const Json refused = Ask("vera", {"catalog", "import", file}, 1)["error"];
  EXPECT_EQ(refused["code"], "PERMISSION_DENIED");
  EXPECT_THAT(refused["message"].get<std::string>(),
              testing::StartsWith("mortise.v1.CatalogService/ImportCatalog needs the role"));
  EXPECT_EQ(Refusal("vera", {"plan", "table"}), "PERMISSION_DENIED");
  EXPECT_EQ(Refusal("vera", {"fab", "release", NewPlan()}), "PERMISSION_DENIED");
  EXPECT_EQ(Ask("vera", {"catalog", "list", "items"}).size(), items);
}

TEST_F(SecureHouse, DesignerChecksAndPlansButDoesNotCut) {
  const Json analysis =
      Ask("ada", {"analyze", "table", "--set", "length=1500mm", "--element-size", "100mm"});
  EXPECT_LT(analysis["total_load"]["z"].get<double>(), 0);
  EXPECT_EQ(Refusal("ada", {"fab", "release", NewPlan()}), "PERMISSION_DENIED");
}

// Who may not release a work order, nor hold it, may not stop it by way of its operation.
TEST_F(SecureHouse, DesignerDoesNotStopWhatOnlyAnOperatorStarts) {
  const std::string cutting =
      Ask("otto", {"fab", "release", NewPlan(), "--detach"})["name"].get<std::string>();
  const Json refused = Ask("ada", {"operations", "cancel", cutting}, 1)["error"];
  EXPECT_EQ(refused["code"], "PERMISSION_DENIED");
  EXPECT_EQ(refused["reason"], "ROLE_REQUIRED");
  EXPECT_EQ(refused["field"], "mortise.v1.FabPlannerService/ReleaseWorkOrder");
  EXPECT_FALSE(Ask("vera", {"operations", "show", cutting})["cancel_requested"].get<bool>());
  EXPECT_EQ(
      Refusal("ada", {"fab", "hold", Ask("vera", {"operations", "show", cutting})["subject"]}),
      "PERMISSION_DENIED");
  Ask("otto", {"operations", "cancel", cutting});
  const std::string planning = Ask("ada", {"plan", "table", "--detach"})["name"].get<std::string>();
  EXPECT_EQ(Refusal("vera", {"operations", "cancel", planning}), "PERMISSION_DENIED");
  Ask("ada", {"operations", "cancel", planning});
}

TEST_F(SecureHouse, OperatorCutsToTheEndAndOnlyAdminsReadTheAudit) {
  const std::string plan = NewPlan();
  const Json order = Ask("otto", {"fab", "release", plan});
  EXPECT_EQ(order["state"], "COMPLETED");
  EXPECT_GT(order["cuts_total"].get<int>(), 0);
  EXPECT_EQ(order["cuts_done"], order["cuts_total"]);

  const std::vector<std::string> question = {"call", "mortise.v1.AuditService/ListAuditRecords",
                                             R"({"service": "fabplanner", "page_size": 1000})"};
  EXPECT_EQ(Refusal("otto", question), "PERMISSION_DENIED");
  std::map<std::string, std::set<std::string>> methods;  // by subject
  const Json audit = Ask("alma", question);
  for (const Json& record : audit["records"]) {
    methods[record.value("subject", "")].insert(record.value("method", ""));
  }
  EXPECT_THAT(methods["users/ada"], testing::Contains("mortise.v1.FabPlannerService/CreatePlan"));
  EXPECT_THAT(methods["users/otto"],
              testing::Contains("mortise.v1.FabPlannerService/ReleaseWorkOrder"))
      << audit;
}

TEST_F(SecureHouse, ClientsThatSpeakOtherwiseAreToldSo) {
  const std::string address = cli::ReadRunningHouse(State())->gateway_grpc;
  const auto refusal = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"--json", "--gateway", address, "--token-file",
                                     File("vera.token"), "catalog", "list"});
    const CommandResult result = Mortise(options);
    EXPECT_EQ(result.exit_code, 1) << result.out;
    return Json::parse(result.out, nullptr, false)["error"];
  };
  const Json plain = refusal({});
  EXPECT_EQ(plain["code"], "UNAVAILABLE");
  EXPECT_THAT(plain["message"].get<std::string>(), HasSubstr("--authority"));

  ASSERT_EQ(Shell("openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 1 "
                  "-subj /CN=other -keyout stranger.key -out stranger.pem",
                  folder_)
                .exit_code,
            0);
  const Json untrusted = refusal({"--authority", File("stranger.pem")});
  EXPECT_EQ(untrusted["code"], "UNAVAILABLE");
  EXPECT_THAT(untrusted["message"].get<std::string>(), HasSubstr("not from the authority"));
  // Neither has harmed it.
  Ask("vera", {"catalog", "list"});
}

TEST_F(SecureHouse, HttpDoorAsksForTlsAndTokensToo) {
  const std::string address = cli::ReadRunningHouse(State())->gateway_http;
  EXPECT_NE(Shell("curl --silent http://" + address + "/healthz", folder_).exit_code, 0);
  const std::string code =
      "curl --silent --cacert house.pem --output answer --write-out "
      "'%{http_code}' ";
  EXPECT_EQ(Shell(code + "https://" + address + "/healthz", folder_).out, "200");
  const std::string call = "-H 'Content-Type: application/json' -d '{}' https://" + address +
                           "/mortise.v1.CatalogService/ListItems";
  EXPECT_EQ(Shell(code + call, folder_).out, "401");
  EXPECT_EQ(Shell(code + "-H \"Authorization: Bearer $(cat vera.token)\" " + call, folder_).out,
            "200");
}

TEST_F(SecureHouse, UpSaysWhatIsMissing) {
  const auto refusal = [](std::vector<std::string> options) {
    options.insert(options.begin(), {"up", "--dry-run", "--any-ports", "--state", File("new")});
    const CommandResult result = Mortise(options);
    EXPECT_EQ(result.exit_code, 1) << result.out;
    return result.error;
  };
  const std::vector<std::string> closed = {"--tls-certificate", File("house.pem"),
                                           "--tls-key",         File("house.key"),
                                           "--jwt-keys",        File("tokens.pem")};
  const auto with = [&closed](std::vector<std::string> more) {
    more.insert(more.end(), closed.begin(), closed.end());
    return more;
  };
  EXPECT_THAT(refusal({}), HasSubstr("--jwt-keys"));
  EXPECT_THAT(refusal(with({"--virtual-cell"})), HasSubstr("--bridge-token-file"));
  EXPECT_THAT(refusal(with({"--insecure-development"})), HasSubstr("--insecure-development"));
  EXPECT_THAT(refusal(with({"--tls-authority", File("nothing.pem")})),
              HasSubstr("there is no file " + File("nothing.pem")));
}

}  // namespace
}  // namespace mortise::e2e
