// `mortise`: launcher of a house and client of its gateway.
#include <CLI/CLI.hpp>

#include "cli/client/program.h"
#include "cli/commands/command_line.h"

int main(int argc, char** argv) {
  CLI::App app("Computational design for manufacturing: explore, check, plan and build designs");
  mortise::cli::Session session;
  mortise::cli::BuildCommandLine(app, session);
  return mortise::cli::RunProgram(app, session, argc, argv);
}
