// Attempts work in a copy of this process, which may crash or come to no end: this process goes on,
// and knows how it ended.
//
// For the kernel, which crashes over some of what is in memory already. isolated_child.h starts a
// program anew and sends it what to do, which suits files; a copy needs no message and takes some
// milliseconds.
#pragma once

#include <chrono>
#include <functional>

#include "absl/status/statusor.h"

namespace mortise::cad {

enum class AttemptEnd {
  kDone,       // the work returned true
  kRefused,    // it returned false, or threw
  kCrashed,    // it ended the copy
  kOutOfTime,  // the copy was ended, because its time was over
};

// Forks, runs `work` in the copy, waits for it, and returns how it ended. What the work changes is
// lost with the copy. `limit` is of processor time; by the clock the copy has ten times as much, as
// a busy machine is no fault of the work. Any number of threads may attempt something at once.
//
// The copy has the calling thread only: the work must not wait for others. A lock that another
// thread holds while the process is copied stays locked in the copy, which is then out of time.
//
// INTERNAL if no process can be made.
absl::StatusOr<AttemptEnd> AttemptInCopy(const std::function<bool()>& work,
                                         std::chrono::seconds limit);

}  // namespace mortise::cad
