#include "tests/integration/deploy/kubernetes/manifests.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "tests/e2e/command.h"

namespace mortise::testing {

std::filesystem::path SourceFolder() {
  const char* folder = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::absolute(folder == nullptr ? "." : folder);
}

std::vector<Json> ReadYaml(const std::vector<std::filesystem::path>& files) {
  std::string command =
      "/usr/bin/python3 -c 'import json, sys, yaml; json.dump([document for file in sys.argv[1:] "
      "for document in yaml.load_all(open(file), yaml.CSafeLoader)], sys.stdout)'";
  for (const std::filesystem::path& file : files) command += " '" + file.string() + "'";
  const e2e::CommandResult read = e2e::Shell(command, "/");
  EXPECT_EQ(read.exit_code, 0) << read.error;
  const Json documents = Json::parse(read.out, nullptr, false);
  EXPECT_TRUE(documents.is_array() && !documents.empty()) << command;
  return documents.is_array() ? documents.get<std::vector<Json>>() : std::vector<Json>();
}

std::vector<std::string> Workload::Values(const std::string& flag) const {
  std::vector<std::string> values;
  for (const std::string argument : container.value("args", Json::array())) {
    if (absl::StartsWith(argument, flag + "=")) values.push_back(argument.substr(flag.size() + 1));
  }
  return values;
}

bool Workload::IsOurs() const {
  return absl::StartsWith(container["image"].get<std::string>(), "mortise:");
}

bool Workload::IsWorker() const { return name.ends_with("-worker"); }

Manifests::Manifests() {
  const std::filesystem::path folder = SourceFolder() / "deploy" / "kubernetes";
  kustomization_ = ReadYaml({folder / "kustomization.yaml"}).at(0);
  std::vector<std::filesystem::path> files;
  for (const std::string file : kustomization_["resources"]) files.push_back(folder / file);
  documents_ = ReadYaml(files);
  for (const Json& document : documents_) {
    const std::string kind = document["kind"];
    if (kind == "Deployment" || kind == "StatefulSet") AddWorkload(document);
  }
}

void Manifests::AddWorkload(const Json& document) {
  Workload workload;
  workload.name = document["metadata"]["name"];
  workload.document = document;
  workload.pod = document["spec"]["template"]["spec"];
  workload.labels = document["spec"]["template"]["metadata"]["labels"];
  EXPECT_EQ(workload.pod["containers"].size(), 1u) << workload.name;
  workload.container = workload.pod["containers"][0];
  workload.ports = Json::object();
  for (const Json& port : workload.container.value("ports", Json::array())) {
    workload.ports[port["name"].get<std::string>()] = port["containerPort"];
  }
  workload.environment = Json::object();
  for (const Json& source : workload.container.value("envFrom", Json::array())) {
    const Json map = Find("ConfigMap", source["configMapRef"]["name"]);
    EXPECT_FALSE(map.is_null()) << workload.name << ": " << source;
    if (!map.is_null()) workload.environment.update(map["data"]);
  }
  for (const Json& variable : workload.container.value("env", Json::array())) {
    workload.environment[variable["name"].get<std::string>()] = variable.value("value", "");
  }
  for (const std::string argument : workload.container.value("args", Json::array())) {
    absl::StrAppend(&workload.stated, argument, " ");
  }
  workloads_.push_back(std::move(workload));
}

const Workload& Manifests::workload(const std::string& name) const {
  for (const Workload& workload : workloads_) {
    if (workload.name == name) return workload;
  }
  ADD_FAILURE() << "there is no workload " << name;
  static const Workload none;
  return none;
}

std::set<ServiceCall> Manifests::Calls() const {
  std::set<ServiceCall> calls;
  const auto add = [&calls](const std::string& caller, const std::string& address) {
    const std::vector<std::string> parts = absl::StrSplit(address, ':');
    ASSERT_EQ(parts.size(), 2u) << address;
    calls.insert({caller, parts[0], std::atoi(parts[1].c_str())});
  };
  for (const Workload& workload : workloads_) {
    for (const char* flag : {"--peer", "--service"}) {
      for (const std::string& value : workload.Values(flag)) {
        add(workload.name, value.substr(value.find('=') + 1));
      }
    }
    for (const std::string& endpoint : workload.Values("--bus-publish")) {
      const std::string address = endpoint.substr(std::string("tcp://").size());
      if (!absl::StartsWith(address, "0.0.0.0:")) add(workload.name, address);
    }
    if (workload.environment.contains("PGPASSWORD")) add(workload.name, "postgres:5432");
  }
  return calls;
}

std::vector<Json> Manifests::OfKind(const std::string& kind) const {
  std::vector<Json> found;
  for (const Json& document : documents_) {
    if (document["kind"] == kind) found.push_back(document);
  }
  return found;
}

Json Manifests::Find(const std::string& kind, const std::string& name) const {
  Json found;
  for (const Json& document : OfKind(kind)) {
    if (document["metadata"]["name"] != name) continue;
    EXPECT_TRUE(found.is_null()) << "twice: " << kind << " " << name;
    found = document;
  }
  return found;
}

}  // namespace mortise::testing
