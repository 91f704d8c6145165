// A file as memory, for reading.
#pragma once

#include <filesystem>
#include <string_view>

#include "absl/status/statusor.h"

namespace mortise::retrieval {

// The bytes of a file, mapped; the destructor gives the mapping back. Pages are read when they are
// first looked at, and shared between processes. The file may be renamed over or removed meanwhile,
// but must not be changed or cut in place.
class MappedFile {
 public:
  // NOT_FOUND, PERMISSION_DENIED or INTERNAL with the path; INVALID_ARGUMENT for what is no file.
  static absl::StatusOr<MappedFile> Open(const std::filesystem::path& path);

  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  std::string_view bytes() const { return bytes_; }

 private:
  explicit MappedFile(std::string_view bytes) : bytes_(bytes) {}

  std::string_view bytes_;  // empty: nothing is mapped
};

}  // namespace mortise::retrieval
