// Folders for files that other programs read and write.
#pragma once

#include <filesystem>
#include <string_view>

namespace mortise {

// A name of its own in the folder for temporary files, "mortise-PURPOSE-IDENTIFIER". Whoever
// writes the first file makes the folder; it goes with this object, and all in it.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(std::string_view purpose);
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  const std::filesystem::path path_;
};

}  // namespace mortise
