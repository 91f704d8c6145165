#include "hwbridge/registers/packml.h"

#include "absl/strings/str_cat.h"

namespace mortise::hwbridge {

std::string PackMlStateName(PackMlState state) {
  switch (state) {
    case PackMlState::kClearing:
      return "CLEARING";
    case PackMlState::kStopped:
      return "STOPPED";
    case PackMlState::kStarting:
      return "STARTING";
    case PackMlState::kIdle:
      return "IDLE";
    case PackMlState::kSuspended:
      return "SUSPENDED";
    case PackMlState::kExecute:
      return "EXECUTE";
    case PackMlState::kStopping:
      return "STOPPING";
    case PackMlState::kAborting:
      return "ABORTING";
    case PackMlState::kAborted:
      return "ABORTED";
    case PackMlState::kHolding:
      return "HOLDING";
    case PackMlState::kHeld:
      return "HELD";
    case PackMlState::kUnholding:
      return "UNHOLDING";
    case PackMlState::kSuspending:
      return "SUSPENDING";
    case PackMlState::kUnsuspending:
      return "UNSUSPENDING";
    case PackMlState::kResetting:
      return "RESETTING";
    case PackMlState::kCompleting:
      return "COMPLETING";
    case PackMlState::kComplete:
      return "COMPLETE";
  }
  return absl::StrCat("STATE_", static_cast<int>(state));
}

bool IsPackMlState(std::uint16_t number) { return number >= 1 && number <= 17; }

bool IsActingState(PackMlState state) {
  return state != PackMlState::kExecute && AfterActing(state) != state;
}

PackMlState AfterActing(PackMlState state) {
  switch (state) {
    case PackMlState::kClearing:
      return PackMlState::kStopped;
    case PackMlState::kStarting:
      return PackMlState::kExecute;
    case PackMlState::kStopping:
      return PackMlState::kStopped;
    case PackMlState::kAborting:
      return PackMlState::kAborted;
    case PackMlState::kHolding:
      return PackMlState::kHeld;
    case PackMlState::kUnholding:
      return PackMlState::kExecute;
    case PackMlState::kSuspending:
      return PackMlState::kSuspended;
    case PackMlState::kUnsuspending:
      return PackMlState::kExecute;
    case PackMlState::kResetting:
      return PackMlState::kIdle;
    case PackMlState::kCompleting:
      return PackMlState::kComplete;
    default:
      return state;
  }
}

PackMlState AfterCommand(PackMlState state, PackMlCommand command) {
  const bool aborted = state == PackMlState::kAborting || state == PackMlState::kAborted;
  const bool stopped = state == PackMlState::kStopping || state == PackMlState::kStopped;
  switch (command) {
    case PackMlCommand::kAbort:
      return aborted ? state : PackMlState::kAborting;
    case PackMlCommand::kStop:
      return aborted || stopped || state == PackMlState::kClearing ? state : PackMlState::kStopping;
    case PackMlCommand::kClear:
      return state == PackMlState::kAborted ? PackMlState::kClearing : state;
    case PackMlCommand::kReset:
      return state == PackMlState::kStopped || state == PackMlState::kComplete
                 ? PackMlState::kResetting
                 : state;
    case PackMlCommand::kStart:
      return state == PackMlState::kIdle ? PackMlState::kStarting : state;
    case PackMlCommand::kHold:
      return state == PackMlState::kExecute ? PackMlState::kHolding : state;
    case PackMlCommand::kUnhold:
      return state == PackMlState::kHeld ? PackMlState::kUnholding : state;
    case PackMlCommand::kSuspend:
      return state == PackMlState::kExecute ? PackMlState::kSuspending : state;
    case PackMlCommand::kUnsuspend:
      return state == PackMlState::kSuspended ? PackMlState::kUnsuspending : state;
  }
  return state;
}

}  // namespace mortise::hwbridge
