#include "common/host/service_options.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <vector>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"

namespace mortise::rpc {
namespace {

absl::StatusOr<ServiceOptions> Parse(std::vector<const char*> arguments,
                                     std::function<void(CLI::App&)> add_flags = nullptr) {
  arguments.insert(arguments.begin(), "mortise-catalog");
  ServiceDescription description{"catalog", "The catalog.", std::move(add_flags)};
  return ParseServiceOptions(static_cast<int>(arguments.size()), arguments.data(), description);
}

std::string FieldAtFault(const absl::StatusOr<ServiceOptions>& options) {
  EXPECT_EQ(options.status().code(), absl::StatusCode::kInvalidArgument);
  return DetailOf(options.status()).field;
}

TEST(ServiceOptionsTest, ReadsFlags) {
  const auto options =
      Parse({"--listen", "127.0.0.1:7001", "--keys", "/k", "--store", "sqlite:/s/c.db", "--peer",
             "simulator=127.0.0.1:7002", "--peer", "pareto=127.0.0.1:7003", "--threads", "3",
             "--log-level", "warning", "--drain-seconds", "2.5", "--metrics", "127.0.0.1:0"});
  ASSERT_OK(options);
  EXPECT_EQ(options->name, "catalog");
  EXPECT_EQ(options->listen, "127.0.0.1:7001");
  EXPECT_EQ(options->store, "sqlite:/s/c.db");
  EXPECT_EQ(options->peers.at("simulator"), "127.0.0.1:7002");
  EXPECT_EQ(options->peers.at("pareto"), "127.0.0.1:7003");
  EXPECT_EQ(options->threads, 3);
  EXPECT_EQ(options->log_level, LogLevel::kWarning);
  EXPECT_EQ(options->drain_time, absl::Milliseconds(2500));
}

TEST(ServiceOptionsTest, HasDefaultsForState) {
  const auto options = Parse({"--insecure-development"});
  ASSERT_OK(options);
  EXPECT_EQ(options->store, "sqlite:state/catalog.db");
  EXPECT_EQ(options->blobs, "state/catalog-blobs");
  EXPECT_EQ(options->listen, "127.0.0.1:0");
}

TEST(ServiceOptionsTest, ReadsTheEnvironment) {
  setenv("MORTISE_BUS_PUBLISH", "tcp://127.0.0.1:9", 1);
  setenv("MORTISE_PEERS", "a=h:1,b=h:2", 1);
  setenv("MORTISE_INSECURE_DEVELOPMENT", "true", 1);
  const auto options = Parse({});
  unsetenv("MORTISE_BUS_PUBLISH");
  unsetenv("MORTISE_PEERS");
  unsetenv("MORTISE_INSECURE_DEVELOPMENT");
  ASSERT_OK(options);
  EXPECT_EQ(options->bus_publish, "tcp://127.0.0.1:9");
  EXPECT_EQ(options->peers.at("b"), "h:2");
}

TEST(ServiceOptionsTest, RefusesUnsafeCombinations) {
  EXPECT_EQ(FieldAtFault(Parse({})), "keys");
  EXPECT_EQ(FieldAtFault(Parse({"--listen", "0.0.0.0:1", "--keys", "/k"})), "listen");
  EXPECT_EQ(FieldAtFault(Parse({"--listen", "0.0.0.0:1", "--tls-certificate", "/c", "--tls-key",
                                "/k", "--insecure-development"})),
            "insecure-development");
  EXPECT_EQ(FieldAtFault(Parse({"--keys", "/k", "--insecure-development"})),
            "insecure-development");
}

TEST(ServiceOptionsTest, ProcessesThatOnlyCallNeedNoKeys) {
  const char* const arguments[] = {"mortise-catalog", "--gateway", "127.0.0.1:7700"};
  const ServiceDescription worker{.name = "catalog", .title = "A worker.", .only_calls = true};
  const auto options = ParseServiceOptions(3, arguments, worker);
  ASSERT_OK(options);
  EXPECT_EQ(options->gateway, "127.0.0.1:7700");
  EXPECT_TRUE(options->keys.empty());
}

TEST(ServiceOptionsTest, RefusesNonsense) {
  EXPECT_EQ(FieldAtFault(Parse({"--insecure-development", "--peer", "simulator"})), "peer");
  EXPECT_EQ(FieldAtFault(Parse({"--insecure-development", "--threads", "0"})), "flags");
  EXPECT_EQ(FieldAtFault(Parse({"--no-such-flag"})), "flags");
  EXPECT_EQ(FieldAtFault(Parse({"--insecure-development", "--log-level", "loud"})), "flags");
}

TEST(ServiceOptionsTest, HelpIsText) {
  const auto options = Parse({"--help"});
  EXPECT_TRUE(absl::IsCancelled(options.status()));
  EXPECT_NE(options.status().message().find("--bus-publish"), std::string::npos);
}

TEST(ServiceOptionsTest, AServiceAddsItsOwnFlags) {
  int workers = 0;
  ASSERT_OK(Parse({"--insecure-development", "--workers", "5"},
                  [&](CLI::App& app) { app.add_option("--workers", workers); }));
  EXPECT_EQ(workers, 5);
}

TEST(ChannelSecurityTest, KnowsWhatStaysOnThisMachine) {
  for (const char* local : {"127.0.0.1:80", "127.9.8.7:1", "localhost:1", "[::1]:5", "unix:/x"}) {
    EXPECT_TRUE(IsLocalAddress(local)) << local;
  }
  for (const char* remote : {"0.0.0.0:80", "127.example.com:1", "10.0.0.1:1", "[::]:1", "host:1",
                             "localhost.example.com:1", ""}) {
    EXPECT_FALSE(IsLocalAddress(remote)) << remote;
  }
}

}  // namespace
}  // namespace mortise::rpc
