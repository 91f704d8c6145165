// Keeps the file that a process's standard error goes to from growing without end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace mortise {

// How many full files are kept beside the one that is written: FILE.1, the newest of them, to
// FILE.5.
inline constexpr int kKeptLogFiles = 5;

struct LogRotation {
  std::filesystem::path file;  // where standard output and error of this process go
  std::int64_t size = 0;       // bytes after which a new file is begun

  // Returns what whoever started this process asks for: MORTISE_LOG_FILE, and
  // MORTISE_LOG_MEGABYTES, 10 if that is not set. Nothing without the first.
  static std::optional<LogRotation> FromEnvironment();

  // Where the file is full: renames it and the older ones by one, removes the oldest, and goes on
  // in a new file. Does nothing where standard error goes elsewhere. A child that writes to the old
  // file goes on doing so. One call at a time.
  void BeginNewFileIfFull() const;
};

}  // namespace mortise
