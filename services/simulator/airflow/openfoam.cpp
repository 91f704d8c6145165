#include "services/simulator/airflow/openfoam.h"

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/process.h"
#include "common/fem/linear/stopping.h"

namespace mortise::simulator {
namespace {

constexpr auto kBetweenLooks = std::chrono::milliseconds(50);
constexpr std::size_t kMaxLog = std::size_t{256} << 20;
constexpr std::size_t kMaxWords = 400;  // bytes of OpenFOAM's own

// Tells iterations from a log as it grows: each begins with a line "Time = N".
class IterationReader {
 public:
  explicit IterationReader(const std::filesystem::path& log) : log_(log) {}

  void Tell(StageProgress& progress) {
    log_.clear();
    std::string piece;
    while (std::getline(log_, piece)) {
      line_ += piece;
      if (log_.eof()) break;  // the line goes on
      int iteration = 0;
      if (line_.starts_with("Time = ") && absl::SimpleAtoi(line_.substr(7), &iteration)) {
        progress.Iterate(iteration);
      }
      line_.clear();
    }
  }

 private:
  std::ifstream log_;
  std::string line_;
};

// What OpenFOAM says of its failure, on one line.
std::string FailureIn(const std::filesystem::path& log) {
  const absl::StatusOr<std::string> text = ReadFile(log, kMaxLog);
  if (!text.ok()) return "its log cannot be read";
  std::size_t begin = text->find("--> FOAM FATAL");
  if (begin != std::string::npos) begin = text->find('\n', begin);
  if (begin == std::string::npos) begin = text->size() - std::min(text->size(), kMaxWords);
  std::string words = text->substr(begin, kMaxWords);
  if (const std::size_t end = words.find("\n\n    From "); end != std::string::npos) {
    words.resize(end);
  }
  absl::RemoveExtraAsciiWhitespace(&words);
  return words;
}

absl::Status Failed(const std::string& program, const std::string& how) {
  return WithDetail(absl::InternalError(absl::StrCat("OpenFOAM's ", program, " failed: ", how)),
                    {kOpenFoamFailed, ""});
}

}  // namespace

absl::Status CheckOpenFoam(const std::string& program) {
  if (!FindProgram(program).empty()) return absl::OkStatus();
  return PreconditionFailed(
      kNoOpenFoam,
      absl::StrCat(
          "the flow of air needs OpenFOAM's ", program,
          ", which is not there: install Debian's package 'openfoam' where the worker runs"),
      "airflow");
}

absl::Status RunOpenFoam(const std::string& program, const std::vector<std::string>& arguments,
                         const OpenFoamRun& run) {
  MORTISE_RETURN_IF_ERROR(CheckOpenFoam(program));
  const std::filesystem::path log = run.case_folder / absl::StrCat("log.", program);
  std::vector<std::string> command{FindProgram(program).string(), "-case",
                                   run.case_folder.string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  std::vector<std::string> environment;
  if (std::getenv("WM_PROJECT_DIR") == nullptr) {
    environment.emplace_back(
        "WM_PROJECT_DIR=/usr/share/openfoam");  // Debian's, with its etc folder
  }
  MORTISE_ASSIGN_OR_RETURN(const pid_t pid, StartProcess(command, log, environment));
  IterationReader iterations(log);
  std::optional<ProcessEnd> end;
  while (!(end = CollectProcess(pid))) {
    if (run.progress != nullptr) iterations.Tell(*run.progress);
    if (run.stop.stop_requested()) {
      KillProcess(pid);
      return CheckStopped(run.stop);
    }
    std::this_thread::sleep_for(kBetweenLooks);
  }
  if (end->signalled || end->code != 0) {
    return Failed(program, absl::StrCat(end->ToString(), ": ", FailureIn(log)));
  }
  return absl::OkStatus();
}

}  // namespace mortise::simulator
