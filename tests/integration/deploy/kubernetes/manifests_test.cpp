// deploy/kubernetes against what it names: the processes of compose.yaml, the flags and ports of
// the programs, the user of the image, the secrets that the manual makes. No cluster is needed.
#include "tests/integration/deploy/kubernetes/manifests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "cli/launcher/house.h"
#include "common/base/files.h"
#include "tests/e2e/command.h"

namespace mortise::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Names = std::set<std::string>;

class ManifestsTest : public ::testing::Test {
 protected:
  static std::string Text(const std::string& file) {
    return ReadFile(SourceFolder() / file).value_or("");
  }

  static Json Compose() { return ReadYaml({SourceFolder() / "compose.yaml"}).at(0); }

  // The port of a Service that stands for a container's, as a number; 0 if there is none.
  int TargetOf(const std::string& service, int port) const {
    const Json found = manifests_.Find("Service", service);
    if (found.is_null()) return 0;
    const Json ports = manifests_.workload(found["spec"]["selector"]["app"]).ports;
    for (const Json& entry : found["spec"]["ports"]) {
      if (entry["port"] == port) return ports.value(entry["targetPort"].get<std::string>(), 0);
    }
    return 0;
  }

  const Manifests manifests_;
};

TEST_F(ManifestsTest, KustomizationHasEveryFile) {
  Names files;
  for (const auto& entry :
       std::filesystem::directory_iterator(SourceFolder() / "deploy" / "kubernetes")) {
    files.insert(entry.path().filename());
  }
  files.erase("kustomization.yaml");
  EXPECT_EQ(manifests_.kustomization()["resources"].get<Names>(), files);
  EXPECT_FALSE(
      manifests_.Find("Namespace", manifests_.kustomization()["namespace"].get<std::string>())
          .is_null());
}

TEST_F(ManifestsTest, HaveTheProcessesAndImagesOfCompose) {
  const Json services = Compose()["services"];
  Names composed, ours;
  for (const auto& [name, service] : services.items()) composed.insert(name);
  for (const Workload& workload : manifests_.workloads()) {
    ours.insert(workload.name);
    EXPECT_EQ(workload.container["image"], services[workload.name]["image"]) << workload.name;
    if (!workload.IsOurs()) continue;
    EXPECT_EQ(workload.container["command"][0], services[workload.name]["command"][0]);
  }
  EXPECT_EQ(ours, composed);
  EXPECT_THAT(Text("CMakeLists.txt"), HasSubstr("project(mortise VERSION 0.1.0"));
  EXPECT_EQ(manifests_.workload("catalog").container["image"], "mortise:0.1.0");
}

TEST_F(ManifestsTest, ProgramsKnowEveryFlagAndVariable) {
  for (const Workload& workload : manifests_.workloads()) {
    if (!workload.IsOurs()) continue;
    const std::string worker = absl::StrContains(workload.stated, "--worker") ? " --worker" : "";
    const e2e::CommandResult help =
        e2e::Shell(workload.container["command"][0].get<std::string>() + worker + " --help", "/");
    ASSERT_EQ(help.exit_code, 0) << help.error;
    for (const std::string argument : workload.container["args"]) {
      const std::string flag = argument.substr(0, argument.find('='));
      EXPECT_THAT(help.out, HasSubstr("  " + flag + " ")) << workload.name;
    }
    for (const auto& [name, value] : workload.environment.items()) {
      if (!absl::StartsWith(name, "MORTISE_")) continue;
      EXPECT_THAT(help.out, HasSubstr("(Env:" + name + ")")) << workload.name;
    }
  }
}

TEST_F(ManifestsTest, PortsAreThoseOfTheHouse) {
  for (const std::string& name : cli::HouseServices()) {
    const int port = cli::UsualPort(name);
    const Workload& service = manifests_.workload(name);
    EXPECT_THAT(service.Values("--listen"), ElementsAre(absl::StrCat("0.0.0.0:", port)));
    EXPECT_EQ(service.ports["grpc"], port) << name;
    EXPECT_EQ(TargetOf(name, port), port) << name;
    EXPECT_THAT(service.Values("--metrics"),
                ElementsAre(absl::StrCat("0.0.0.0:", service.ports["metrics"].get<int>())));
    EXPECT_THAT(manifests_.workload("gateway").Values("--service"),
                Contains(absl::StrCat(name, "=", name, ":", port)));
  }
  const Workload& gateway = manifests_.workload("gateway");
  for (const auto& [listener, flag] :
       std::map<std::string, std::string>{{"gateway", "--grpc"},
                                          {"gateway-http", "--http"},
                                          {"bus-publish", "--bus-publish"},
                                          {"bus-subscribe", "--bus-subscribe"}}) {
    const int port = cli::UsualPort(listener);
    EXPECT_EQ(TargetOf("gateway", port), port) << listener;
    ASSERT_EQ(gateway.Values(flag).size(), 1u);
    EXPECT_THAT(gateway.Values(flag)[0], ::testing::EndsWith(absl::StrCat("0.0.0.0:", port)));
  }
  for (const auto& [caller, service, port] : manifests_.Calls()) {
    EXPECT_NE(TargetOf(service, port), 0) << caller << " calls " << service << ":" << port;
  }
}

