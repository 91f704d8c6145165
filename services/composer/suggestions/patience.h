// How long trials may go on, so that whoever waits gets an answer with what was tried.
#pragma once

#include <functional>

#include "absl/time/time.h"

namespace mortise::composer {

// Of one thread. Without a deadline there is always time.
class Patience {
 public:
  // `deadline` is when the caller stops waiting, InfiniteFuture if never, and `now` tells the time.
  // A tenth of what is left now, 0.05 s at least, is kept for telling what was found.
  Patience(absl::Time deadline, std::function<absl::Time()> now);

  // Whether there is time for one more trial that takes as long as the longest so far.
  bool HasTimeForTrial() const;

  // Whether all that is left is kept for telling.
  bool IsOver() const;

  // Runs a trial, and remembers how long it took.
  void Try(const std::function<void()>& trial);

 private:
  std::function<absl::Time()> now_;
  absl::Time end_;  // of work
  absl::Duration longest_ = absl::ZeroDuration();
};

}  // namespace mortise::composer
