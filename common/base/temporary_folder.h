// Folders for files that other programs read and write.
#pragma once

#include <filesystem>
#include <string_view>

namespace mortise {

// One that only this user may look into, "mortise-PURPOSE-IDENTIFIER" in the folder for temporary
// files. It goes with this object, and all in it; where the process was killed, as soon as one for
// the same purpose is made a minute later or after. Where it cannot be made, writing files there
// fails.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(std::string_view purpose);
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  const std::filesystem::path path_;
  int held_ = -1;  // the folder, open and locked while the process lives
};

}  // namespace mortise
