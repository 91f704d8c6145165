#include "cli/house.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <thread>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

// The loopback address of a listener: at its usual port, or at any that is free now.
absl::StatusOr<std::string> Address(const HouseOptions& options, const std::string& listener) {
  const int wanted = options.any_ports ? 0 : UsualPort(listener);
  const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return absl::InternalError(std::strerror(errno));
  const int reuse = 1;
  ::setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof reuse);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(wanted));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  const bool bound =
      ::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &length) == 0;
  const int error = errno;
  ::close(descriptor);
  if (!bound) {
    return InvalidField(listener,
                        absl::StrCat("port ", wanted, " cannot be used: ", std::strerror(error)));
  }
  return absl::StrCat("127.0.0.1:", ntohs(address.sin_port));
}

// The arguments that every service takes.
HouseProcess Service(const HouseOptions& options, const std::string& name,
                     const std::string& address, const std::string& bus) {
  const std::filesystem::path& state = options.state;
  HouseProcess process;
  process.name = name;
  process.address = address;
  process.port_file = state / "ports" / (name + ".json");
  process.command = {(options.binaries / ("mortise-" + name)).string(),
                     "--listen",
                     address,
                     "--port-file",
                     process.port_file.string(),
                     "--metrics",
                     "127.0.0.1:0",
                     "--store",
                     "sqlite:" + (state / (name + ".db")).string(),
                     "--blobs",
                     (state / "blobs" / name).string(),
                     "--keys",
                     (state / "keys").string(),
                     "--bus-publish",
                     bus};
  return process;
}

void Add(HouseProcess& process, std::initializer_list<std::string> arguments) {
  process.command.insert(process.command.end(), arguments);
}

// A virtual cell with a chop saw and a jigsaw, and the bridge that drives it.
absl::Status AddVirtualCell(const HouseOptions& options, HousePlan& plan) {
  MORTISE_ASSIGN_OR_RETURN(const std::string cell_address, Address(options, "virtual-cell"));
  HouseProcess cell;
  cell.name = "virtual-cell";
  cell.port_file = options.state / "ports" / "virtual-cell.json";
  cell.command = {(options.binaries / "mortise-virtual-cell").string(),
                  "--port",
                  cell_address.substr(cell_address.find(':') + 1),
                  "--port-file",
                  cell.port_file.string(),
                  "--time-scale",
                  absl::StrCat(options.time_scale),
                  "--state",
                  (options.state / "virtual-cell").string()};
  HouseProcess bridge;
  bridge.name = "hwbridge";
  bridge.port_file = options.state / "ports" / "hwbridge.json";
  bridge.command = {(options.binaries / "mortise-hwbridge").string(),
                    "--bridge",
                    "virtual-cell",
                    "--gateway",
                    plan.gateway_grpc,
                    "--machine",
                    "chop-saw=chop-saw@" + cell_address + "/1",
                    "--machine",
                    "jigsaw=jigsaw@" + cell_address + "/2",
                    "--journal",
                    (options.state / "hwbridge.journal").string(),
                    "--ready-file",
                    bridge.port_file.string()};
  plan.processes.push_back(std::move(cell));
  plan.processes.push_back(std::move(bridge));
  return absl::OkStatus();
}

}  // namespace

const std::vector<std::string>& HouseServices() {
  static const std::vector<std::string> services = {"catalog", "simulator", "pareto", "fabplanner"};
  return services;
}

int UsualPort(const std::string& listener) {
  static const std::map<std::string, int> ports = {
      {"gateway", 7700},    {"catalog", 7701},      {"simulator", 7702},   {"pareto", 7703},
      {"fabplanner", 7704}, {"gateway-http", 7780}, {"bus-publish", 7790}, {"bus-subscribe", 7791}};
  const auto found = ports.find(listener);
  return found == ports.end() ? 0 : found->second;
}

absl::StatusOr<HousePlan> PlanHouse(const HouseOptions& options) {
  const bool has_tls = !options.tls_certificate.empty() && !options.tls_key.empty();
  if (!options.insecure_development && (!has_tls || options.jwt_keys.empty())) {
    return InvalidField("--tls-certificate",
                        "give --tls-certificate, --tls-key and --jwt-keys, or say "
                        "--insecure-development for plain text without tokens on loopback");
  }
  HousePlan plan;
  MORTISE_ASSIGN_OR_RETURN(plan.gateway_grpc, Address(options, "gateway"));
  MORTISE_ASSIGN_OR_RETURN(plan.gateway_http, Address(options, "gateway-http"));
  MORTISE_ASSIGN_OR_RETURN(const std::string bus_publish, Address(options, "bus-publish"));
  MORTISE_ASSIGN_OR_RETURN(const std::string bus_subscribe, Address(options, "bus-subscribe"));
  std::vector<std::string> addresses;
  for (const std::string& name : HouseServices()) {
    MORTISE_ASSIGN_OR_RETURN(addresses.emplace_back(), Address(options, name));
  }
  const std::string catalog = "catalog=" + addresses[0];
  const std::string simulator = "simulator=" + addresses[1];

  HouseProcess gateway;
  gateway.name = "gateway";
  gateway.address = plan.gateway_grpc;
  gateway.port_file = options.state / "ports" / "gateway.json";
  gateway.command = {(options.binaries / "mortise-gateway").string(),
                     "--grpc",
                     plan.gateway_grpc,
                     "--http",
                     plan.gateway_http,
                     "--port-file",
                     gateway.port_file.string(),
                     "--store",
                     "sqlite:" + (options.state / "gateway.db").string(),
                     "--keys",
                     (options.state / "keys").string(),
                     "--bus-publish",
                     "tcp://" + bus_publish,
                     "--bus-subscribe",
                     "tcp://" + bus_subscribe};
  for (std::size_t i = 0; i < addresses.size(); ++i) {
    Add(gateway, {"--service", HouseServices()[i] + "=" + addresses[i]});
  }
  if (options.insecure_development) {
    Add(gateway, {"--insecure-development"});
  } else {
    Add(gateway, {"--tls-certificate", options.tls_certificate, "--tls-key", options.tls_key,
                  "--jwt-keys", options.jwt_keys});
  }
  plan.processes.push_back(std::move(gateway));

  for (std::size_t i = 0; i < addresses.size(); ++i) {
    const std::string& name = HouseServices()[i];
    HouseProcess service = Service(options, name, addresses[i], "tcp://" + bus_publish);
    if (name == "catalog") Add(service, {"--collection", options.collection.string()});
    if (name != "catalog") Add(service, {"--peer", catalog});
    if (name == "pareto") Add(service, {"--peer", simulator});
    plan.processes.push_back(std::move(service));
  }
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const int workers = options.workers > 0 ? options.workers : cores;
  for (int i = 1; i <= workers; ++i) {
    HouseProcess worker;
    worker.name = absl::StrCat("simulator-worker-", i);
    worker.command = {(options.binaries / "mortise-simulator").string(),
                      "--worker",
                      "--worker-name",
                      worker.name,
                      "--keys",
                      (options.state / "keys").string(),
                      "--peer",
                      simulator,
                      "--peer",
                      catalog};
    plan.processes.push_back(std::move(worker));
  }
  if (options.virtual_cell) MORTISE_RETURN_IF_ERROR(AddVirtualCell(options, plan));
  return plan;
}

}  // namespace mortise::cli
