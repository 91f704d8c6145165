// Waiting for what another process does to files, without looking again and again.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>

#include "absl/time/time.h"

namespace mortise::testing {

// A descriptor that is readable once a process has ended. Throws std::system_error.
class ProcessEnd {
 public:
  explicit ProcessEnd(pid_t process);
  ~ProcessEnd();
  ProcessEnd(const ProcessEnd&) = delete;
  ProcessEnd& operator=(const ProcessEnd&) = delete;

  int descriptor() const { return descriptor_; }

 private:
  const int descriptor_;
};

// Waits until `holds()`, which is asked at once and then after every change in `folder` (not in
// folders below it). False if it still does not hold once `timeout` has passed, or once the
// descriptor `until` is readable (-1: none). Throws
// std::system_error if the folder cannot be watched.
bool WaitForFiles(const std::filesystem::path& folder, const std::function<bool()>& holds,
                  absl::Duration timeout, int until = -1);

}  // namespace mortise::testing
