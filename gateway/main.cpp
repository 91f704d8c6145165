// mortise-gateway: every service of the house behind one gRPC and one HTTP address.
#include <signal.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "common/base/descriptor_limit.h"
#include "common/base/logging.h"
#include "gateway/gateway.h"

namespace {

using mortise::LogLevel;
using mortise::gateway::Gateway;
using mortise::gateway::GatewayOptions;

// What is read from the command line and fits no option as it is.
struct RawFlags {
  std::vector<std::string> services;
  double drain_seconds = 10;
  std::string log_level = "info";
};

// Who signs tokens, and what they must say.
void AddTokenFlags(CLI::App& app, GatewayOptions& options) {
  app.add_option("--jwt-keys", options.jwt_keys,
                 "Public keys of bearer tokens: JSON Web Key Set or PEM")
      ->envname("MORTISE_JWT_KEYS");
  app.add_option("--jwks-url", options.jwks.url,
                 "Address of more of them, a JSON Web Key Set; fetched again and again")
      ->envname("MORTISE_JWKS_URL");
  app.add_option("--jwks-authority", options.jwks.authority,
                 "Whom to trust at that address, PEM; whom the system trusts if not given")
      ->envname("MORTISE_JWKS_AUTHORITY");
  app.add_option("--jwt-issuer", options.token.issuer, "Required issuer of tokens; any if empty")
      ->envname("MORTISE_JWT_ISSUER");
  app.add_option("--jwt-audience", options.token.audience,
                 "Required audience of tokens; any if empty")
      ->envname("MORTISE_JWT_AUDIENCE");
}

void AddFlags(CLI::App& app, GatewayOptions& options, RawFlags& raw) {
  app.add_option("--grpc", options.grpc, "HOST:PORT of the gRPC door; port 0 is any free one")
      ->envname("MORTISE_GRPC");
  app.add_option("--http", options.http, "HOST:PORT of the HTTP door")->envname("MORTISE_HTTP");
  app.add_option("--port-file", options.port_file, "Where the addresses are written, as JSON")
      ->envname("MORTISE_PORT_FILE");
  app.add_option("--service", raw.services, "NAME=HOST:PORT of a service; repeat for each")
      ->envname("MORTISE_SERVICES")
      ->delimiter(',');
  app.add_option("--store", options.store, "Store of webhooks and audit records")
      ->envname("MORTISE_STORE");
  app.add_option("--keys", options.keys, "Folder of identity keys, with gateway.key")
      ->envname("MORTISE_KEYS");
  AddTokenFlags(app, options);
  app.add_option("--tls-certificate", options.security.certificate,
                 "Certificate chain of both doors, shown to services too, PEM")
      ->envname("MORTISE_TLS_CERTIFICATE");
  app.add_option("--tls-key", options.security.key, "Its private key, PEM")
      ->envname("MORTISE_TLS_KEY");
  app.add_option("--tls-authority", options.services_security.authority,
                 "Whom to trust as services, PEM; none: services are on this machine")
      ->envname("MORTISE_TLS_AUTHORITY");
  app.add_option("--cors-origin", options.cors_origins,
                 "Origin whose pages may call over HTTP, as https://plm.example; repeat for each")
      ->envname("MORTISE_CORS_ORIGINS")
      ->delimiter(',');
  app.add_flag("--insecure-development", options.insecure_development,
               "Plain text and no tokens needed; loopback only")
      ->envname("MORTISE_INSECURE_DEVELOPMENT");
  app.add_option("--bus-publish", options.bus_publish, "Where services publish events")
      ->envname("MORTISE_BUS_PUBLISH");
  app.add_option("--bus-subscribe", options.bus_subscribe, "Where events are subscribed to")
      ->envname("MORTISE_BUS_SUBSCRIBE");
  app.add_flag("--webhook-loopback", options.webhooks.client.allow_loopback,
               "Webhooks may call addresses of this machine")
      ->envname("MORTISE_WEBHOOK_LOOPBACK");
  app.add_option("--drain-seconds", raw.drain_seconds, "Time for calls in flight at the end")
      ->envname("MORTISE_DRAIN_SECONDS")
      ->check(CLI::Range(0.0, 3600.0));
  app.add_option("--channels", options.channels, "Connections to each service")
      ->check(CLI::Range(1, 64));
  app.add_option("--http-threads", options.http_threads, "Threads of the HTTP door")
      ->check(CLI::Range(1, 64));
  app.add_option("--connections", options.most_connections,
                 "Clients of each door at a time; by default what the limit of open files leaves")
      ->envname("MORTISE_CONNECTIONS")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--streams-of-subject", options.open_calls.streams.of_subject,
                 "Streams that one subject may have open")
      ->envname("MORTISE_STREAMS_OF_SUBJECT")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  app.add_option("--log-level", raw.log_level, "debug, info, warning or error")
      ->envname("MORTISE_LOG_LEVEL")
      ->check(CLI::IsMember({"debug", "info", "warning", "error"}));
}

LogLevel ParseLogLevel(const std::string& name) {
  if (name == "debug") return LogLevel::kDebug;
  if (name == "warning") return LogLevel::kWarning;
  return name == "error" ? LogLevel::kError : LogLevel::kInfo;
}

// False, after saying so, for a --service that is not NAME=ADDRESS.
bool TakeServices(const RawFlags& raw, GatewayOptions& options) {
  for (const std::string& service : raw.services) {
    const auto equals = service.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == service.size()) {
      std::fprintf(stderr, "mortise-gateway: --service %s is not NAME=HOST:PORT\n",
                   service.c_str());
      return false;
    }
    options.services[service.substr(0, equals)] = service.substr(equals + 1);
  }
  return true;
}

int Run(const GatewayOptions& options) {
  // Before any thread starts, so that all inherit it and only this one takes the signals.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
  mortise::RaiseDescriptorLimit();

  auto gateway = Gateway::Start(options);
  if (!gateway.ok()) {
    std::fprintf(stderr, "mortise-gateway: %s\n", std::string(gateway.status().message()).c_str());
    return 1;
  }
  mortise::Log(LogLevel::kInfo, "serving",
               {{"grpc", (*gateway)->addresses().grpc}, {"http", (*gateway)->addresses().http}});
  int signal_number = 0;
  sigwait(&signals, &signal_number);
  mortise::Log(LogLevel::kInfo, "draining", {{"signal", signal_number}});
  gateway->reset();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  GatewayOptions options;
  RawFlags raw;
  CLI::App app("The gateway: every service of the house behind one gRPC and one HTTP address.",
               "mortise-gateway");
  app.set_version_flag("--version", mortise::gateway::GatewayVersion());
  AddFlags(app, options, raw);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (!TakeServices(raw, options)) return 2;
  // Services on other machines ask their callers for a certificate.
  if (!options.services_security.authority.empty()) {
    options.services_security.certificate = options.security.certificate;
    options.services_security.key = options.security.key;
  }
  options.drain_time = absl::Seconds(raw.drain_seconds);
  const LogLevel level = ParseLogLevel(raw.log_level);
  options.log_calls = level <= LogLevel::kInfo;
  mortise::ConfigureLogging("gateway", level);
  return Run(options);
}
