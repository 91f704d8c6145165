#include "cli/commands/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "cli/client/decimal_flags.h"
#include "cli/commands/commands.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

constexpr const char* kConnectionFlags[] = {"--gateway", "--token-file", "--authority", "--house"};

// Refuses the flags of a connection where the command makes none: a house that is started on
// another folder than the one that was named is worse than none.
void RefuseUnusedConnection(const CLI::App& app) {
  for (const char* const command : {"up", "down", "keys", "demo", "completion"}) {
    if (!app.got_subcommand(command)) continue;
    const bool has_state = app.get_subcommand(command)->get_option_no_throw("--state") != nullptr;
    for (const std::string flag : kConnectionFlags) {
      if (app.get_option(flag)->count() == 0) continue;
      const bool is_house = flag == "--house";
      if (is_house && has_state && std::string(command) != "up") continue;  // the same as --state
      throw CLI::ValidationError(
          flag, absl::StrCat("mortise ", command, " does not use it",
                             is_house && has_state ? "; name the folder by --state" : ""));
    }
  }
}

}  // namespace

void BuildCommandLine(CLI::App& app, Session& session) {
  app.name("mortise");
  app.set_version_flag("--version", "mortise 0.1.0");
  app.require_subcommand(1);
  app.fallthrough();
  app.add_flag("--json", session.json, "Print exactly one JSON document on standard output");
  app.add_option("--gateway", session.gateway.address,
                 "Gateway, host:port [MORTISE_GATEWAY; else the house on --house]");
  app.add_option("--token-file", session.gateway.token_file,
                 "File with a bearer token [MORTISE_TOKEN]");
  app.add_option("--authority", session.gateway.authority,
                 "PEM file of the certificate authority to trust [MORTISE_CA]");
  app.add_option("--house", session.gateway.state, "State folder of a house on this machine")
      ->capture_default_str();
  AddHouseCommands(app, session);
  AddDemoCommand(app, session);
  AddCatalogCommands(app, session);
  AddAssemblyCommands(app, session);
  AddAnalyzeCommand(app, session);
  AddParetoCommands(app, session);
  AddMapCommands(app, session);
  AddPlanCommand(app, session);
  AddFabCommands(app, session);
  AddListCommand(app, session);
  AddFindCommand(app, session);
  AddLabelCommand(app, session);
  AddComposeCommands(app, session);
  AddRetrievalCommands(app, session);
  AddOperationCommands(app, session);
  AddEventsCommand(app, session);
  AddCallCommand(app, session);
  AddCompletionCommand(app, session);
  RequireDecimalNumbers(app);
  app.parse_complete_callback([&app] { RefuseUnusedConnection(app); });
  // Last: commands would inherit it.
  app.footer("Example: mortise up --insecure-development, then in another shell: mortise status");
}

absl::Status RunCommandLine(const std::vector<std::string>& arguments, const Session& session,
                            Output& output) {
  CLI::App app;
  Session own = session;
  BuildCommandLine(app, own);
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    app.parse(std::move(reversed));
  } catch (const CLI::ParseError& error) {
    return InvalidField("arguments", error.what());
  }
  return own.command(own, output);
}

}  // namespace mortise::cli
