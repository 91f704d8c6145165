// The grammar of `mortise`: global options and every command.
#pragma once

#include <string>
#include <vector>

#include "cli/client/output.h"
#include "cli/client/session.h"

namespace CLI {
class App;
}

namespace mortise::cli {

// Adds the global options and all commands to `app`.
void BuildCommandLine(CLI::App& app, Session& session);

// Runs one command given as arguments ("catalog", "list") against the gateway of `session`, as if
// typed at a shell; what it made is in output.last_document(). INVALID_ARGUMENT for a wrong command
// line.
absl::Status RunCommandLine(const std::vector<std::string>& arguments, const Session& session,
                            Output& output);

}  // namespace mortise::cli
