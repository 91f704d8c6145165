// Runs `mortise`, and lines of shell, as a person would, and tells what they printed.
#pragma once

#include <filesystem>
#include <memory>
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

// Runs a bash script in a folder, with the programs of this build on the PATH, and waits for it. It
// ends with the first command that fails.
CommandResult Shell(const std::string& script, const std::filesystem::path& folder);

// A `mortise` in the background, ended with SIGTERM on destruction, and when the thread ends that
// started it, as that of a test that crashes.
class BackgroundCommand {
 public:
  BackgroundCommand(const std::vector<std::string>& arguments, const std::string& log);
  // One command as in `Shell`, in place of `mortise`.
  static std::unique_ptr<BackgroundCommand> InShell(const std::string& command,
                                                    const std::filesystem::path& folder,
                                                    const std::string& log);
  ~BackgroundCommand();
  BackgroundCommand(const BackgroundCommand&) = delete;
  BackgroundCommand& operator=(const BackgroundCommand&) = delete;

  int pid() const { return pid_; }

  // Waits for its end; the exit code.
  int Wait();

 private:
  explicit BackgroundCommand(int pid) : pid_(pid) {}

  int pid_ = 0;
};

// Waits until every process of the house on this state folder serves; false if that takes longer
// than a minute.
bool AwaitHouse(const std::filesystem::path& state);

}  // namespace mortise::e2e