TEST_F(ManifestsTest, CallsAreThoseOfCompose) {
  const Json services = Compose()["services"];
  for (const Workload& workload : manifests_.workloads()) {
    for (const char* flag : {"--peer=", "--service="}) {
      Names composed, ours;
      for (const std::string argument : services[workload.name].value("command", Json::array())) {
        if (absl::StartsWith(argument, flag)) composed.insert(argument);
      }
      for (const std::string argument : workload.container.value("args", Json::array())) {
        if (absl::StartsWith(argument, flag)) ours.insert(argument);
      }
      EXPECT_EQ(ours, composed) << workload.name;
    }
  }
}

TEST_F(ManifestsTest, SelectorsSelect) {
  for (const Workload& workload : manifests_.workloads()) {
    EXPECT_EQ(workload.document["spec"]["selector"]["matchLabels"], workload.labels);
    EXPECT_EQ(workload.labels["app"], workload.name);
    if (workload.document["kind"] != "StatefulSet") continue;
    EXPECT_FALSE(manifests_.Find("Service", workload.document["spec"]["serviceName"]).is_null());
  }
  for (const Json& service : manifests_.OfKind("Service")) {
    EXPECT_EQ(manifests_.workload(service["metadata"]["name"]).labels, service["spec"]["selector"]);
  }
}

TEST_F(ManifestsTest, ListenersHaveProbesOnPortsThatAreThere) {
  for (const Workload& workload : manifests_.workloads()) {
    for (const char* kind : {"startupProbe", "readinessProbe"}) {
      // A worker listens nowhere; its service takes its tasks back when it is silent.
      ASSERT_EQ(workload.container.contains(kind), !workload.IsWorker()) << workload.name;
      if (!workload.container.contains(kind)) continue;
      const Json& probe = workload.container[kind];
      if (!probe.contains("httpGet")) continue;
      EXPECT_TRUE(workload.ports.contains(probe["httpGet"]["port"].get<std::string>()));
    }
  }
}

TEST_F(ManifestsTest, PodsAreConfinedAndRunAsTheUserOfTheImage) {
  const std::string dockerfile = Text("deploy/Dockerfile");
  for (const Workload& workload : manifests_.workloads()) {
    const Json& user = workload.pod["securityContext"];
    EXPECT_EQ(user["runAsNonRoot"], true) << workload.name;
    EXPECT_EQ(user["seccompProfile"]["type"], "RuntimeDefault") << workload.name;
    EXPECT_EQ(workload.pod["automountServiceAccountToken"], false) << workload.name;
    EXPECT_EQ(workload.container["securityContext"]["allowPrivilegeEscalation"], false);
    EXPECT_EQ(workload.container["securityContext"]["capabilities"]["drop"], Json({"ALL"}));
    for (const char* part : {"requests", "limits"}) {
      EXPECT_TRUE(workload.container["resources"][part].contains("memory")) << workload.name;
    }
    if (!workload.IsOurs()) continue;
    EXPECT_THAT(dockerfile,
                HasSubstr(absl::StrCat("useradd --uid ", user["runAsUser"].get<int>(), " ")));
  }
}

TEST_F(ManifestsTest, DrainingTakesLessThanKubernetesWaits) {
  for (const Workload& workload : manifests_.workloads()) {
    if (!workload.IsOurs()) continue;
    ASSERT_EQ(workload.Values("--drain-seconds").size(), 1u) << workload.name;
    EXPECT_GT(workload.pod["terminationGracePeriodSeconds"].get<int>(),
              std::atoi(workload.Values("--drain-seconds")[0].c_str()) + 10)
        << workload.name;
  }
}

TEST_F(ManifestsTest, DrainingTakesLessThanComposeWaits) {
  const Json compose = Compose();
  for (const char* name : {"simulator-worker", "retrieval-worker"}) {
    const Json worker = compose["services"][name];
    const std::string waits = worker["stop_grace_period"];
    ASSERT_EQ(waits.back(), 's');
    const std::string command = worker["command"].dump();
    const std::string flag = "--drain-seconds=";
    ASSERT_THAT(command, HasSubstr(flag));
    EXPECT_GT(std::atoi(waits.c_str()),
              std::atoi(command.c_str() + command.find(flag) + flag.size()) + 5);
  }
}

TEST_F(ManifestsTest, MountsAndPathsBelongTogether) {
  for (const Workload& workload : manifests_.workloads()) {
    Names volumes, mounted;
    for (const Json& volume : workload.pod.value("volumes", Json::array())) {
      volumes.insert(volume["name"]);
    }
    for (const Json& claim :
         workload.document["spec"].value("volumeClaimTemplates", Json::array())) {
      volumes.insert(claim["metadata"]["name"]);
    }
    std::vector<std::string> places = {"/usr/share/mortise/collection"};  // of the image
    for (const Json& mount : workload.container["volumeMounts"]) {
      mounted.insert(mount["name"]);
      places.push_back(mount["mountPath"]);
    }
    EXPECT_EQ(mounted, volumes) << workload.name;
    std::vector<std::string> said = absl::StrSplit(workload.stated, ' ');
    for (const auto& [name, value] : workload.environment.items()) said.push_back(value);
    for (const std::string& text : said) {
      const std::size_t begin = text.find("=/") == std::string::npos ? 0 : text.find("=/") + 1;
      const std::string path = text.substr(begin);
      if (!absl::StartsWith(path, "/")) continue;
      const bool reached = std::any_of(places.begin(), places.end(), [&](const std::string& place) {
        return absl::StartsWith(path, place);
      });
      EXPECT_TRUE(reached) << workload.name << ": " << path;
    }
  }
}

}  // namespace
}  // namespace mortise::testing
