#include "common/cad/step/step_isolation.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

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

// What the child writes, a line each: any number of faults, then one of the others. A line begins
// with what it is.
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
  const absl::StatusOr<StepAssembly> read =
      ReadStep(bytes, [](const std::vector<std::string>& faults) {
        for (const std::string& fault : faults) WriteLine(kFault, fault);
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
  const absl::StatusOr<ChildAnswer> answer = AskChild(bytes, child);
  if (!answer.ok()) return KernelFailure("reading STEP", std::string(answer.status().message()));
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
