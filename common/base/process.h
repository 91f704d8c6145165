// Child processes: started, watched, ended by id.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise {

// How a process ended: its exit code, or the signal that killed it.
struct ProcessEnd {
  bool signalled = false;
  int code = 0;  // exit code, or signal number

  std::string ToString() const;
};

// Returns the file of a program on PATH, that may be run; empty if there is none.
std::filesystem::path FindProgram(const std::string& program);

// Starts `command` (program and arguments) with standard output and error appended to `log`, the
// environment entries `environment` ("NAME=value") in place of, or beside, this process's. The
// child gets SIGTERM when the thread that started it dies, so that a killed parent leaves no
// orphans.
absl::StatusOr<pid_t> StartProcess(const std::vector<std::string>& command,
                                   const std::filesystem::path& log,
                                   const std::vector<std::string>& environment = {});

// Collects the end of `pid` if it has ended; never waits.
std::optional<ProcessEnd> CollectProcess(pid_t pid);

// Kills `pid`, a child that StartProcess started, with all that it started in turn, and collects
// it.
void KillProcess(pid_t pid);

// Starts `command` as StartProcess does and waits until it ends; nothing if it was killed because
// it had not after `limit`.
absl::StatusOr<std::optional<ProcessEnd>> RunProcess(
    const std::vector<std::string>& command, const std::filesystem::path& log,
    std::chrono::milliseconds limit, const std::vector<std::string>& environment = {});

// Whether a process with this id exists.
bool ProcessExists(pid_t pid);

}  // namespace mortise
