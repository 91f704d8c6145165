#include "cli/client/program.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "cli/client/output.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

// The answer to words that name no command to run. Whether --json was among them may not have been
// parsed yet.
int Answer(const CLI::App& app, const CLI::ParseError& error, bool json) {
  if (!json) return app.exit(error) == 0 ? 0 : 2;
  std::ostringstream text;
  std::ostringstream complaint;
  Output output(Output::Form::kJson);
  if (app.exit(error, text, complaint) == 0) {
    output.Document({{"text", text.str()}});
    return 0;
  }
  output.Failure(InvalidField("arguments", error.what()));
  return 2;
}

}  // namespace

int RunProgram(CLI::App& app, Session& session, int argc, char** argv) {
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

}  // namespace mortise::cli
