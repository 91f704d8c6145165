#include "cli/client/ending_signals.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <string>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

constexpr std::array<int, 2> kSignals = {SIGINT, SIGTERM};
constexpr char kEnd = 0;
constexpr char kSignalPayload[] = "mortise.cli/signal";

// The writing end of the pipe. A handler has nothing but globals to find it by.
std::atomic<int> handler_pipe = -1;

void PassOn(int signal) {
  const int error = errno;
  const char byte = static_cast<char>(signal);
  // A full pipe holds more signals than anybody counts.
  if (::write(handler_pipe, &byte, 1) < 0) {
  }
  errno = error;
}

}  // namespace

EndingSignals::EndingSignals(std::function<void(int, int)> told) : told_(std::move(told)) {
  if (::pipe2(pipe_.data(), O_CLOEXEC) != 0) return;
  outer_ = handler_pipe.exchange(pipe_[1]);
  thread_ = std::thread([this] { Listen(); });
  struct sigaction action = {};
  action.sa_handler = PassOn;
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    ::sigaction(kSignals[i], nullptr, &before_[i]);
    if (before_[i].sa_handler != SIG_IGN) ::sigaction(kSignals[i], &action, nullptr);
  }
}

EndingSignals::~EndingSignals() {
  if (!thread_.joinable()) return;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    ::sigaction(kSignals[i], &before_[i], nullptr);
  }
  handler_pipe = outer_;
  while (::write(pipe_[1], &kEnd, 1) < 0 && errno == EINTR) {
  }
  thread_.join();
  ::close(pipe_[0]);
  ::close(pipe_[1]);
}

void EndingSignals::Listen() {
  int count = 0;
  while (true) {
    char byte = kEnd;
    const ssize_t size = ::read(pipe_[0], &byte, 1);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0 || byte == kEnd) return;
    told_(byte, ++count);
  }
}

absl::Status Interrupted(int signal, std::string_view message, std::string_view subject) {
  absl::Status status =
      WithDetail(absl::CancelledError(absl::string_view(message.data(), message.size())),
                 {"INTERRUPTED", std::string(subject)});
  status.SetPayload(kSignalPayload, absl::Cord(absl::StrCat(signal)));
  return status;
}

int ExitCodeOf(const absl::Status& failure) {
  const auto payload = failure.GetPayload(kSignalPayload);
  int signal = 0;
  if (!payload || !absl::SimpleAtoi(std::string(*payload), &signal)) return 1;
  return 128 + signal;
}

}  // namespace mortise::cli
