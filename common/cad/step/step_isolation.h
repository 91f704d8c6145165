// Reads STEP in a process of its own.
//
// Open CASCADE follows references that are not there when a file is damaged: every third file with
// one character changed ends the process that reads it. So a service reads what strangers send in
// a child, started from its own program, with limits of time and memory, and outlives it.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "common/cad/step/step_assembly.h"
#include "common/cad/step/step_reader.h"

namespace mortise::cad {

// The argument that makes a program a child: its main() returns RunStepChild() if this is the first
// argument.
inline constexpr char kStepChildArgument[] = "--read-step-for-parent";

// Reads a STEP file from standard input and writes what ReadStep makes of it to standard output.
int RunStepChild();

struct StepChildOptions {
  std::string program = "/proc/self/exe";  // whose main() knows kStepChildArgument
  std::chrono::seconds time_limit{120};
  StepProgress progress = {};              // what the child has read, as ReadStep tells it
  std::function<bool()> is_given_up = {};  // asked several times a second; unset: never
};

// Reads as ReadStep does, but without the solids. INVALID_ARGUMENT, "step", also for a file over
// which the kernel crashes or that takes it longer than the limit, or more than 6 s of processor
// time and 20 s for each MiB of the file, with the entities at fault if any are known; INTERNAL if
// the child cannot be started; CANCELLED soon after `is_given_up`. Any number of children may run
// at once.
absl::StatusOr<StepAssembly> ReadStepInChild(std::string_view bytes,
                                             const StepChildOptions& options = {});

}  // namespace mortise::cad
