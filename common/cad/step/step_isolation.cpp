#include "common/cad/step/step_isolation.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/step/step_assembly_json.h"
#include "common/cad/step/step_reader.h"

extern char** environ;

namespace mortise::cad {
namespace {

constexpr rlim_t kMaxMemory = rlim_t{4} << 30;  // bytes of addresses
// Of processor time: for none of the designs that ship does the kernel take a twentieth of this.
constexpr rlim_t kMaxSeconds = 6;
constexpr rlim_t kMaxSecondsPerMebibyte = 20;

// What the child writes, a line each: any number of faults, then one of the others. A line begins
// with what it is.
constexpr std::string_view kFault = "fault ";
constexpr std::string_view kInvalid = "invalid ";
constexpr std::string_view kTooLarge = "too-large ";
constexpr std::string_view kAssembly = "assembly ";

class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor() { Close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  void Close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

// ---- The child ----------------------------------------------------------------------------------

std::string ReadAll(int descriptor) {
  std::string bytes;
  std::array<char, 65536> piece;
  while (bytes.size() <= kMaxStepBytes) {
    const ssize_t count = ::read(descriptor, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    bytes.append(piece.data(), static_cast<std::size_t>(count));
  }
  return bytes;
}

void WriteLine(int descriptor, std::string_view kind, std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  const std::string line = absl::StrCat(absl::string_view(kind.data(), kind.size()), text, "\n");
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t count = ::write(descriptor, line.data() + done, line.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;
    done += static_cast<std::size_t>(count);
  }
}

rlim_t SecondsFor(std::size_t bytes) {
  return kMaxSeconds + kMaxSecondsPerMebibyte * (bytes >> 10) / 1024;
}

// So that a child does not fill the machine.
void LimitMemory() {
#ifndef __SANITIZE_ADDRESS__  // which reserves addresses without end
  const rlimit memory = {kMaxMemory, kMaxMemory};
  ::setrlimit(RLIMIT_AS, &memory);
#endif
  const rlimit core = {0, 0};
  ::setrlimit(RLIMIT_CORE, &core);
}

// So that a child does not outlast a parent that was killed, nor what is worth waiting for. Of
// processor time, so that a file is not refused because the machine is busy.
void LimitTime(std::size_t bytes) {
  const rlimit time = {SecondsFor(bytes), SecondsFor(bytes) + 1};
  ::setrlimit(RLIMIT_CPU, &time);
}

// ---- The parent ---------------------------------------------------------------------------------

// A running child and the two ends of what it is told and tells.
class Child {
 public:
  static absl::StatusOr<Child> Start(const std::string& program) {
    std::array<int, 2> pair = {-1, -1};
    // A socket, because writing to one whose reader is gone can be told not to raise a signal.
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()) != 0) {
      return KernelFailure("reading STEP", std::strerror(errno));
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
    std::string name = program, argument = kStepChildArgument;
    std::array<char*, 3> arguments = {name.data(), argument.data(), nullptr};
    const int failed =
        ::posix_spawn(&child.pid_, program.c_str(), &actions, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) {
      child.pid_ = -1;
      return KernelFailure("reading STEP", absl::StrCat(program, ": ", std::strerror(failed)));
    }
    return child;
  }

  Child(Child&& other) noexcept
      : pid_(std::exchange(other.pid_, -1)), socket_(std::exchange(other.socket_, -1)) {}
  ~Child() {
    if (socket_ >= 0) ::close(socket_);
    if (pid_ < 0) return;
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

  // Once the child has closed its end: whether it was ended because its time was up.
  bool WasTooSlow() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0) {
      if (errno != EINTR) return false;
    }
    pid_ = -1;
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU;
  }

