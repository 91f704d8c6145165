// The pods of deploy/kubernetes as processes on this machine: the same programs with the same
// arguments and variables, where other addresses and folders stand for those of a cluster.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "tests/e2e/command.h"
#include "tests/e2e/manual/manual.h"
#include "tests/integration/deploy/kubernetes/manifests.h"
#include "tests/support/child_process.h"
#include "tests/support/private_postgresql.h"
#include "tests/support/reserved_port.h"
#include "tests/support/temporary_folder.h"

namespace mortise::testing {
namespace {

class PodsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto store = PrivatePostgresql::Start();
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
    // Certificates and tokens as docs/gateway.md makes them, keys as docs/workers.md.
    std::string preparation;
    for (const e2e::ManualBlock& block : e2e::ReadManual("docs/gateway.md")) {
      if (absl::StartsWith(block.text, "mortise up")) break;
      if (block.mark == "secure-house") preparation += block.text;
    }
    const e2e::CommandResult prepared =
        Run(preparation +
            "mortise keys keys\n"
            "mkdir tls && cp house.pem tls/tls.crt && cp house.key tls/tls.key && cp house.pem "
            "tls/ca.crt\n"
            "mkdir token-keys && cp tokens.pem token-keys\n");
    ASSERT_EQ(prepared.exit_code, 0) << prepared.error;
    for (const Workload& workload : manifests_.workloads()) {
      for (const auto& [name, port] : workload.ports.items()) {
        Stand(absl::StrCat("0.0.0.0:", port.get<int>()), workload.name);
      }
    }
  }

  // Runs shell where the files are.
  e2e::CommandResult Run(const std::string& script) const {
    return e2e::Shell(script, folder_.path());
  }

  // Keeps what a port of a pod is here.
  void Stand(const std::string& address, const std::string& pod) {
    const std::string real = ports_.emplace_back(std::make_unique<ReservedPort>())->address();
    listeners_[pod][address] = real;
    services_[absl::StrReplaceAll(address, {{"0.0.0.0", pod}})] = real;
  }

  std::string Address(const std::string& service) const { return services_.at(service); }

  // What an argument or variable of a pod is here.
  std::string Translate(const std::string& pod, const std::string& text) const {
    const std::string folder = folder_.path().string();
    std::map<std::string, std::string> here = services_;
    const auto listeners = listeners_.find(pod);
    if (listeners != listeners_.end()) {
      here.insert(listeners->second.begin(), listeners->second.end());
    }
    here["/run/mortise/keys"] = folder + "/keys-" + pod;
    here["/run/mortise"] = folder;
    here["/var/lib/mortise"] = folder;
    here["/usr/share/mortise/collection"] = (SourceFolder() / "collection").string();
    here["postgresql://mortise@postgres/mortise"] = store_->url();
    return absl::StrReplaceAll(text, here);
  }

  // The volume of keys that the pod projects, and its process.
  void StartPod(const Workload& workload) {
    std::string own;
    for (const Json& volume : workload.pod["volumes"]) {
      if (volume["name"] != "keys") continue;
      for (const Json& source : volume["projected"]["sources"]) {
        if (source.contains("secret")) own = source["secret"]["name"];
      }
    }
    ASSERT_TRUE(absl::StartsWith(own, "mortise-") && absl::EndsWith(own, "-keys")) << own;
    own = own.substr(8, own.size() - 13);
    const std::string keys = "keys-" + workload.name;
    const e2e::CommandResult copied =
        Run("mkdir " + keys + " && cp keys/*.pub keys/*.curve-public keys/" + own + ".key keys/" +
            own + ".curve-secret " + keys);
    ASSERT_EQ(copied.exit_code, 0) << copied.error;
    std::vector<std::string> command = {"/usr/bin/env", "--ignore-environment"};
    for (const auto& [name, value] : workload.environment.items()) {
      if (value == "") continue;  // of the pod itself, or of a secret
      command.push_back(name + "=" + Translate(workload.name, value));
    }
    command.push_back(BuiltProgram(workload.container["command"][0].get<std::string>()));
    for (const std::string argument : workload.container["args"]) {
      command.push_back(Translate(workload.name, argument));
    }
    pods_[workload.name] = std::make_unique<ChildProcess>(command);
  }

  // Asks what the startup probe asks, until it is answered.
  void AwaitProbe(const Workload& workload) const {
    const Json& probe = workload.container["startupProbe"]["httpGet"];
    const int port = workload.ports[probe["port"].get<std::string>()];
    const bool tls = probe.value("scheme", "HTTP") == "HTTPS";
    const e2e::CommandResult answer = Run(
        absl::StrCat("curl --silent --show-error --fail --insecure --output /dev/null --retry 60 "
                     "--retry-connrefused --retry-delay 1 ",
                     tls ? "https://" : "http://", Address(absl::StrCat(workload.name, ":", port)),
                     probe["path"].get<std::string>()));
    EXPECT_EQ(answer.exit_code, 0) << workload.name << ": " << answer.error;
  }

  const Manifests manifests_;
  const TemporaryFolder folder_;
  std::unique_ptr<PrivatePostgresql> store_;
  std::vector<std::unique_ptr<ReservedPort>> ports_;
  std::map<std::string, std::string> services_;                          // "catalog:7701"
  std::map<std::string, std::map<std::string, std::string>> listeners_;  // "0.0.0.0:7701", by pod
  std::map<std::string, std::unique_ptr<ChildProcess>> pods_;
};

TEST_F(PodsTest, WorkTogetherAndEndWell) {
  for (const Workload& workload : manifests_.workloads()) {
    if (workload.IsOurs()) StartPod(workload);
  }
  for (const Workload& workload : manifests_.workloads()) {
    if (workload.IsOurs() && workload.container.contains("startupProbe")) AwaitProbe(workload);
  }
  const e2e::CommandResult analysis =
      Run("mortise --json --gateway " + Address("gateway:7700") +
          " --authority house.pem --token-file ada.token analyze table --element-size 200mm");
  ASSERT_EQ(analysis.exit_code, 0) << analysis.out << analysis.error;
  const Json document = Json::parse(analysis.out, nullptr, false);
  EXPECT_LT(document["total_load"]["z"].get<double>(), 0);
  for (const char* pod : {"simulator-worker", "retrieval-worker", "gateway", "pareto", "fabplanner",
                          "retrieval", "interpolator", "composer", "simulator", "catalog"}) {
    EXPECT_EQ(pods_.at(pod)->End(SIGTERM), 0) << pod;
  }
}

}  // namespace
}  // namespace mortise::testing
