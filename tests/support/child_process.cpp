#include "tests/support/child_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pwd.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"

namespace mortise::testing {
namespace {

std::system_error SystemError(const std::string& doing) {
  return std::system_error(errno, std::generic_category(), doing);
}

// What the child needs between fork and exec, where nothing may be allocated.
struct Launch {
  char** arguments;
  const passwd* user;  // null: as the test
  int output;
  pid_t parent;
};

[[noreturn]] void RunChild(const Launch& launch) {
  if (launch.user != nullptr &&
      (::setgid(launch.user->pw_gid) != 0 || ::setuid(launch.user->pw_uid) != 0)) {
    ::_exit(127);
  }
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != launch.parent) ::_exit(127);  // the test has died already
  ::dup2(launch.output, STDOUT_FILENO);
  ::dup2(launch.output, STDERR_FILENO);
  // Sockets of the test would stay open, and their ports taken, for as long as the child lives.
  ::close_range(3, UINT_MAX, 0);
  ::execv(launch.arguments[0], launch.arguments);
  ::_exit(127);
}

std::string ReadWhole(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string AddressIn(const std::string& port_file) {
  const nlohmann::json json = nlohmann::json::parse(port_file, nullptr, false);
  if (json.is_number_integer()) return absl::StrCat("127.0.0.1:", json.get<int>());
  return json.is_object() ? json.value("grpc", "") : "";
}

}  // namespace

std::string BuiltProgram(std::string_view name) {
  const char* folder = std::getenv("MORTISE_BIN_DIR");
  return std::string(folder == nullptr ? "build/release/bin" : folder) + "/" + std::string(name);
}

ChildProcess::ChildProcess(std::vector<std::string> arguments, const Options& options)
    : program_(arguments.at(0)) {
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  const passwd* user = options.user.empty() ? nullptr : ::getpwnam(options.user.c_str());
  if (user == nullptr && !options.user.empty()) {
    throw std::runtime_error("there is no user " + options.user);
  }
  const int output =
      ::open((folder_.path() / "output").c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (output < 0) throw SystemError("opening the output of " + program_);
  const Launch launch{pointers.data(), user, output, ::getpid()};
  pid_ = ::fork();
  if (pid_ == 0) RunChild(launch);
  ::close(output);
  if (pid_ < 0) {
    pid_ = 0;
    throw SystemError("starting " + program_);
  }
  end_ = std::make_unique<ProcessEnd>(pid_);
}

ChildProcess::~ChildProcess() {
  End(SIGKILL);
  if (::testing::Test::HasFailure()) {
    std::cerr << "--- output of " << program_ << "\n" << Output() << "---\n";
  }
}

void ChildProcess::Signal(int signal) {
  if (pid_ > 0) ::kill(pid_, signal);
}

int ChildProcess::Wait() {
  if (pid_ <= 0) return result_;
  pollfd end = {end_descriptor(), POLLIN, 0};
  int ready = 0;
  do {
    ready = ::poll(&end, 1, static_cast<int>(absl::ToInt64Milliseconds(kPatience)));
  } while (ready < 0 && errno == EINTR);
  if (ready == 0) {
    ADD_FAILURE() << program_ << " does not end";
    Signal(SIGKILL);
  }
  int status = 0;
  ::waitpid(std::exchange(pid_, 0), &status, 0);
  result_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return result_;
}

std::string ChildProcess::AwaitFile(const std::filesystem::path& file) const {
  const auto there = [&] { return std::filesystem::exists(file); };
  if (!WaitForFiles(file.parent_path(), there, kPatience, end_descriptor())) {
    throw std::runtime_error(
        absl::StrCat(program_, " did not write ", file.string(), "; it said:\n", Output()));
  }
  return ReadWhole(file);
}

bool ChildProcess::AwaitOutput(std::string_view text) const {
  const auto there = [&] { return Output().find(text) != std::string::npos; };
  return WaitForFiles(folder_.path(), there, kPatience, end_descriptor());
}

std::string ChildProcess::Output() const { return ReadWhole(folder_.path() / "output"); }

ServiceProcess::ServiceProcess(const std::string& program, const std::vector<std::string>& flags,
                               const std::filesystem::path& port_file)
    : ChildProcess([&] {
        std::filesystem::remove(port_file);
        std::vector<std::string> arguments = {program, "--port-file=" + port_file.string()};
        arguments.insert(arguments.end(), flags.begin(), flags.end());
        return arguments;
      }()),
      address_(AddressIn(AwaitFile(port_file))) {}

}  // namespace mortise::testing
