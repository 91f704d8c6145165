// SIGINT (Ctrl-C) and SIGTERM, told to a command while it has something to bring to an end.
#pragma once

#include <signal.h>

#include <array>
#include <functional>
#include <string_view>
#include <thread>

#include "absl/status/status.h"

namespace mortise::cli {

// While it lives, the signals that ask a command to end are told to a function; before and after,
// they do what they did. Of several at a time the last made is told. A signal that this process was
// started to ignore (as by nohup) stays ignored.
class EndingSignals {
 public:
  // `told(signal, count)` runs on a thread of its own, for the first signal with count 1, and so
  // on.
  explicit EndingSignals(std::function<void(int signal, int count)> told);
  ~EndingSignals();
  EndingSignals(const EndingSignals&) = delete;
  EndingSignals& operator=(const EndingSignals&) = delete;

 private:
  void Listen();

  const std::function<void(int, int)> told_;
  std::array<int, 2> pipe_ = {-1, -1};  // from the signals' handler to the thread
  int outer_ = -1;                      // where the handler wrote before
  std::array<struct sigaction, 2> before_ = {};
  std::thread thread_;
};

// CANCELLED, INTERRUPTED: the command ends because of a signal. `subject` names what it had begun.
absl::Status Interrupted(int signal, std::string_view message, std::string_view subject = "");

// Returns what a command that ends with this failure exits with: 128 and the signal where
// Interrupted made it, as shells do; else 1.
int ExitCodeOf(const absl::Status& failure);

}  // namespace mortise::cli
