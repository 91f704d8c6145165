#include "common/host/service_options.h"

#include <CLI/CLI.hpp>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"

namespace mortise::rpc {
namespace {

// What CLI11 fills in before it is checked.
struct Flags {
  std::string listen = "127.0.0.1:0";
  std::string port_file;
  std::string metrics;
  std::string store;
  std::string blobs;
  std::string bus_publish;
  std::string keys;
  bool insecure_development = false;
  std::string log_level = "info";
  int threads = 8;
  int operation_threads = 2;
  std::string replica = "main";
  std::vector<std::string> peers;
  std::string gateway;
  std::string certificate;
  std::string key;
  std::string authority;
  double drain_seconds = 10;
};

// --bus-publish is also MORTISE_BUS_PUBLISH. Of several values the last counts.
template <class Value>
CLI::Option* Add(CLI::App& app, const std::string& flag, Value& value, const std::string& help) {
  const std::string variable =
      "MORTISE_" + absl::AsciiStrToUpper(absl::StrReplaceAll(flag, {{"-", "_"}}));
  return app.add_option("--" + flag, value, help)
      ->envname(variable)
      ->capture_default_str()
      ->take_last();
}

void AddFlags(CLI::App& app, Flags& flags) {
  Add(app, "listen", flags.listen, "HOST:PORT to serve on; port 0 takes a free one");
  Add(app, "port-file", flags.port_file, "file to write the addresses to once serving (JSON)");
  Add(app, "metrics", flags.metrics, "HOST:PORT for Prometheus /metrics; none if empty");
  Add(app, "store", flags.store, "sqlite:FILE or postgresql://USER@HOST/DATABASE");
  Add(app, "blobs", flags.blobs, "folder for large values");
  Add(app, "bus-publish", flags.bus_publish, "the event bus's publisher endpoint; none if empty");
  Add(app, "keys", flags.keys, "folder with identity keys: <issuer>.pub, and <service>.key");
  app.add_flag("--insecure-development", flags.insecure_development,
               "take every caller for an administrator; on loopback only")
      ->envname("MORTISE_INSECURE_DEVELOPMENT");
  Add(app, "log-level", flags.log_level, "debug, info, warning or error")
      ->check(CLI::IsMember({"debug", "info", "warning", "error"}));
  Add(app, "threads", flags.threads, "threads that answer calls")->check(CLI::Range(1, 256));
  Add(app, "operation-threads", flags.operation_threads, "operations that run at the same time")
      ->check(CLI::Range(1, 256));
  Add(app, "replica", flags.replica, "name of this replica where several share a store");
  app.add_option("--peer", flags.peers, "NAME=HOST:PORT of another service; repeatable")
      ->envname("MORTISE_PEERS")
      ->delimiter(',');
  Add(app, "gateway", flags.gateway, "HOST:PORT of the gateway");
  Add(app, "tls-certificate", flags.certificate, "certificate chain of this process (PEM)");
  Add(app, "tls-key", flags.key, "private key of the certificate (PEM)");
  Add(app, "tls-authority", flags.authority, "certificates to trust (PEM)");
  Add(app, "drain-seconds", flags.drain_seconds, "time for calls in flight at the end")
      ->check(CLI::Range(0.0, 3600.0));
}

LogLevel ParseLogLevel(const std::string& name) {
  if (name == "debug") return LogLevel::kDebug;
  if (name == "warning") return LogLevel::kWarning;
  if (name == "error") return LogLevel::kError;
  return LogLevel::kInfo;
}

absl::Status ParsePeers(const std::vector<std::string>& flags,
                        std::map<std::string, std::string>& peers) {
  for (const std::string& flag : flags) {
    const std::size_t equals = flag.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == flag.size()) {
      return InvalidField("peer", absl::StrCat("'", flag, "' is not of the form NAME=HOST:PORT"));
    }
    peers[flag.substr(0, equals)] = flag.substr(equals + 1);
  }
  return absl::OkStatus();
}

absl::Status CheckAccess(const ServiceOptions& options, bool only_calls) {
  const bool local = IsLocalAddress(options.listen);
  if (!local && options.security.certificate.empty()) {
    return InvalidField("listen", absl::StrCat(options.listen,
                                               " leaves this machine, which needs --tls-certificate"
                                               " and --tls-key"));
  }
  if (options.insecure_development) {
    if (!local) return InvalidField("insecure-development", "is for loopback only");
    if (!options.keys.empty()) {
      return InvalidField("insecure-development", "contradicts --keys");
    }
  } else if (options.keys.empty() && !only_calls) {
    return InvalidField("keys",
                        "must be given, so that callers can be known "
                        "(or --insecure-development, on loopback)");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ServiceOptions> ParseServiceOptions(int argc, const char* const* argv,
                                                   const ServiceDescription& description) {
  CLI::App app(description.title, absl::StrCat("mortise-", description.name));
  Flags flags;
  AddFlags(app, flags);
  if (description.add_flags) description.add_flags(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return absl::CancelledError(app.help());
  } catch (const CLI::Error& error) {
    return InvalidField("flags", error.what());
  }

  ServiceOptions options;
  options.name = description.name;
  options.listen = flags.listen;
  options.port_file = flags.port_file;
  options.metrics = flags.metrics;
  options.store =
      flags.store.empty() ? absl::StrCat("sqlite:state/", options.name, ".db") : flags.store;
  options.blobs =
      flags.blobs.empty() ? absl::StrCat("state/", options.name, "-blobs") : flags.blobs;
  options.bus_publish = flags.bus_publish;
  options.keys = flags.keys;
  options.insecure_development = flags.insecure_development;
  options.log_level = ParseLogLevel(flags.log_level);
  options.threads = flags.threads;
  options.operation_threads = flags.operation_threads;
  options.replica = flags.replica;
  options.gateway = flags.gateway;
  options.security = {flags.certificate, flags.key, flags.authority};
  options.drain_time = absl::Seconds(flags.drain_seconds);
  MORTISE_RETURN_IF_ERROR(ParsePeers(flags.peers, options.peers));
  MORTISE_RETURN_IF_ERROR(CheckAccess(options, description.only_calls));
  return options;
}

}  // namespace mortise::rpc
