// How a service process is told what to do: plain options, read from flags and environment.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/base/logging.h"
#include "common/rpc/channel_security.h"

namespace CLI {
class App;
}

namespace mortise::rpc {

struct ServiceOptions {
  std::string name = {};                 // "catalog": store schema, event stream, issuer
  std::string listen = "127.0.0.1:0";    // --listen HOST:PORT; port 0 is any free one
  std::filesystem::path port_file = {};  // --port-file: {"grpc": "…", "metrics": "…"}
  std::string metrics = {};              // --metrics HOST:PORT; empty for none
  std::string store = {};                // --store; sqlite:state/<name>.db by default
  std::filesystem::path blobs = {};      // --blobs; state/<name>-blobs by default
  std::string bus_publish = {};          // --bus-publish; empty: events stay in the store
  std::filesystem::path keys = {};       // --keys; identity keys
  bool insecure_development = false;     // --insecure-development
  LogLevel log_level = LogLevel::kInfo;  // --log-level debug|info|warning|error
  int threads = 8;                       // --threads that run handlers
  int operation_threads = 2;             // --operation-threads
  std::string replica = "main";          // --replica; distinct where replicas share a store
  std::map<std::string, std::string> peers = {};  // --peer NAME=ADDRESS, repeatable
  std::string gateway = {};                       // --gateway ADDRESS
  ChannelSecurity security = {};                  // --tls-certificate, --tls-key, --tls-authority
  absl::Duration drain_time = absl::Seconds(10);  // --drain-seconds: for calls in flight at the end
};

// What a service says of itself.
struct ServiceDescription {
  std::string name;   // "catalog"
  std::string title;  // one line for --help
  // Adds flags of the service's own; may be empty.
  std::function<void(CLI::App&)> add_flags = nullptr;
  // A process that only calls others has no callers to know, and checks itself how it is known.
  bool only_calls = false;
};

// Reads the flags, each of which can also be given as an environment variable MORTISE_<FLAG>
// (MORTISE_BUS_PUBLISH; peers as MORTISE_PEERS="a=host:1,b=host:2"). INVALID_ARGUMENT naming the
// flag; also if --listen leaves the machine without TLS, or, unless the process only calls others,
// without --keys and --insecure-development being given. CANCELLED if --help or --version was asked
// for; its message is the text to print.
absl::StatusOr<ServiceOptions> ParseServiceOptions(int argc, const char* const* argv,
                                                   const ServiceDescription& description);

}  // namespace mortise::rpc
