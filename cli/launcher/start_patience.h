// How long a house may take until all of its processes serve.
#pragma once

#include <chrono>
#include <cstdint>

namespace mortise::cli {

// A machine that is busy with other things may need minutes. As long as the processes get on they
// are waited for, five minutes at most; a minute in which none gets on at all is too long.
class StartPatience {
 public:
  using Clock = std::chrono::steady_clock;

  static constexpr std::chrono::seconds kTellEvery{60};
  static constexpr std::chrono::seconds kMostStill{60};
  static constexpr std::chrono::seconds kMost{300};

  enum class Verdict {
    kWait,    // go on
    kTell,    // go on, and tell whoever waits that it takes long
    kGiveUp,  // nothing has moved for a minute, or five are over
  };

  explicit StartPatience(Clock::time_point begin);

  // Returns what to do at `now`. `progress` is any number that changes while processes get on.
  Verdict Look(Clock::time_point now, std::int64_t progress);

 private:
  Clock::time_point begin_;
  Clock::time_point moved_;  // when the progress last changed
  Clock::time_point told_;
  std::int64_t progress_ = 0;
};

}  // namespace mortise::cli
