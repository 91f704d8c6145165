#include "tests/e2e/command.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "absl/time/time.h"
#include "cli/launcher/state_folder.h"
#include "common/base/identifiers.h"
#include "tests/support/file_watch.h"

namespace mortise::e2e {
namespace {

std::filesystem::path Programs() {
  const char* folder = std::getenv("MORTISE_BIN_DIR");
  return std::filesystem::absolute(folder == nullptr ? "bin" : folder);
}

int Start(std::vector<std::string> command, const std::string& out, const std::string& error) {
  std::vector<char*> argv;
  for (std::string& argument : command) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const int parent = ::getpid();
  const int pid = ::fork();
  if (pid != 0) return pid;
  // A house must not outlive a test that crashes. It ends its own processes when it is told to end,
  // and they themselves when it is gone.
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(127);  // the test has died already
  const int out_file = ::open(out.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  const int error_file = ::open(error.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  ::dup2(out_file, STDOUT_FILENO);
  ::dup2(error_file, STDERR_FILENO);
  ::execv(argv[0], argv.data());
  ::_exit(127);
}

std::vector<std::string> MortiseCommand(const std::vector<std::string>& arguments) {
  std::vector<std::string> command = {(Programs() / "mortise").string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

std::vector<std::string> ShellCommand(const std::string& script,
                                      const std::filesystem::path& folder) {
  return {"/bin/bash", "-euo", "pipefail", "-c",
          "cd '" + folder.string() + "'\nexport PATH='" + Programs().string() + "':\"$PATH\"\n" +
              script};
}

int Collect(int pid) {
  int status = 0;
  ::waitpid(pid, &status, 0);
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

std::string TakeFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  std::filesystem::remove(path);
  return text;
}

CommandResult Run(const std::vector<std::string>& command) {
  const std::string stem =
      (std::filesystem::temp_directory_path() / ("mortise-command-" + NewIdentifier())).string();
  CommandResult result;
  result.exit_code = Collect(Start(command, stem + ".out", stem + ".err"));
  result.out = TakeFile(stem + ".out");
  result.error = TakeFile(stem + ".err");
  return result;
}

}  // namespace

CommandResult Mortise(const std::vector<std::string>& arguments) {
  return Run(MortiseCommand(arguments));
}

CommandResult Shell(const std::string& script, const std::filesystem::path& folder) {
  return Run(ShellCommand(script, folder));
}

BackgroundCommand::BackgroundCommand(const std::vector<std::string>& arguments,
                                     const std::string& log)
    : pid_(Start(MortiseCommand(arguments), log, log)) {}

std::unique_ptr<BackgroundCommand> BackgroundCommand::InShell(const std::string& command,
                                                              const std::filesystem::path& folder,
                                                              const std::string& log) {
  return std::unique_ptr<BackgroundCommand>(
      new BackgroundCommand(Start(ShellCommand("exec " + command, folder), log, log)));
}

BackgroundCommand::~BackgroundCommand() {
  if (pid_ == 0) return;
  ::kill(pid_, SIGTERM);
  Collect(pid_);
}

int BackgroundCommand::Wait() {
  const int code = Collect(pid_);
  pid_ = 0;
  return code;
}

bool AwaitHouse(const std::filesystem::path& state) {
  std::filesystem::create_directories(state);
  const auto serves = [&state] {
    const auto house = cli::ReadRunningHouse(state);
    return house.ok() && !house->processes.empty() &&
           std::all_of(house->processes.begin(), house->processes.end(),
                       [](const cli::RunningProcess& process) { return process.serving; });
  };
  return testing::WaitForFiles(state, serves, absl::Minutes(1));
}

}  // namespace mortise::e2e
