// mortise compose new|list: models begun, and those that there are.
#pragma once

#include <CLI/CLI.hpp>

#include "cli/client/session.h"

namespace mortise::cli {

// `compose` is the group of commands that they belong to; both outlive what is declared.
void AddComposeNewAndList(CLI::App& compose, Session& session);

}  // namespace mortise::cli
