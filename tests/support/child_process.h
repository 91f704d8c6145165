// A program that a test starts: waiting for it to serve, signals, its end, and what it printed.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/time/time.h"
#include "tests/support/file_watch.h"
#include "tests/support/temporary_folder.h"

namespace mortise::testing {

// Where a program of this repository was built: in MORTISE_BIN_DIR.
std::string BuiltProgram(std::string_view name);

// A child that cannot outlive its test: the destructor kills it, and so does the system should the
// thread end that started it. In a test that failed the destructor shows the child's output. Not
// thread safe, but for Signal and Output.
class ChildProcess {
 public:
  // How long a child may take for what is waited for.
  static constexpr absl::Duration kPatience = absl::Seconds(60);

  struct Options {
    std::string user = {};  // runs as this user; empty: as the test does
  };

  // Starts `arguments[0]`, a path, with the rest as its arguments. Throws std::system_error.
  explicit ChildProcess(std::vector<std::string> arguments) : ChildProcess(arguments, Options{}) {}
  ChildProcess(std::vector<std::string> arguments, const Options& options);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // 0 once Wait has seen its end.
  pid_t pid() const { return pid_; }

  // Readable once the process has ended, for poll().
  int end_descriptor() const { return end_->descriptor(); }

  void Signal(int signal);

  // Waits for the end, killing it when kPatience has passed. The exit code, or minus the signal
  // that ended it; the same again for later calls.
  int Wait();

  int End(int signal) {
    Signal(signal);
    return Wait();
  }

  // Waits until the file is there, which must be written whole (renamed into place), and returns
  // its content. Throws std::runtime_error with the output if the process ends first or kPatience
  // passes. Remove an old file before the start.
  std::string AwaitFile(const std::filesystem::path& file) const;

  // Waits until the output contains `text`; false if it ends first or kPatience passes.
  bool AwaitOutput(std::string_view text) const;

  // Standard output and standard error until now.
  std::string Output() const;

 private:
  const std::string program_;
  TemporaryFolder folder_;  // of the output
  pid_t pid_ = 0;
  std::unique_ptr<ProcessEnd> end_;
  int result_ = 0;
};

// A service of this repository: a child with a port file.
class ServiceProcess : public ChildProcess {
 public:
  // Starts the program, a path, with `flags` and --port-file, and waits until it serves. Throws as
  // AwaitFile.
  ServiceProcess(const std::string& program, const std::vector<std::string>& flags,
                 const std::filesystem::path& port_file);

  // host:port of its gRPC door; "127.0.0.1:port" of a program that writes its port only.
  const std::string& address() const { return address_; }

 private:
  std::string address_;
};

}  // namespace mortise::testing
