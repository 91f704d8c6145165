// Runs `mortise` as a person would, and tells what it printed.
#pragma once

#include <string>
#include <vector>

namespace mortise::e2e {

struct CommandResult {
  int exit_code = -1;  // 128 + signal if it was killed
  std::string out;     // standard output
  std::string error;   // standard error
};

// Runs `mortise` with arguments and waits for it.
CommandResult Mortise(const std::vector<std::string>& arguments);

// A `mortise` in the background, ended with SIGTERM on destruction.
class BackgroundCommand {
 public:
  BackgroundCommand(const std::vector<std::string>& arguments, const std::string& log);
  ~BackgroundCommand();
  BackgroundCommand(const BackgroundCommand&) = delete;
  BackgroundCommand& operator=(const BackgroundCommand&) = delete;

  int pid() const { return pid_; }

  // Waits for its end; the exit code.
  int Wait();

 private:
  int pid_ = 0;
};

}  // namespace mortise::e2e
