// Time as the bridge sees it, so that tests can let hours pass in no time.
#pragma once

#include <chrono>

namespace mortise::hwbridge {

class Clock {
 public:
  virtual ~Clock() = default;

  // Seconds since some fixed moment; never goes back.
  virtual double Now() const = 0;
};

class MonotonicClock : public Clock {
 public:
  double Now() const override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }
};

}  // namespace mortise::hwbridge
