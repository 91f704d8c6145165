// The plan of a house: which processes `mortise up` starts, with which arguments, where they
// listen. compose.yaml describes the same house as containers; a test holds the two against each
// other.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/base/port_reservation.h"

namespace mortise::cli {

struct HouseOptions {
  std::filesystem::path state = ".mortise";  // where stores, blobs, keys and logs live
  std::filesystem::path binaries;            // folder of the mortise-* programs
  std::filesystem::path collection;          // items and designs that ship with it
  bool any_ports = false;                    // any free ports instead of the usual ones
  std::map<std::string, int> ports = {};     // by listener, instead of either; 0 for any
  int workers = 0;                           // simulator workers; 0 for one a core
  int retrieval_workers = 0;                 // beside the service's own threads
  bool virtual_cell = false;                 // also a virtual cell and the bridge to it
  double time_scale = 1;                     // of the virtual cell: simulated seconds a second
  bool insecure_development = false;         // plain text, no tokens; loopback only
  std::string tls_certificate;               // PEM file for the gateway's doors
  std::string tls_key;                       // PEM file
  std::string tls_authority;                 // PEM file of who signed it; itself if empty
  std::string jwt_keys;                      // file of keys that sign bearer tokens
  std::string jwks_url;                      // address of more of them
  std::string jwks_authority;                // PEM file of who signed that address's certificate
  std::vector<std::string> cors_origins;     // of pages that may call over HTTP
  std::string bridge_token_file;             // bearer token of the virtual cell's bridge
  double log_megabytes = 10;                 // after which a process begins a new log file
};

// One process to start.
struct HouseProcess {
  std::string name;                  // "catalog", "simulator-worker-1"
  std::vector<std::string> command;  // program and arguments
  std::string address;               // host:port of its gRPC service, empty if it has none
  std::filesystem::path port_file;   // appears when it serves; empty if it has none
};

struct HousePlan {
  std::vector<HouseProcess> processes;  // in the order of starting
  std::string gateway_grpc;             // host:port
  std::string gateway_http;             // host:port
  // Keep the ports for the processes, also while one restarts: as long as the house stands.
  std::vector<PortReservation> reservations = {};
};

// Whom a client of the house must trust: a PEM file, empty for a house in plain text.
std::string AuthorityOf(const HouseOptions& options);

// Chooses ports and writes the command lines. INVALID_ARGUMENT naming the option at fault, or the
// listener whose port is taken, with the process that has it.
absl::StatusOr<HousePlan> PlanHouse(const HouseOptions& options);

// Returns the services behind the gateway, in the order in which data flows.
const std::vector<std::string>& HouseServices();

// Returns the names of all listeners that have a port, also those of which UsualPort knows none.
std::vector<std::string> HouseListeners();

// Returns the usual ports: "gateway" (gRPC), "gateway-http", "bus-publish", "bus-subscribe", and
// one for each service. The same in compose.yaml.
int UsualPort(const std::string& listener);

}  // namespace mortise::cli
