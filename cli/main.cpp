// `mortise`: launcher of a house and client of its gateway.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "cli/command_line.h"
#include "common/base/errors.h"

namespace {

using mortise::cli::Output;

// Help, the version, or what is wrong with the command line: text for people, with --json (which
// may not have been parsed yet) one document.
int Answer(const CLI::App& app, const CLI::ParseError& error, bool json) {
  if (!json) return app.exit(error) == 0 ? 0 : 2;
  std::ostringstream text;
  std::ostringstream complaint;
  Output output(Output::Form::kJson);
  if (app.exit(error, text, complaint) == 0) {
    output.Document({{"text", text.str()}});
    return 0;
  }
  output.Failure(mortise::InvalidField("arguments", error.what()));
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Computational design for manufacturing: explore, check, plan and build designs");
  mortise::cli::Session session;
  mortise::cli::BuildCommandLine(app, session);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool json = std::any_of(argv + 1, argv + argc, [](const char* argument) {
      return std::string_view(argument) == "--json";
    });
    return Answer(app, error, json);
  }
  Output output(session.json ? Output::Form::kJson : Output::Form::kText);
  const absl::Status status = session.command(session, output);
  return status.ok() ? 0 : output.Failure(status);
}
