// Who the policies of deploy/kubernetes let speak with whom, against who calls whom.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tests/integration/deploy/kubernetes/manifests.h"

namespace mortise::testing {
namespace {

bool Selects(const Json& selector, const Json& labels) {
  const Json wanted = selector.value("matchLabels", Json::object());
  for (const auto& [key, value] : wanted.items()) {
    if (labels.value(key, "") != value) return false;
  }
  for (const Json& expression : selector.value("matchExpressions", Json::array())) {
    EXPECT_EQ(expression["operator"], "In");
    const auto values = expression["values"].get<std::set<std::string>>();
    if (values.count(labels.value(expression["key"].get<std::string>(), "")) == 0) return false;
  }
  return true;
}

bool NamesPort(const Json& rule, int port) {
  if (!rule.contains("ports")) return true;
  for (const Json& entry : rule["ports"]) {
    if (entry["port"] == port) return true;
  }
  return false;
}

// Whether a rule is for pods with these labels, on `side` of it ("from", "to"); null: for anybody.
bool NamesPeer(const Json& rule, const char* side, const Json& labels) {
  if (!rule.contains(side)) return true;
  for (const Json& entry : rule[side]) {
    const bool of_this_namespace =
        entry.contains("podSelector") && !entry.contains("namespaceSelector");
    if (of_this_namespace && !labels.is_null() && Selects(entry["podSelector"], labels)) {
      return true;
    }
  }
  return false;
}

class NetworkPoliciesTest : public ::testing::Test {
 protected:
  // Whether the policies that hold for `pod` let it be reached, or reach others. Without any,
  // everything goes.
  bool Ingress(const Json& pod, const Json& from, int port) const {
    return Allowed("Ingress", "ingress", "from", pod, from, port);
  }
  bool Egress(const Json& pod, const Json& to, int port) const {
    return Allowed("Egress", "egress", "to", pod, to, port);
  }

  static bool IsDoor(const Workload& target, const std::string& port) {
    return target.name == "gateway" && (port == "grpc" || port == "http");
  }

  const Manifests manifests_;

 private:
  bool Allowed(const char* type, const char* rules, const char* side, const Json& pod,
               const Json& peer, int port) const {
    bool any = false;
    for (const Json& policy : manifests_.OfKind("NetworkPolicy")) {
      const Json& spec = policy["spec"];
      const auto types = spec["policyTypes"].get<std::set<std::string>>();
      if (types.count(type) == 0 || !Selects(spec["podSelector"], pod)) continue;
      any = true;
      for (const Json& rule : spec.value(rules, Json::array())) {
        if (NamesPort(rule, port) && NamesPeer(rule, side, peer)) return true;
      }
    }
    return !any;
  }
};

TEST_F(NetworkPoliciesTest, AllowJustTheCallsThatAreMade) {
  const std::set<ServiceCall> calls = manifests_.Calls();
  EXPECT_GE(calls.size(), 18u);
  for (const Workload& target : manifests_.workloads()) {
    for (const auto& [name, number] : target.ports.items()) {
      const int port = number;
      for (const Workload& source : manifests_.workloads()) {
        if (source.name == target.name) continue;
        // The doors are open to all but workers, who have no need of them.
        const bool wanted = calls.count({source.name, target.name, port}) > 0 ||
                            (IsDoor(target, name) && !source.IsWorker());
        EXPECT_EQ(Egress(source.labels, target.labels, port) &&
                      Ingress(target.labels, source.labels, port),
                  wanted)
            << source.name << " to " << target.name << ":" << port;
      }
    }
  }
}

TEST_F(NetworkPoliciesTest, OthersReachTheDoorsOnly) {
  for (const Workload& target : manifests_.workloads()) {
    for (const auto& [name, port] : target.ports.items()) {
      EXPECT_EQ(Ingress(target.labels, Json(), port), IsDoor(target, name))
          << target.name << ":" << port;
    }
  }
  for (const Workload& source : manifests_.workloads()) {
    if (!source.IsWorker()) continue;
    EXPECT_FALSE(Egress(source.labels, Json(), 443)) << source.name;
  }
}

}  // namespace
}  // namespace mortise::testing
