// `mortise`: launcher of a house and client of its gateway.
#include <CLI/CLI.hpp>

#include "cli/command_line.h"

int main(int argc, char** argv) {
  CLI::App app("Computational design for manufacturing: explore, check, plan and build designs");
  mortise::cli::Session session;
  mortise::cli::BuildCommandLine(app, session);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  using mortise::cli::Output;
  Output output(session.json ? Output::Form::kJson : Output::Form::kText);
  const absl::Status status = session.command(session, output);
  return status.ok() ? 0 : output.Failure(status);
}
