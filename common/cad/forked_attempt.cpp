#include "common/cad/forked_attempt.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace mortise::cad {
namespace {

// By how much longer than its processor time a copy may take on a busy machine.
constexpr unsigned kPatience = 10;

// What the copy ends with. No crash does: sanitizers end a process that they find fault with by 1.
constexpr int kDoneCode = 40;
constexpr int kRefusedCode = 41;

// In the copy: so that it neither outlives its parent, nor leaves a core file, nor speaks where the
// parent does, nor runs the parent's handlers when it crashes.
void Confine(std::chrono::seconds limit) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core = {0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const auto seconds = static_cast<rlim_t>(limit.count());
  const rlimit time = {seconds, seconds + 1};
  ::setrlimit(RLIMIT_CPU, &time);
  // What asks the parent to end does not ask its copy, which is waited for.
  for (const int ignored : {SIGINT, SIGTERM}) ::signal(ignored, SIG_IGN);
  for (const int fatal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM, SIGXCPU}) {
    ::signal(fatal, SIG_DFL);
  }
  sigset_t timing;
  ::sigemptyset(&timing);
  ::sigaddset(&timing, SIGALRM);
  ::sigaddset(&timing, SIGXCPU);
  ::pthread_sigmask(SIG_UNBLOCK, &timing, nullptr);
  ::alarm(kPatience * static_cast<unsigned>(seconds));
  const int nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
}

[[noreturn]] void RunAsCopy(const std::function<bool()>& work, std::chrono::seconds limit) {
  Confine(limit);
  bool done = false;
  try {
    done = work();
  } catch (...) {
    done = false;
  }
  // Without destructors: they are the parent's to run.
  ::_exit(done ? kDoneCode : kRefusedCode);
}

AttemptEnd EndOf(int status) {
  if (WIFEXITED(status)) {
    if (WEXITSTATUS(status) == kDoneCode) return AttemptEnd::kDone;
    return WEXITSTATUS(status) == kRefusedCode ? AttemptEnd::kRefused : AttemptEnd::kCrashed;
  }
  const int signal = WTERMSIG(status);
  return signal == SIGALRM || signal == SIGXCPU || signal == SIGKILL ? AttemptEnd::kOutOfTime
                                                                     : AttemptEnd::kCrashed;
}

}  // namespace

absl::StatusOr<AttemptEnd> AttemptInCopy(const std::function<bool()>& work,
                                         std::chrono::seconds limit) {
  const pid_t copy = ::fork();
  if (copy < 0) {
    return absl::InternalError(absl::StrCat("no process can be made: ", std::strerror(errno)));
  }
  if (copy == 0) RunAsCopy(work, limit);
  int status = 0;
  while (::waitpid(copy, &status, 0) < 0) {
    if (errno == EINTR) continue;
    return absl::InternalError(absl::StrCat("a copy of the process: ", std::strerror(errno)));
  }
  return EndOf(status);
}

}  // namespace mortise::cad
