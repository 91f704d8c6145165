// Tells how long something took.
#pragma once

#include <chrono>

namespace mortise {

// Returns the seconds since `start`.
inline double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace mortise
