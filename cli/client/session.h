// Every command has a session at hand: the global options and the connection to the gateway.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/client/gateway_client.h"
#include "cli/client/long_work.h"
#include "cli/client/output.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI
namespace mortise::v1 {
class ParameterValue;
}

namespace mortise::cli {

// Filled by the command line; a command is a function of it that main runs after parsing.
struct Session {
  bool json = false;
  GatewayOptions gateway;
  std::function<absl::Status(Session&, Output&)> command;  // set by the subcommand chosen

  // True where the house ends with the command, as that of `mortise demo` does.
  bool house_ends_too = false;

  // Returns how the command does work that takes long.
  LongWork Work(bool detach) const;

  // Returns the connection, made on first use.
  absl::StatusOr<GatewayClient*> Client();

 private:
  std::optional<GatewayClient> client_;
};

// Adds --detach to a command that starts an operation.
CLI::Option* AddDetach(CLI::App& command, bool& detach);

}  // namespace mortise::cli
