#include "common/base/process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"

namespace mortise {
namespace {

constexpr auto kBetweenLooks = std::chrono::milliseconds(2);

std::vector<char*> Pointers(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  for (std::string& string : strings) pointers.push_back(string.data());
  pointers.push_back(nullptr);
  return pointers;
}

// Whether a variable of the same name is among `entries`.
bool IsSetIn(const std::vector<std::string>& entries, const std::string& entry) {
  const std::string name = entry.substr(0, entry.find('=') + 1);
  return std::any_of(entries.begin(), entries.end(),
                     [&](const std::string& other) { return other.starts_with(name); });
}

}  // namespace

std::string ProcessEnd::ToString() const {
  return signalled ? absl::StrCat("killed by signal ", code) : absl::StrCat("exit code ", code);
}

std::filesystem::path FindProgram(const std::string& program) {
  const char* const path = std::getenv("PATH");
  for (const absl::string_view folder : absl::StrSplit(path != nullptr ? path : "/usr/bin", ':')) {
    const std::filesystem::path file =
        std::filesystem::path(std::string(folder.empty() ? "." : folder)) / program;
    if (::access(file.c_str(), X_OK) == 0 && !std::filesystem::is_directory(file)) return file;
  }
  return {};
}

absl::StatusOr<pid_t> StartProcess(const std::vector<std::string>& command,
                                   const std::filesystem::path& log,
                                   const std::vector<std::string>& environment) {
  std::error_code error;
  std::filesystem::create_directories(log.parent_path(), error);
  const int log_file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (log_file < 0) return StorageFailed(log.string(), std::strerror(errno));

  // Everything the child needs is made before the fork: after it only system calls are safe.
  std::vector<std::string> arguments = command;
  std::vector<std::string> variables;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    if (!IsSetIn(environment, *entry)) variables.emplace_back(*entry);
  }
  variables.insert(variables.end(), environment.begin(), environment.end());
  const std::vector<char*> argv = Pointers(arguments);
  const std::vector<char*> envp = Pointers(variables);
  const pid_t parent = ::getpid();

  const pid_t pid = ::fork();
  if (pid == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(1);
    // A terminal's Ctrl-C reaches the parent only, which then ends its children in order.
    ::setpgid(0, 0);
    ::dup2(log_file, STDOUT_FILENO);
    ::dup2(log_file, STDERR_FILENO);
    const int null = ::open("/dev/null", O_RDONLY);
    if (null >= 0) ::dup2(null, STDIN_FILENO);
    ::execve(argv[0], argv.data(), envp.data());
    ::_exit(127);
  }
  const int fork_error = errno;
  ::close(log_file);
  if (pid < 0) return absl::InternalError(absl::StrCat("fork: ", std::strerror(fork_error)));
  return pid;
}

std::optional<ProcessEnd> CollectProcess(pid_t pid) {
  int status = 0;
  const pid_t ended = ::waitpid(pid, &status, WNOHANG);
  if (ended == 0) return std::nullopt;
  if (ended < 0) return ProcessEnd{};
  if (WIFSIGNALED(status)) return ProcessEnd{true, WTERMSIG(status)};
  return ProcessEnd{false, WEXITSTATUS(status)};
}

void KillProcess(pid_t pid) {
  ::kill(-pid, SIGKILL);  // its group, of which StartProcess made it the first
  ::kill(pid, SIGKILL);
  while (::waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
  }
}

absl::StatusOr<std::optional<ProcessEnd>> RunProcess(const std::vector<std::string>& command,
                                                     const std::filesystem::path& log,
                                                     std::chrono::milliseconds limit,
                                                     const std::vector<std::string>& environment) {
  const auto latest = std::chrono::steady_clock::now() + limit;
  MORTISE_ASSIGN_OR_RETURN(const pid_t pid, StartProcess(command, log, environment));
  std::optional<ProcessEnd> end;
  while (!(end = CollectProcess(pid))) {
    if (std::chrono::steady_clock::now() >= latest) {
      KillProcess(pid);
      break;
    }
    std::this_thread::sleep_for(kBetweenLooks);
  }
  return end;
}

bool ProcessExists(pid_t pid) { return pid > 0 && (::kill(pid, 0) == 0 || errno == EPERM); }

}  // namespace mortise
