#include "tests/e2e/command.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/base/identifiers.h"

namespace mortise::e2e {
namespace {

std::string Program() {
  const char* folder = std::getenv("MORTISE_BIN_DIR");
  return std::string(folder == nullptr ? "bin" : folder) + "/mortise";
}

int Start(const std::vector<std::string>& arguments, const std::string& out,
          const std::string& error) {
  std::vector<std::string> command = {Program()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& argument : command) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const int pid = ::fork();
  if (pid != 0) return pid;
  const int out_file = ::open(out.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  const int error_file = ::open(error.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  ::dup2(out_file, STDOUT_FILENO);
  ::dup2(error_file, STDERR_FILENO);
  ::execv(argv[0], argv.data());
  ::_exit(127);
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

}  // namespace

CommandResult Mortise(const std::vector<std::string>& arguments) {
  const std::string stem =
      (std::filesystem::temp_directory_path() / ("mortise-command-" + NewIdentifier())).string();
  CommandResult result;
  result.exit_code = Collect(Start(arguments, stem + ".out", stem + ".err"));
  result.out = TakeFile(stem + ".out");
  result.error = TakeFile(stem + ".err");
  return result;
}

BackgroundCommand::BackgroundCommand(const std::vector<std::string>& arguments,
                                     const std::string& log)
    : pid_(Start(arguments, log, log)) {}

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

}  // namespace mortise::e2e
