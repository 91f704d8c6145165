// Ends work that nobody wants any more.
#pragma once

#include <stop_token>

#include "absl/status/status.h"

namespace mortise::simulator {

// Fails with CANCELLED once a stop is requested. Steps that take long ask it before they begin, and
// iterations each time round; what a library does in one call goes on to its end.
inline absl::Status CheckStopped(const std::stop_token& stop) {
  return stop.stop_requested() ? absl::CancelledError("the evaluation was stopped")
                               : absl::OkStatus();
}

}  // namespace mortise::simulator
