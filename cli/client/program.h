// A command line from its words to the exit code: what `mortise` and the programs beside it share.
#pragma once

#include "cli/client/session.h"

namespace CLI {
class App;
}

namespace mortise::cli {

// Reads the words, which set `session.command`, and runs that. Returns the exit code: 0, 2 for
// words that are wrong, else what Output::Failure makes of the failure. Help, the version and
// faults are text for people, with --json one document.
int RunProgram(CLI::App& app, Session& session, int argc, char** argv);

}  // namespace mortise::cli
