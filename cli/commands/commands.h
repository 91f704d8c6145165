// What every command has at hand: the global options, the output, the connection to the gateway.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/gateway_client.h"
#include "cli/long_work.h"
#include "cli/output.h"

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

  // Whether the house ends with the command, as that of `mortise demo` does.
  bool house_ends_too = false;

  // How the command does work that takes long.
  LongWork Work(bool detach) const;

  // The connection, made on first use.
  absl::StatusOr<GatewayClient*> Client();

 private:
  std::optional<GatewayClient> client_;
};

// Adds --detach to a command that starts an operation.
CLI::Option* AddDetach(CLI::App& command, bool& detach);

// Each adds its subcommands to `app`; `session` outlives the parsing.
void AddHouseCommands(CLI::App& app, Session& session);     // up, down, status, keys
void AddCallCommand(CLI::App& app, Session& session);       // call, health
void AddAssemblyCommands(CLI::App& app, Session& session);  // assembly import|list|show|delete …
void AddCatalogCommands(CLI::App& app, Session& session);   // catalog import|list|show|delete …
void AddAnalyzeCommand(CLI::App& app, Session& session);    // analyze
void AddParetoCommands(CLI::App& app, Session& session);  // pareto run|show|describe|pick|benchmark
void AddParetoBenchmarkCommand(CLI::App& pareto, Session& session);  // of those
void AddParetoDescribeCommand(CLI::App& pareto, Session& session);   // of those
void AddParetoExploreCommands(CLI::App& pareto, Session& session);   // of those
void AddPlanCommand(CLI::App& app, Session& session);                // plan
void AddFabCommands(CLI::App& app, Session& session);        // fab release|watch|show|hold|resume
void AddOperationCommands(CLI::App& app, Session& session);  // operations list|show|watch|cancel
void AddEventsCommand(CLI::App& app, Session& session);      // events
void AddDemoCommand(CLI::App& app, Session& session);        // demo
void AddCompletionCommand(CLI::App& app, Session& session);  // completion

}  // namespace mortise::cli
