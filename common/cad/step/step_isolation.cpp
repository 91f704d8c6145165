#include "common/cad/step/step_isolation.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "common/base/isolated_child.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/step/step_assembly_json.h"
#include "common/cad/step/step_reader.h"

namespace mortise::cad {
namespace {

constexpr std::size_t kMaxMemory = std::size_t{4} << 30;  // bytes of addresses
// Of processor time: for none of the designs that ship does the kernel take a twentieth of this.
constexpr std::size_t kMaxSeconds = 6;
constexpr std::size_t kMaxSecondsPerMebibyte = 20;

// What the child writes, a line each: any number of faults, how far it is now and then, then one of
// the others. A line begins with what it is.
constexpr std::string_view kProgress = "progress ";
constexpr std::string_view kFault = "fault ";
constexpr std::string_view kInvalid = "invalid ";
constexpr std::string_view kTooLarge = "too-large ";
constexpr std::string_view kAssembly = "assembly ";

// ---- The child ----------------------------------------------------------------------------------

void WriteLine(std::string_view kind, std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  WriteAnswer(absl::StrCat(absl::string_view(kind.data(), kind.size()), text, "\n"));
}

std::chrono::seconds TimeFor(std::size_t bytes) {
  return std::chrono::seconds(kMaxSeconds + kMaxSecondsPerMebibyte * (bytes >> 10) / 1024);
}

// ---- The parent ---------------------------------------------------------------------------------

bool TakePrefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

// Tells of the lines of an answer that say how far the child is, as they come.
class ProgressLines {
 public:
  explicit ProgressLines(const StepProgress& told) : told_(told) {}

  void Hear(std::string_view piece) {
    for (const char c : piece) {
      if (c == '\n') {
        Tell();
        line_.clear();
      } else if (line_.size() < kLongest) {
        line_ += c;
      }
    }
  }

 private:
  static constexpr std::size_t kLongest = 64;  // of other lines no more than this is looked at

  void Tell() const {
    std::string_view line = line_;
    if (!TakePrefix(line, kProgress)) return;
    const std::vector<std::string> counts = absl::StrSplit(std::string(line), ' ');
    std::size_t done = 0, total = 0;
    const bool is_told = counts.size() == 2 && absl::SimpleAtoi(counts[0], &done) &&
                         absl::SimpleAtoi(counts[1], &total);
    if (is_told) told_(done, total);
  }

  const StepProgress& told_;
  std::string line_;
};

// What the child said in the end; nothing if it said no more than faults, which go to `faults`.
std::optional<absl::StatusOr<StepAssembly>> Understand(const std::string& answer,
                                                       std::string& faults) {
  for (const absl::string_view piece : absl::StrSplit(answer, '\n')) {
    std::string_view line(piece.data(), piece.size());
    if (TakePrefix(line, kFault)) {
      absl::StrAppend(&faults, faults.empty() ? "; " : ", ",
                      absl::string_view(line.data(), line.size()));
    } else if (TakePrefix(line, kInvalid)) {
      return InvalidField("step",
                          absl::StrCat(absl::string_view(line.data(), line.size()), faults));
    } else if (TakePrefix(line, kTooLarge)) {
      return TooLarge("step", line);
    } else if (TakePrefix(line, kAssembly)) {
      return StepAssemblyFromJson(line);
    }
  }
  return std::nullopt;
}

}  // namespace

int RunStepChild() {
  LimitChildMemory(kMaxMemory);
  const std::string bytes = ReadQuestion(kMaxStepBytes);
  LimitChildTime(TimeFor(bytes.size()));
  const absl::StatusOr<StepAssembly> read = ReadStep(
      bytes,
      [](const std::vector<std::string>& faults) {
        for (const std::string& fault : faults) WriteLine(kFault, fault);
      },
      [](std::size_t done, std::size_t total) {
        WriteLine(kProgress, absl::StrCat(done, " ", total));
      });
  if (read.ok()) {
    WriteLine(kAssembly, ToJson(*read));
  } else {
    std::string message(read.status().message());
    const bool is_large = absl::IsResourceExhausted(read.status());
    for (const char* prefix : {"step: ", "step is larger than "}) {
      if (message.starts_with(prefix)) message.erase(0, std::strlen(prefix));
    }
    WriteLine(is_large ? kTooLarge : kInvalid, message);
  }
  // Without destructors: the kernel's, over a damaged file, may crash.
  ::_exit(0);
}

absl::StatusOr<StepAssembly> ReadStepInChild(std::string_view bytes,
                                             const StepChildOptions& options) {
  if (bytes.size() > kMaxStepBytes) return TooLarge("step", "64 MiB");
  ChildOptions child;
  child.program = options.program;
  child.argument = kStepChildArgument;
  child.time_limit = options.time_limit;
  child.is_given_up = options.is_given_up;
  ProgressLines progress(options.progress);
  if (options.progress) {
    child.heard = [&progress](std::string_view piece) { progress.Hear(piece); };
  }
  const absl::StatusOr<ChildAnswer> answer = AskChild(bytes, child);
  if (!answer.ok()) return KernelFailure("reading STEP", std::string(answer.status().message()));
  if (answer->end == ChildAnswer::End::kGivenUp) {
    return absl::CancelledError("nobody waits for the drawing any more");
  }
  if (answer->end == ChildAnswer::End::kAnswerTooLong) {
    return TooLarge("step", "what can be told of it");
  }
  std::string faults;
  auto understood = Understand(answer->bytes, faults);
  const bool in_time = answer->end != ChildAnswer::End::kOutOfTime;
  if (in_time && understood) return *std::move(understood);
  const bool is_slow = in_time && answer->signal == SIGXCPU;
  const auto limit = is_slow ? TimeFor(bytes.size()) : options.time_limit;
  return InvalidField(
      "step",
      absl::StrCat(is_slow || !in_time ? absl::StrCat("cannot be read within ", limit.count(), " s")
                                       : "is damaged: the CAD kernel fails over it",
                   faults));
}

}  // namespace mortise::cad
