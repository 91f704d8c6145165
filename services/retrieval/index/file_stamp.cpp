#include "services/retrieval/index/file_stamp.h"

#include <sys/stat.h>

namespace mortise::retrieval {

FileStamp StampOf(const std::filesystem::path& path) {
  struct stat about = {};
  if (::stat(path.c_str(), &about) != 0) return {};
  return {.device = about.st_dev,
          .node = about.st_ino,
          .bytes = about.st_size,
          .changed_seconds = about.st_ctim.tv_sec,
          .changed_nanoseconds = about.st_ctim.tv_nsec};
}

}  // namespace mortise::retrieval
