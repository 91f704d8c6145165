// mortise compose bill|suggest: what a model is made of, and what might come next.
#pragma once

#include <CLI/CLI.hpp>

#include "cli/client/session.h"

namespace mortise::cli {

// `compose` is the group of commands that they belong to; both outlive what is declared.
void AddComposeBillCommand(CLI::App& compose, Session& session);
void AddComposeSuggestCommand(CLI::App& compose, Session& session);

}  // namespace mortise::cli
