#include "cli/client/program.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/client/output.h"
#include "cli/words/file_commands.h"
#include "cli/words/unknown_words.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

// What is wrong with words that name no command to run: first of all those that nobody knows.
// Without them others may be missing, of which CLI11 tells then.
std::string FaultOf(const CLI::App& app, const CLI::ParseError& error,
                    const std::vector<std::string>& arguments) {
  const int code = error.get_exit_code();
  const bool may_be_unknown = code == static_cast<int>(CLI::ExitCodes::ExtrasError) ||
                              code == static_cast<int>(CLI::ExitCodes::RequiredError);
  return may_be_unknown ? UnknownWords(app, arguments) : "";
}

// The answer to words that name no command to run. Whether --json was among them may not have been
// parsed yet.
int Answer(const CLI::App& app, const CLI::ParseError& error,
           const std::vector<std::string>& arguments) {
  const bool json = std::ranges::find(arguments, "--json") != arguments.end();
  const std::string unknown = FaultOf(app, error, arguments);
  if (!json && !unknown.empty()) {
    std::cerr << unknown << "\nRun with --help for more information.\n";
    return 2;
  }
  if (!json) return app.exit(error) == 0 ? 0 : 2;
  std::ostringstream text;
  std::ostringstream complaint;
  Output output(Output::Form::kJson);
  if (app.exit(error, text, complaint) == 0) {
    output.Document({{"text", text.str()}});
    return 0;
  }
  output.Failure(InvalidField("arguments", unknown.empty() ? error.what() : unknown));
  return 2;
}

// The command that was parsed, "catalog import", and its arguments that are no options.
struct Parsed {
  std::string command;
  std::vector<std::string> words;
};

Parsed ParsedBy(const CLI::App& app) {
  Parsed parsed;
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    parsed.command += (parsed.command.empty() ? "" : " ") + command->get_name();
  }
  const auto is_argument = [](const CLI::Option* option) { return option->get_positional(); };
  for (const CLI::Option* const argument : command->get_options(is_argument)) {
    parsed.words.insert(parsed.words.end(), argument->results().begin(), argument->results().end());
  }
  return parsed;
}

}  // namespace

int RunProgram(CLI::App& app, Session& session, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return Answer(app, error, {argv + 1, argv + argc});
  }
  Output output(session.json ? Output::Form::kJson : Output::Form::kText);
  const absl::Status status = session.command(session, output);
  if (status.ok()) return 0;
  const Parsed parsed = ParsedBy(app);
  return output.Failure(WithRightCommand(status, parsed.command, parsed.words));
}

}  // namespace mortise::cli
