// The folder in which a launched house keeps everything: stores, blobs, keys, logs, and
// `house.json`, which says what runs where.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::cli {

// One process of a running house.
struct RunningProcess {
  std::string name;  // "catalog", "simulator-worker-1"
  pid_t pid = 0;
  std::string address;  // host:port, empty for workers
  int restarts = 0;
  bool serving = false;
};

// What `house.json` says.
struct RunningHouse {
  pid_t launcher = 0;
  std::string gateway_grpc;    // host:port
  std::string gateway_http;    // host:port
  bool plain_text = false;     // whether the gateway's doors are without TLS
  std::string authority = {};  // PEM file whom its clients must trust, empty in plain text
  std::vector<RunningProcess> processes;
};

// Exclusive use of a state folder by one launcher, held until destruction or death.
class StateFolderLock {
 public:
  // Creates the folder. FAILED_PRECONDITION, reason STATE_FOLDER_IN_USE, if another launcher has
  // it; PERMISSION_DENIED or RESOURCE_EXHAUSTED with the path if it cannot be written.
  static absl::StatusOr<StateFolderLock> Take(const std::filesystem::path& folder);

  StateFolderLock(StateFolderLock&& other) noexcept;
  StateFolderLock& operator=(StateFolderLock&&) = delete;
  ~StateFolderLock();

 private:
  explicit StateFolderLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

// Reads or writes `house.json`. Reading NOT_FOUND: no house was started here.
absl::StatusOr<RunningHouse> ReadRunningHouse(const std::filesystem::path& folder);
absl::Status WriteRunningHouse(const std::filesystem::path& folder, const RunningHouse& house);

}  // namespace mortise::cli
