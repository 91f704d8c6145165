#include "common/base/isolated_child.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

extern char** environ;

namespace mortise {
namespace {

constexpr std::chrono::milliseconds kPauseBetweenQuestions{200};  // whether somebody still waits

// A file descriptor that is closed with this object.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { ::close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  const int number_;
};

// A running child and the socket by which it is asked and answers.
class Child {
 public:
  static absl::StatusOr<Child> Start(const ChildOptions& options) {
    std::array<int, 2> pair = {-1, -1};
    // A socket, because writing to one whose reader is gone can be told not to raise a signal.
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()) != 0) {
      return absl::InternalError(std::strerror(errno));
    }
    Child child;
    child.socket_ = pair[0];
    const Descriptor theirs(pair[1]);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, theirs.number(), STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, theirs.number(), STDOUT_FILENO);
    ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    std::string name = options.program, argument = options.argument;
    std::array<char*, 3> arguments = {name.data(), argument.data(), nullptr};
    const int failed = ::posix_spawn(&child.pid_, options.program.c_str(), &actions, nullptr,
                                     arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) {
      child.pid_ = -1;
      return absl::InternalError(absl::StrCat(options.program, ": ", std::strerror(failed)));
    }
    return child;
  }

  Child(Child&& other) noexcept
      : pid_(std::exchange(other.pid_, -1)), socket_(std::exchange(other.socket_, -1)) {}
  ~Child() {
    if (socket_ >= 0) ::close(socket_);
    End();
  }

  // Ends the child if it has not ended, and says by which signal it did. A child that is ending
  // already, because it has answered or its time is up, ends as it would have.
  int End() {
    if (pid_ < 0) return 0;
    ::kill(pid_, SIGKILL);
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0) {
      if (errno != EINTR) break;
    }
    pid_ = -1;
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  }

  ChildAnswer Converse(std::string_view question, const ChildOptions& options) {
    const auto end = std::chrono::steady_clock::now() + options.time_limit;
    ChildAnswer answer;
    ::fcntl(socket_, F_SETFL, O_NONBLOCK);
    if (question.empty()) ::shutdown(socket_, SHUT_WR);
    for (;;) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
          end - std::chrono::steady_clock::now());
      if (left.count() <= 0) {
        answer.end = ChildAnswer::End::kOutOfTime;
        return answer;
      }
      if (options.is_given_up && options.is_given_up()) {
        answer.end = ChildAnswer::End::kGivenUp;
        return answer;
      }
      pollfd state = {socket_, POLLIN, 0};
      if (!question.empty()) state.events |= POLLOUT;
      const auto wait = options.is_given_up ? std::min(left, kPauseBetweenQuestions) : left;
      ::poll(&state, 1, static_cast<int>(wait.count()));
      if ((state.revents & POLLOUT) != 0) Send(question);
      if ((state.revents & (POLLIN | POLLHUP | POLLERR)) == 0) continue;
      const std::size_t before = answer.bytes.size();
      if (!Receive(answer.bytes)) {
        answer.signal = End();
        return answer;
      }
      if (options.heard) options.heard(std::string_view(answer.bytes).substr(before));
      if (answer.bytes.size() > options.max_answer) {
        answer.end = ChildAnswer::End::kAnswerTooLong;
        return answer;
      }
    }
  }

 private:
  Child() = default;

  void Send(std::string_view& question) {
    const ssize_t count = ::send(socket_, question.data(), question.size(), MSG_NOSIGNAL);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
    // What cannot be sent any more is not waited for: the child has ended, or will.
    question.remove_prefix(count < 0 ? question.size() : static_cast<std::size_t>(count));
    if (question.empty()) ::shutdown(socket_, SHUT_WR);
  }

  // False once the child has closed its end.
  bool Receive(std::string& answer) {
    std::array<char, 65536> piece;
    const ssize_t count = ::recv(socket_, piece.data(), piece.size(), 0);
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    answer.append(piece.data(), static_cast<std::size_t>(count));
    return count > 0;
  }

  pid_t pid_ = -1;
  int socket_ = -1;
};

void Limit(__rlimit_resource resource, rlim_t soft, rlim_t hard) {
  const rlimit limit = {soft, hard};
  ::setrlimit(resource, &limit);
}

}  // namespace

absl::StatusOr<ChildAnswer> AskChild(std::string_view question, const ChildOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(Child child, Child::Start(options));
  return child.Converse(question, options);
}

void LimitChildMemory([[maybe_unused]] std::size_t bytes) {
#ifndef __SANITIZE_ADDRESS__
  Limit(RLIMIT_AS, bytes, bytes);
#endif
  Limit(RLIMIT_CORE, 0, 0);
}

std::size_t MappedMemory() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void LimitChildTime(std::chrono::seconds limit) {
  const auto seconds = static_cast<rlim_t>(limit.count());
  Limit(RLIMIT_CPU, seconds, seconds + 1);
}

std::string ReadQuestion(std::size_t limit) {
  std::string bytes;
  std::array<char, 65536> piece;
  while (bytes.size() <= limit) {
    const ssize_t count = ::read(STDIN_FILENO, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    bytes.append(piece.data(), static_cast<std::size_t>(count));
  }
  return bytes;
}

void WriteAnswer(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace mortise
