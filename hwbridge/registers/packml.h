// The states and commands of PackML (ISA-TR88.00.02), by the standard's names and numbers.
#pragma once

#include <cstdint>
#include <string>

namespace mortise::hwbridge {

// The 17 states. Names ending in -ing are passed through by themselves; the others wait.
enum class PackMlState : std::uint16_t {
  kClearing = 1,
  kStopped = 2,
  kStarting = 3,
  kIdle = 4,
  kSuspended = 5,
  kExecute = 6,
  kStopping = 7,
  kAborting = 8,
  kAborted = 9,
  kHolding = 10,
  kHeld = 11,
  kUnholding = 12,
  kSuspending = 13,
  kUnsuspending = 14,
  kResetting = 15,
  kCompleting = 16,
  kComplete = 17,
};

enum class PackMlCommand : std::uint16_t {
  kReset = 1,
  kStart = 2,
  kStop = 3,
  kHold = 4,
  kUnhold = 5,
  kSuspend = 6,
  kUnsuspend = 7,
  kAbort = 8,
  kClear = 9,
};

// "EXECUTE", "HELD", …; "STATE_99" for a number the standard does not have.
std::string PackMlStateName(PackMlState state);

// Whether `number` is one of the 17 states.
bool IsPackMlState(std::uint16_t number);

// Whether the machine leaves `state` by itself.
bool IsActingState(PackMlState state);

// The state that `command` leads to from `state` (an acting one), or `state` itself where the
// standard gives the command no meaning there.
PackMlState AfterCommand(PackMlState state, PackMlCommand command);

// The waiting state (or Execute) that follows an acting state; `state` itself if it waits.
PackMlState AfterActing(PackMlState state);

}  // namespace mortise::hwbridge
