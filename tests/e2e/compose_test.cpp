// compose.yaml and `mortise up` describe the same house, so that the two cannot drift apart.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "cli/launcher/house.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "tests/e2e/command.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;

std::string Source() {
  const char* folder = std::getenv("MORTISE_SOURCE_DIR");
  return folder == nullptr ? "." : folder;
}

// compose.yaml as docker-compose understands it.
Json Compose() {
  const auto out = std::filesystem::temp_directory_path() / ("compose-" + NewIdentifier());
  const std::string command =
      "docker-compose -f " + Source() + "/compose.yaml config > " + out.string() + ".yaml 2> " +
      out.string() +
      ".err && /usr/bin/python3 -c 'import json, sys, yaml; "
      "json.dump(yaml.safe_load(open(sys.argv[1])), open(sys.argv[2], \"w\"))' " +
      out.string() + ".yaml " + out.string() + ".json";
  EXPECT_EQ(std::system(command.c_str()), 0) << ReadFile(out.string() + ".err").value_or("");
  Json document = Json::parse(ReadFile(out.string() + ".json").value_or(""), nullptr, false);
  EXPECT_FALSE(document["services"].empty()) << "docker-compose shows no services";
  for (const char* ending : {".yaml", ".err", ".json"}) {
    std::filesystem::remove(out.string() + ending);
  }
  return document;
}

// The processes of `mortise up`, workers counted once.
std::set<std::string> Launched() {
  const CommandResult result =
      Mortise({"--json", "up", "--dry-run", "--insecure-development", "--any-ports", "--workers",
               "2", "--retrieval-workers", "2"});
  std::set<std::string> names;
  const Json plan = Json::parse(result.out, nullptr, false);
  for (const Json& process : plan["processes"]) {
    names.insert(
        std::regex_replace(process["name"].get<std::string>(), std::regex("-[0-9]+$"), ""));
  }
  return names;
}

TEST(Compose, HasTheServicesThatUpStarts) {
  std::set<std::string> services;
  const Json compose = Compose();
  for (const auto& [name, service] : compose["services"].items()) {
    if (name != "postgres") services.insert(name);
  }
  EXPECT_EQ(services, Launched());
}

TEST(Compose, UsesThePortsThatUpUses) {
  const Json services = Compose()["services"];
  for (const std::string& name : cli::HouseServices()) {
    const std::string port = std::to_string(cli::UsualPort(name));
    EXPECT_THAT(services[name]["command"].dump(), testing::HasSubstr("0.0.0.0:" + port)) << name;
    EXPECT_THAT(services[name]["expose"].dump(), testing::HasSubstr(port)) << name;
    EXPECT_THAT(services["gateway"]["command"].dump(), testing::HasSubstr(name + ":" + port))
        << name;
  }
  const std::string gateway = services["gateway"].dump();
  for (const char* listener : {"gateway", "gateway-http", "bus-publish", "bus-subscribe"}) {
    EXPECT_THAT(gateway, testing::HasSubstr(std::to_string(cli::UsualPort(listener)))) << listener;
  }
}

TEST(Compose, EveryListenerHasAHealthCheckAndComesBack) {
  const Json compose = Compose();
  for (const auto& [name, service] : compose["services"].items()) {
    EXPECT_EQ(service["restart"], "unless-stopped") << name;
    // A worker listens nowhere; its service takes its tasks back when it is silent.
    EXPECT_EQ(service.contains("healthcheck"), !name.ends_with("-worker")) << name;
  }
}

}  // namespace
}  // namespace mortise::e2e
