// mortise compose check: will a model stand and hold?
#pragma once

#include <CLI/CLI.hpp>

#include "cli/client/session.h"

namespace mortise::cli {

// `compose` is the group of commands that it belongs to; both outlive what is declared.
void AddComposeCheckCommand(CLI::App& compose, Session& session);

}  // namespace mortise::cli
