// Random scripts over all designs that ship: how many steps are done, how many refused and why, how
// long they take, and every violation of what must be true, with its seed.
// random_scripts_bench [--seed FIRST] [--count SCRIPTS] [--steps STEPS] [--parts MOST] [--trace]
#include <cstdint>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_format.h"
#include "tests/unit/services/composer/scripts/random_script.h"

namespace {

using mortise::composer::RandomScriptOptions;
using mortise::composer::ScriptOutcome;

struct Request {
  std::uint64_t seed = 1;
  int count = 20;
  RandomScriptOptions options;
  bool trace = false;  // print the steps of every script
};

bool Parse(const std::vector<std::string>& words, Request* request) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--trace") {
      request->trace = true;
      continue;
    }
    std::uint64_t value = 0;
    if (i + 1 >= words.size() || !absl::SimpleAtoi(words[i + 1], &value)) return false;
    if (words[i] == "--seed") {
      request->seed = value;
    } else if (words[i] == "--count") {
      request->count = static_cast<int>(value);
    } else if (words[i] == "--steps") {
      request->options.steps = static_cast<int>(value);
    } else if (words[i] == "--parts") {
      request->options.most_parts = value;
    } else {
      return false;
    }
    ++i;
  }
  return true;
}

void Add(const ScriptOutcome& outcome, ScriptOutcome* sum) {
  for (const auto& [command, count] : outcome.done) sum->done[command] += count;
  for (const auto& [reason, count] : outcome.refused) sum->refused[reason] += count;
  for (const auto& [command, seconds] : outcome.seconds) sum->seconds[command] += seconds;
  sum->parts += outcome.parts;
  sum->made_connections += outcome.made_connections;
  sum->left_unheld += outcome.left_unheld;
}

void Print(const Request& request, const ScriptOutcome& sum, int faulty) {
  std::cout << absl::StrFormat(
      "%d scripts from seed %d of %d steps; %d with violations; %.1f parts and %.1f connections "
      "with parts each\n",
      request.count, request.seed, request.options.steps, faulty,
      static_cast<double>(sum.parts) / request.count,
      static_cast<double>(sum.made_connections) / request.count);
  for (const auto& [command, count] : sum.done) {
    const auto spent = sum.seconds.find(command);
    std::cout << absl::StrFormat("  %-8s %6d done", command, count);
    if (spent != sum.seconds.end()) std::cout << absl::StrFormat(", %.1f s", spent->second);
    std::cout << "\n";
  }
  std::cout << absl::StrFormat("  %d parts left without a connection by removing others\n",
                               sum.left_unheld);
  for (const auto& [reason, count] : sum.refused) {
    std::cout << absl::StrFormat("  %6d refused, %s\n", count, reason);
  }
}

}  // namespace

int main(int count, char** arguments) {
  Request request;
  if (!Parse({arguments + 1, arguments + count}, &request)) {
    std::cerr << "Usage: random_scripts_bench [--seed FIRST] [--count SCRIPTS] [--steps STEPS] "
                 "[--parts MOST] [--trace]\n";
    return 2;
  }
  ScriptOutcome sum;
  int faulty = 0;
  for (int i = 0; i < request.count; ++i) {
    RandomScriptOptions options = request.options;
    options.seed = request.seed + static_cast<std::uint64_t>(i);
    const ScriptOutcome outcome = mortise::composer::RunRandomScript(options);
    Add(outcome, &sum);
    faulty += outcome.violations.empty() ? 0 : 1;
    for (const std::string& violation : outcome.violations) {
      std::cout << "seed " << options.seed << ", " << violation << std::endl;
    }
    if (!request.trace) continue;
    for (const std::string& step : outcome.steps) std::cout << "  " << step << "\n";
  }
  Print(request, sum, faulty);
  return faulty == 0 ? 0 : 1;
}