  // All that the child says to `bytes` until it ends, or the time is up (`in_time` false then).
  std::string Converse(std::string_view bytes, std::chrono::seconds limit, bool& in_time) {
    const auto end = std::chrono::steady_clock::now() + limit;
    std::string answer;
    ::fcntl(socket_, F_SETFL, O_NONBLOCK);
    in_time = true;
    if (bytes.empty()) ::shutdown(socket_, SHUT_WR);
    for (;;) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
          end - std::chrono::steady_clock::now());
      if (left.count() <= 0) {
        in_time = false;
        return answer;
      }
      pollfd state = {socket_, POLLIN, 0};
      if (!bytes.empty()) state.events |= POLLOUT;
      ::poll(&state, 1, static_cast<int>(left.count()));
      if ((state.revents & POLLOUT) != 0) Send(bytes);
      if ((state.revents & (POLLIN | POLLHUP | POLLERR)) != 0 && !Receive(answer)) return answer;
    }
  }

 private:
  Child() = default;

  void Send(std::string_view& bytes) {
    const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
    // What cannot be sent any more is not waited for: the child has ended, or will.
    bytes.remove_prefix(count < 0 ? bytes.size() : static_cast<std::size_t>(count));
    if (bytes.empty()) ::shutdown(socket_, SHUT_WR);
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

bool TakePrefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

// What the child said in the end; nothing if it said no more than faults, which go to `faults`.
std::optional<absl::StatusOr<StepAssembly>> Understand(const std::string& answer,
                                                       std::string& faults) {
  for (const absl::string_view piece : absl::StrSplit(answer, '\n')) {
    std::string_view line(piece.data(), piece.size());
    if (TakePrefix(line, kFault)) {
      absl::StrAppend(&faults, faults.empty() ? "; " : ", ",
                      absl::string_view(line.data(), line.size()));
    } else if (TakePrefix(line, kInvalid)) {
      return InvalidField("step",
                          absl::StrCat(absl::string_view(line.data(), line.size()), faults));
    } else if (TakePrefix(line, kTooLarge)) {
      return TooLarge("step", line);
    } else if (TakePrefix(line, kAssembly)) {
      return StepAssemblyFromJson(line);
    }
  }
  return std::nullopt;
}

}  // namespace

int RunStepChild() {
  LimitMemory();
  const std::string bytes = ReadAll(STDIN_FILENO);
  LimitTime(bytes.size());
  const absl::StatusOr<StepAssembly> read =
      ReadStep(bytes, [](const std::vector<std::string>& faults) {
        for (const std::string& fault : faults) WriteLine(STDOUT_FILENO, kFault, fault);
      });
  if (read.ok()) {
    WriteLine(STDOUT_FILENO, kAssembly, ToJson(*read));
  } else {
    std::string message(read.status().message());
    const bool is_large = absl::IsResourceExhausted(read.status());
    for (const char* prefix : {"step: ", "step is larger than "}) {
      if (message.starts_with(prefix)) message.erase(0, std::strlen(prefix));
    }
    WriteLine(STDOUT_FILENO, is_large ? kTooLarge : kInvalid, message);
  }
  // Without destructors: the kernel's, over a damaged file, may crash.
  ::_exit(0);
}

absl::StatusOr<StepAssembly> ReadStepInChild(std::string_view bytes,
                                             const StepChildOptions& options) {
  if (bytes.size() > kMaxStepBytes) return TooLarge("step", "64 MiB");
  MORTISE_ASSIGN_OR_RETURN(Child child, Child::Start(options.program));
  bool in_time = true;
  const std::string answer = child.Converse(bytes, options.time_limit, in_time);
  std::string faults;
  auto understood = Understand(answer, faults);
  if (in_time && understood) return *std::move(understood);
  const bool is_slow = in_time && child.WasTooSlow();
  const auto limit =
      is_slow ? static_cast<long>(SecondsFor(bytes.size())) : options.time_limit.count();
  return InvalidField(
      "step", absl::StrCat(is_slow || !in_time ? absl::StrCat("cannot be read within ", limit, " s")
                                               : "is damaged: the CAD kernel fails over it",
                           faults));
}

}  // namespace mortise::cad
