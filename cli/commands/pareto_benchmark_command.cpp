// mortise pareto benchmark: becomes the program that measures discovery on published problems,
// which holds the discovery itself where this one only asks services.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

constexpr char kProgram[] = "mortise-pareto-benchmark";

// Returns only if the program cannot be run.
absl::Status BecomeBenchmark(std::vector<std::string> words) {
  std::error_code ignored;
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path() / kProgram;
  words.insert(words.begin(), program.string());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  return PreconditionFailed("PROGRAM_MISSING",
                            absl::StrCat(program.string(), ": ", std::strerror(errno),
                                         "; ./dev build ", kProgram, " makes it"));
}

}  // namespace

void AddParetoBenchmarkCommand(CLI::App& pareto, Session& session) {
  CLI::App* benchmark = pareto.add_subcommand(
      "benchmark", "Measure discovery on a published problem; --help lists its options");
  benchmark->set_help_flag();
  benchmark->fallthrough(false);
  benchmark->prefix_command();
  benchmark->callback([&session, benchmark] {
    session.command = [words = benchmark->remaining()](Session& global, Output&) {
      std::vector<std::string> all = words;
      if (global.json) all.insert(all.begin(), "--json");
      return BecomeBenchmark(std::move(all));
    };
  });
}

}  // namespace mortise::cli
