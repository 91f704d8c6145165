// The manifests in deploy/kubernetes as data, for tests to look things up in.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace mortise::testing {

using Json = nlohmann::json;

// The folder of the repository.
std::filesystem::path SourceFolder();

// The documents of YAML files, one after the other, aliases and merges resolved. Fails the test if
// there are none.
std::vector<Json> ReadYaml(const std::vector<std::filesystem::path>& files);

// One container of a pod of one workload; every workload here has one.
struct Workload {
  std::string name;    // of a Deployment or StatefulSet
  Json document;       // all of it
  Json pod;            // spec of its pods
  Json container;      // of these
  Json labels;         // of these
  Json environment;    // variables that are said literally, by name; of config maps too
  Json ports;          // of the container, numbers by name
  std::string stated;  // all arguments in one line

  // Of `--flag=value` the values, in order.
  std::vector<std::string> Values(const std::string& flag) const;
  // Whether this is one of our programs.
  bool IsOurs() const;
  // Whether it leases tasks from a service, and listens nowhere.
  bool IsWorker() const;
};

// One process calls another, by the name of a Service.
struct ServiceCall {
  std::string caller;
  std::string service;
  int port = 0;

  auto operator<=>(const ServiceCall&) const = default;
};

class Manifests {
 public:
  // What deploy/kubernetes has.
  Manifests();

  const Json& kustomization() const { return kustomization_; }
  const std::vector<Workload>& workloads() const { return workloads_; }
  // By name; fails the test if there is none.
  const Workload& workload(const std::string& name) const;
  // Who calls whom, as arguments and environment say.
  std::set<ServiceCall> Calls() const;
  // All documents of a kind.
  std::vector<Json> OfKind(const std::string& kind) const;
  // The only one of a kind with a name, null if there is none.
  Json Find(const std::string& kind, const std::string& name) const;

 private:
  void AddWorkload(const Json& document);

  Json kustomization_;
  std::vector<Json> documents_;
  std::vector<Workload> workloads_;
};

}  // namespace mortise::testing
