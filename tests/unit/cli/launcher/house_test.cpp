#include "cli/launcher/house.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "common/base/port_reservation.h"

namespace mortise::cli {
namespace {

using testing::Contains;
using testing::HasSubstr;

HouseOptions Development() {
  HouseOptions options;
  options.binaries = "bin";
  options.any_ports = true;
  options.insecure_development = true;
  options.workers = 3;
  return options;
}

// What the environment says of workers' memory, whatever it said before, until the test ends.
class MemoryLimitInEnvironment {
 public:
  explicit MemoryLimitInEnvironment(const char* limit) {
    if (const char* before = std::getenv(kName)) before_ = before;
    Set(limit);
  }
  ~MemoryLimitInEnvironment() { Set(before_ ? before_->c_str() : nullptr); }
  MemoryLimitInEnvironment(const MemoryLimitInEnvironment&) = delete;
  MemoryLimitInEnvironment& operator=(const MemoryLimitInEnvironment&) = delete;

 private:
  static constexpr char kName[] = "MORTISE_MEMORY_LIMIT";

  static void Set(const char* limit) {
    if (limit == nullptr) {
      unsetenv(kName);
    } else {
      setenv(kName, limit, 1);
    }
  }

  std::optional<std::string> before_;
};

std::set<std::string> Names(const HousePlan& plan) {
  std::set<std::string> names;
  for (const HouseProcess& process : plan.processes) names.insert(process.name);
  return names;
}

TEST(PlanHouse, HasTheGatewayEveryServiceAndTheWorkers) {
  const HousePlan plan = PlanHouse(Development()).value();
  EXPECT_THAT(Names(plan), testing::UnorderedElementsAre(
                               "gateway", "catalog", "simulator", "pareto", "fabplanner",
                               "retrieval", "interpolator", "composer", "simulator-worker-1",
                               "simulator-worker-2", "simulator-worker-3"));
}

TEST(PlanHouse, AddsRetrievalWorkersThatKnowTheirServices) {
  HouseOptions options = Development();
  options.retrieval_workers = 2;
  const HousePlan plan = PlanHouse(options).value();
  std::map<std::string, std::string> addresses;
  for (const HouseProcess& process : plan.processes) addresses[process.name] = process.address;
  int workers = 0;
  for (const HouseProcess& process : plan.processes) {
    if (process.name.rfind("retrieval-worker-", 0) != 0) continue;
    ++workers;
    EXPECT_THAT(process.command, Contains("--worker"));
    EXPECT_THAT(process.command, Contains(process.name));
    EXPECT_THAT(process.command, Contains("retrieval=" + addresses["retrieval"]));
    EXPECT_THAT(process.command, Contains("catalog=" + addresses["catalog"]));
  }
  EXPECT_EQ(workers, 2);
}

TEST(PlanHouse, AddsTheVirtualCellAndItsBridge) {
  HouseOptions options = Development();
  options.virtual_cell = true;
  EXPECT_THAT(Names(PlanHouse(options).value()),
              testing::AllOf(Contains("virtual-cell"), Contains("hwbridge")));
}

TEST(PlanHouse, ListensOnLoopbackOnlyEachAtItsOwnPort) {
  const HousePlan plan = PlanHouse(Development()).value();
  std::set<std::string> addresses;
  for (const HouseProcess& process : plan.processes) {
    if (process.address.empty()) continue;
    EXPECT_EQ(process.address.rfind("127.0.0.1:", 0), 0u) << process.address;
    EXPECT_TRUE(addresses.insert(process.address).second) << process.address;
  }
}

TEST(PlanHouse, TellsTheGatewayWhereEveryServiceIs) {
  const HousePlan plan = PlanHouse(Development()).value();
  const std::vector<std::string>& gateway = plan.processes.front().command;
  for (const HouseProcess& process : plan.processes) {
    if (process.address.empty() || process.name == "gateway") continue;
    EXPECT_THAT(gateway, Contains(process.name + "=" + process.address));
  }
}

// However many there are, they fit into the machine together, and none has more than its default.
TEST(PlanHouse, SharesTheMachinesMemoryAmongWorkers) {
  const MemoryLimitInEnvironment none(nullptr);
  const double memory = 1e-9 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                        static_cast<double>(sysconf(_SC_PAGESIZE));
  HouseOptions options = Development();
  for (const int workers : {1, 20}) {
    options.workers = workers;
    double sum = 0;
    const HousePlan plan = PlanHouse(options).value();
    for (const HouseProcess& process : plan.processes) {
      const auto& words = process.command;
      const auto flag = std::find(words.begin(), words.end(), "--memory-limit");
      EXPECT_EQ(flag != words.end(), process.name.rfind("simulator-worker", 0) == 0);
      if (flag == words.end()) continue;
      EXPECT_GT(std::stod(flag[1]), 0);
      EXPECT_LE(std::stod(flag[1]), 8);
      sum += std::stod(flag[1]);
    }
    EXPECT_LT(sum, 0.75 * memory + 0.01 * workers);
  }
}

// Workers inherit a limit that somebody chose for them.
TEST(PlanHouse, LeavesTheMemoryToTheEnvironmentsLimit) {
  const MemoryLimitInEnvironment chosen("1.5");
  const HousePlan plan = PlanHouse(Development()).value();
  for (const HouseProcess& process : plan.processes) {
    EXPECT_THAT(process.command, testing::Not(Contains("--memory-limit"))) << process.name;
  }
}

TEST(PlanHouse, RefusesPlainTextUnlessAskedFor) {
  HouseOptions options = Development();
  options.insecure_development = false;
  const absl::Status status = PlanHouse(options).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("--insecure-development"));
}

TEST(PlanHouse, TakesThePortsThatAreChosen) {
  const int port = [] {
    const auto reserved = PortReservation::Take(0, "port").value();
    return std::stoi(reserved.address().substr(reserved.address().rfind(':') + 1));
  }();
  HouseOptions options = Development();
  options.ports = {{"gateway", port}};
  const auto plan = PlanHouse(options);
  ASSERT_TRUE(plan.ok()) << plan.status();
  EXPECT_EQ(plan->gateway_grpc, "127.0.0.1:" + std::to_string(port));
}

TEST(PlanHouse, NamesListenersThatThereAreNot) {
  HouseOptions options = Development();
  options.ports = {{"gatway", 8700}};
  EXPECT_THAT(std::string(PlanHouse(options).status().message()),
              HasSubstr("did you mean 'gateway'?"));
  options.ports = {{"gateway", 8700}, {"catalog", 8700}};
  EXPECT_THAT(std::string(PlanHouse(options).status().message()),
              HasSubstr("cannot both have port 8700"));
}

TEST(PlanHouse, SaysWhoHasAPort) {
  const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  ASSERT_EQ(::bind(listener, generic, length), 0);
  ASSERT_EQ(::listen(listener, 1), 0);
  ASSERT_EQ(::getsockname(listener, generic, &length), 0);
  HouseOptions options = Development();
  options.ports = {{"catalog", ntohs(address.sin_port)}};
  const absl::Status taken = PlanHouse(options).status();
  EXPECT_EQ(taken.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(taken.message()),
              testing::AllOf(HasSubstr("catalog"), HasSubstr("--port catalog=PORT"),
                             HasSubstr("(process " + std::to_string(::getpid()) + ") has it"),
                             HasSubstr("--any-ports")));
  ::close(listener);
}

// The keys may be at an address whose certificate an authority of the company signed.
TEST(PlanHouse, HandsTheAuthorityOfTheKeysAddressToTheGateway) {
  HouseOptions options = Development();
  options.insecure_development = false;
  options.tls_certificate = options.tls_key = options.jwks_authority = "/proc/self/status";
  EXPECT_THAT(std::string(PlanHouse(options).status().message()), HasSubstr("--jwks-url"));
  options.jwks_url = "https://keys.example/jwks";
  const auto plan = PlanHouse(options);
  ASSERT_TRUE(plan.ok()) << plan.status();
  EXPECT_THAT(plan->processes[0].command, Contains("--jwks-authority"));
}

TEST(UsualPort, IsDifferentForEveryListener) {
  std::set<int> ports;
  std::vector<std::string> listeners = HouseServices();
  listeners.insert(listeners.end(), {"gateway", "gateway-http", "bus-publish", "bus-subscribe"});
  for (const std::string& listener : listeners) {
    EXPECT_GT(UsualPort(listener), 1024) << listener;
    EXPECT_TRUE(ports.insert(UsualPort(listener)).second) << listener;
  }
}

}  // namespace
}  // namespace mortise::cli
