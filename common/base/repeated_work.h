// Work that a process does by itself, again and again, on a thread of its own.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace mortise {

class RepeatedWork {
 public:
  // Does `work` at once, and again each time `pause` has passed since it ended, until this is
  // destroyed, which waits for what is being done.
  RepeatedWork(std::chrono::milliseconds pause, std::function<void()> work);

 private:
  std::jthread thread_;
};

}  // namespace mortise
