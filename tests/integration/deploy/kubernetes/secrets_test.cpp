// What pods of deploy/kubernetes read of secrets and configuration against what the commands of
// docs/workers.md make, which are run on a kubectl that only notes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "cli/launcher/house.h"
#include "common/base/files.h"
#include "tests/e2e/command.h"
#include "tests/e2e/manual/manual.h"
#include "tests/integration/deploy/kubernetes/manifests.h"
#include "tests/support/temporary_folder.h"

namespace mortise::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Names = std::set<std::string>;

class SecretsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path& folder = folder_.path();
    const std::filesystem::path tests = SourceFolder() / "tests/integration/deploy/kubernetes";
    std::filesystem::create_symlink(SourceFolder() / "deploy", folder / "deploy");
    // Files that stand for those of a site.
    for (const char* file : {"certificate.pem", "certificate.key", "authority.pem", "tokens.pem"}) {
      ASSERT_TRUE(WriteFile(folder / file, "something").ok());
    }
    std::string commands;
    for (const e2e::ManualBlock& block : e2e::ReadManual("docs/workers.md")) {
      if (block.mark == "kubernetes") commands += block.text;
    }
    const e2e::CommandResult result =
        e2e::Shell("export PATH='" + tests.string() + "':\"$PATH\"\n" + commands, folder);
    ASSERT_EQ(result.exit_code, 0) << result.out << result.error;
    std::istringstream lines(ReadFile(folder / "made").value_or(""));
    for (std::string kind, name, key; lines >> kind >> name;) {
      if (kind == "apply") {
        applied_ = name;
      } else if (lines >> key) {
        made_[absl::StrCat(kind, "/", name)].insert(key);
      }
    }
  }

  // Keeps that something is used; of a secret, with which key.
  void UseSecret(const Json& reference) {
    const std::string name = "secret/" + reference["name"].get<std::string>();
    used_.insert(name);
    EXPECT_EQ(made_[name].count(reference["key"]), 1u) << reference;
  }

  void UseVolume(const Json& source) {
    if (source.contains("configMap")) {
      used_.insert("configmap/" + source["configMap"]["name"].get<std::string>());
    } else if (source.contains("secret")) {
      const Json& secret = source["secret"];
      used_.insert("secret/" + secret.value("secretName", secret.value("name", "")));
    }
  }

  const Manifests manifests_;
  TemporaryFolder folder_;
  std::map<std::string, Names> made_;  // "secret/mortise-tls": keys
  Names used_;
  std::string applied_;
};

TEST_F(SecretsTest, AreThoseThatTheManualMakes) {
  EXPECT_EQ(applied_, "deploy/kubernetes");
  for (const Workload& workload : manifests_.workloads()) {
    for (const Json& variable : workload.container.value("env", Json::array())) {
      const Json from = variable.value("valueFrom", Json::object());
      if (from.contains("secretKeyRef")) UseSecret(from["secretKeyRef"]);
    }
    for (const Json& volume : workload.pod.value("volumes", Json::array())) {
      UseVolume(volume);
      const Json projected = volume.value("projected", Json::object());
      for (const Json& source : projected.value("sources", Json::array())) UseVolume(source);
    }
  }
  for (const Json& authentication : manifests_.OfKind("TriggerAuthentication")) {
    for (const Json& reference : authentication["spec"]["secretTargetRef"]) UseSecret(reference);
  }
  Names made;
  for (const auto& [name, keys] : made_) made.insert(name);
  EXPECT_EQ(used_, made);
}

TEST_F(SecretsTest, HaveTheFilesThatProcessesRead) {
  const Json environment = manifests_.workload("catalog").environment;
  Names read;
  for (const char* variable :
       {"MORTISE_TLS_CERTIFICATE", "MORTISE_TLS_KEY", "MORTISE_TLS_AUTHORITY"}) {
    read.insert(std::filesystem::path(environment[variable].get<std::string>()).filename());
  }
  EXPECT_EQ(made_["secret/mortise-tls"], read);
  ASSERT_EQ(made_["configmap/mortise-token-keys"].size(), 1u);
  EXPECT_THAT(
      manifests_.workload("gateway").Values("--jwt-keys"),
      ElementsAre("/run/mortise/token-keys/" + *made_["configmap/mortise-token-keys"].begin()));
}

TEST_F(SecretsTest, EachProcessHasItsOwnKeysAndAllHaveThePublicOnes) {
  std::vector<std::string> processes = cli::HouseServices();
  processes.push_back("gateway");
  Names published;
  for (const std::string& process : processes) {
    published.insert({process + ".pub", process + ".curve-public"});
    EXPECT_EQ(made_["secret/mortise-" + process + "-keys"],
              (Names{process + ".key", process + ".curve-secret"}));
    for (const std::string& other : processes) {
      EXPECT_EQ(manifests_.workload(process).pod.dump().find("mortise-" + other + "-keys") !=
                    std::string::npos,
                other == process);
    }
  }
  EXPECT_EQ(made_["configmap/mortise-public-keys"], published);
}

}  // namespace
}  // namespace mortise::testing
