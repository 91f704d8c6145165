// Tells whether a file is still as it was.
#pragma once

#include <cstdint>
#include <filesystem>

namespace mortise::retrieval {

// Which file lies at a path, and when it was last written: whoever writes to it, cuts it or puts
// another in its place changes this, but for clocks that are set back.
struct FileStamp {
  std::uint64_t device = 0;
  std::uint64_t node = 0;  // all zero: there is no file
  std::int64_t bytes = 0;
  std::int64_t changed_seconds = 0;  // of content, owner or rights
  std::int64_t changed_nanoseconds = 0;

  bool operator==(const FileStamp&) const = default;
};

// Returns the stamp of what lies at `path` now; of nothing all zeros.
FileStamp StampOf(const std::filesystem::path& path);

}  // namespace mortise::retrieval
