#include "cli/launcher/house.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/launcher/port_holder.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"

namespace mortise::cli {
namespace {

constexpr const char* kVirtualCell = "virtual-cell";

const std::map<std::string, int>& UsualPorts() {
  static const std::map<std::string, int> ports = {
      {"gateway", 7700},      {"catalog", 7701},     {"simulator", 7702},    {"pareto", 7703},
      {"fabplanner", 7704},   {"retrieval", 7705},   {"interpolator", 7706}, {"composer", 7707},
      {"gateway-http", 7780}, {"bus-publish", 7790}, {"bus-subscribe", 7791}};
  return ports;
}

// The port that a listener is to have; 0 for any that is free.
int WantedPort(const HouseOptions& options, const std::string& listener) {
  const auto chosen = options.ports.find(listener);
  if (chosen != options.ports.end()) return chosen->second;
  return options.any_ports ? 0 : UsualPort(listener);
}

// The failure to have a port, with who has it and how to do without.
absl::Status PortTaken(const absl::Status& failure, const std::string& listener, int port) {
  const std::string holder = PortHolder(port);
  std::string message(failure.message());
  if (!holder.empty()) absl::StrAppend(&message, ": ", holder, " has it");
  absl::StrAppend(&message, "; choose another with --port ", listener,
                  "=PORT, or any that are free with --any-ports");
  return WithDetail(absl::Status(failure.code(), message), DetailOf(failure));
}

// The loopback address of a listener, kept for it: the port chosen, its usual one, or any that is
// free.
absl::StatusOr<std::string> Reserve(const HouseOptions& options, const std::string& listener,
                                    HousePlan& plan) {
  const int wanted = WantedPort(options, listener);
  absl::StatusOr<PortReservation> reservation = PortReservation::Take(wanted, listener);
  if (!reservation.ok()) return PortTaken(reservation.status(), listener, wanted);
  plan.reservations.push_back(*std::move(reservation));
  return plan.reservations.back().address();
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

// All workers at their limit leave this machine some of its memory. Their own default is for a
// machine that has one worker; a limit in the environment is somebody's choice, which they inherit.
void AddMemoryLimit(int workers, HouseProcess& worker) {
  constexpr double kShare = 0.7, kLeast = 0.01, kMost = 8;  // of all; GB
  const double memory = 1e-9 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                        static_cast<double>(sysconf(_SC_PAGESIZE));
  if (!(memory > 0) || std::getenv("MORTISE_MEMORY_LIMIT") != nullptr) return;
  const double limit = std::clamp(kShare * memory / workers, kLeast, kMost);
  Add(worker, {"--memory-limit", absl::StrFormat("%.2f", limit)});
}

// The i-th worker of a service.
HouseProcess Worker(const HouseOptions& options, const std::string& service, int i,
                    const std::string& peer, const std::string& catalog) {
  HouseProcess worker;
  worker.name = absl::StrCat(service, "-worker-", i);
  worker.command = {(options.binaries / ("mortise-" + service)).string(),
                    "--worker",
                    "--worker-name",
                    worker.name,
                    "--keys",
                    (options.state / "keys").string(),
                    "--peer",
                    peer,
                    "--peer",
                    catalog};
  return worker;
}

// Adds what only some services are told. Builds of maps wait for workers, and would keep all else
// that the interpolator does waiting.
void AddOwnFlags(const std::string& name, const HouseOptions& options, const std::string& catalog,
                 const std::string& simulator, HouseProcess& service) {
  if (name == "catalog") Add(service, {"--collection", options.collection.string()});
  if (name != "catalog") Add(service, {"--peer", catalog});
  if (name == "pareto" || name == "interpolator") Add(service, {"--peer", simulator});
  if (name == "interpolator") Add(service, {"--operation-threads", "16"});
}

void AddWorkers(const HouseOptions& options, const std::string& catalog,
                const std::string& simulator, HousePlan& plan) {
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const int workers = options.workers > 0 ? options.workers : cores;
  for (int i = 1; i <= workers; ++i) {
    HouseProcess worker = Worker(options, "simulator", i, simulator, catalog);
    AddMemoryLimit(workers, worker);
    plan.processes.push_back(std::move(worker));
  }
}

absl::Status CheckFile(const std::string& option, const std::string& path) {
  std::error_code error;
  if (path.empty() || std::filesystem::is_regular_file(path, error)) return absl::OkStatus();
  return InvalidField(option, absl::StrCat("there is no file ", path));
}

// The doors are open to everybody on this machine, or closed to all without a token.
absl::Status CheckSecurity(const HouseOptions& options) {
  const bool any = !options.tls_certificate.empty() || !options.tls_key.empty() ||
                   !options.tls_authority.empty() || !options.jwt_keys.empty() ||
                   !options.jwks_url.empty() || !options.jwks_authority.empty() ||
                   !options.bridge_token_file.empty();
  if (options.insecure_development) {
    if (!any) return absl::OkStatus();
    return InvalidField("--insecure-development",
                        "is plain text without tokens; leave it out, or the options of TLS and "
                        "tokens");
  }
  const bool knows_keys = !options.jwt_keys.empty() || !options.jwks_url.empty();
  if (options.tls_certificate.empty() || options.tls_key.empty() || !knows_keys) {
    return InvalidField("--tls-certificate",
                        "give --tls-certificate, --tls-key and --jwt-keys (or --jwks-url), or say "
                        "--insecure-development for plain text without tokens on loopback");
  }
  if (options.virtual_cell && options.bridge_token_file.empty()) {
    return InvalidField("--bridge-token-file",
                        "the bridge of --virtual-cell needs a token with the role operator; only "
                        "the holder of the signing key can make one");
  }
  MORTISE_RETURN_IF_ERROR(CheckFile("--tls-certificate", options.tls_certificate));
  MORTISE_RETURN_IF_ERROR(CheckFile("--tls-key", options.tls_key));
  MORTISE_RETURN_IF_ERROR(CheckFile("--tls-authority", options.tls_authority));
  MORTISE_RETURN_IF_ERROR(CheckFile("--jwt-keys", options.jwt_keys));
  if (!options.jwks_authority.empty() && options.jwks_url.empty()) {
    return InvalidField("--jwks-authority", "is of --jwks-url, which is missing");
  }
  MORTISE_RETURN_IF_ERROR(CheckFile("--jwks-authority", options.jwks_authority));
  return CheckFile("--bridge-token-file", options.bridge_token_file);
}

// Ports are of listeners that there are, and of one listener each.
absl::Status CheckPorts(const HouseOptions& options) {
  const std::vector<std::string> listeners = HouseListeners();
  std::map<int, std::string> taken;
  for (const auto& [listener, port] : options.ports) {
    if (std::find(listeners.begin(), listeners.end(), listener) == listeners.end()) {
      return InvalidField("--port", absl::StrCat("there is no '", listener, "' in a house",
                                                 NamesOffered(listener, listeners)));
    }
    if (port == 0) continue;
    const auto [other, is_first] = taken.emplace(port, listener);
    if (!is_first) {
      return InvalidField("--port", absl::StrCat(other->second, " and ", listener,
                                                 " cannot both have port ", port));
    }
  }
  return absl::OkStatus();
}

// A virtual cell with a chop saw and a jigsaw, and the bridge that drives it.
absl::Status AddVirtualCell(const HouseOptions& options, HousePlan& plan) {
  MORTISE_ASSIGN_OR_RETURN(const std::string cell_address, Reserve(options, kVirtualCell, plan));
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
  if (!options.insecure_development) {
    Add(bridge,
        {"--tls-authority", AuthorityOf(options), "--token-file", options.bridge_token_file});
  }
  plan.processes.push_back(std::move(cell));
  plan.processes.push_back(std::move(bridge));
  return absl::OkStatus();
}

// The gateway before services at these addresses, in the order of HouseServices.
HouseProcess Gateway(const HouseOptions& options, const HousePlan& plan,
                     const std::vector<std::string>& addresses, const std::string& bus_publish,
                     const std::string& bus_subscribe) {
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
    Add(gateway, {"--tls-certificate", options.tls_certificate, "--tls-key", options.tls_key});
    if (!options.jwt_keys.empty()) Add(gateway, {"--jwt-keys", options.jwt_keys});
    if (!options.jwks_url.empty()) Add(gateway, {"--jwks-url", options.jwks_url});
    if (!options.jwks_authority.empty()) {
      Add(gateway, {"--jwks-authority", options.jwks_authority});
    }
  }
  for (const std::string& origin : options.cors_origins) Add(gateway, {"--cors-origin", origin});
  return gateway;
}

}  // namespace

const std::vector<std::string>& HouseServices() {
  static const std::vector<std::string> services = {
      "catalog", "simulator", "pareto", "fabplanner", "retrieval", "composer", "interpolator"};
  return services;
}

std::vector<std::string> HouseListeners() {
  std::vector<std::string> listeners;
  for (const auto& [listener, port] : UsualPorts()) listeners.push_back(listener);
  listeners.emplace_back(kVirtualCell);
  return listeners;
}

int UsualPort(const std::string& listener) {
  const auto found = UsualPorts().find(listener);
  return found == UsualPorts().end() ? 0 : found->second;
}

std::string AuthorityOf(const HouseOptions& options) {
  return options.tls_authority.empty() ? options.tls_certificate : options.tls_authority;
}

absl::StatusOr<HousePlan> PlanHouse(const HouseOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckSecurity(options));
  MORTISE_RETURN_IF_ERROR(CheckPorts(options));
  HousePlan plan;
  MORTISE_ASSIGN_OR_RETURN(plan.gateway_grpc, Reserve(options, "gateway", plan));
  MORTISE_ASSIGN_OR_RETURN(plan.gateway_http, Reserve(options, "gateway-http", plan));
  MORTISE_ASSIGN_OR_RETURN(const std::string bus_publish, Reserve(options, "bus-publish", plan));
  MORTISE_ASSIGN_OR_RETURN(const std::string bus_subscribe,
                           Reserve(options, "bus-subscribe", plan));
  std::vector<std::string> addresses;
  for (const std::string& name : HouseServices()) {
    MORTISE_ASSIGN_OR_RETURN(addresses.emplace_back(), Reserve(options, name, plan));
  }
  const std::string catalog = "catalog=" + addresses[0];
  const std::string simulator = "simulator=" + addresses[1];

  plan.processes.push_back(Gateway(options, plan, addresses, bus_publish, bus_subscribe));

  for (std::size_t i = 0; i < addresses.size(); ++i) {
    const std::string& name = HouseServices()[i];
    HouseProcess service = Service(options, name, addresses[i], "tcp://" + bus_publish);
    AddOwnFlags(name, options, catalog, simulator, service);
    plan.processes.push_back(std::move(service));
  }
  AddWorkers(options, catalog, simulator, plan);
  for (int i = 1; i <= options.retrieval_workers; ++i) {
    plan.processes.push_back(Worker(options, "retrieval", i, "retrieval=" + addresses[4], catalog));
  }
  if (options.virtual_cell) MORTISE_RETURN_IF_ERROR(AddVirtualCell(options, plan));
  return plan;
}

}  // namespace mortise::cli
