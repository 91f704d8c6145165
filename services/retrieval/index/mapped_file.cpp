// open, fstat, mmap, munmap.
#include "services/retrieval/index/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::retrieval {
namespace {

absl::Status Failure(const std::filesystem::path& path) {
  const int error = errno;
  const std::string message = absl::StrCat("cannot read ", path.string(), ": ", strerror(error));
  const ErrorDetail detail{"FILE_FAILED", path.string()};
  if (error == ENOENT) return WithDetail(absl::NotFoundError(message), detail);
  if (error == EACCES || error == EPERM) {
    return WithDetail(absl::PermissionDeniedError(message), detail);
  }
  return WithDetail(absl::InternalError(message), detail);
}

absl::StatusOr<std::string_view> Map(int descriptor, const std::filesystem::path& path) {
  struct stat about = {};
  if (::fstat(descriptor, &about) != 0) return Failure(path);
  if (!S_ISREG(about.st_mode)) {
    return WithDetail(absl::InvalidArgumentError(absl::StrCat(path.string(), " is no file")),
                      {"FILE_FAILED", path.string()});
  }
  const auto size = static_cast<std::size_t>(about.st_size);
  if (size == 0) return std::string_view();
  void* start = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor, 0);
  if (start == MAP_FAILED) return Failure(path);
  return std::string_view(static_cast<const char*>(start), size);
}

}  // namespace

absl::StatusOr<MappedFile> MappedFile::Open(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return Failure(path);
  const absl::StatusOr<std::string_view> bytes = Map(descriptor, path);
  ::close(descriptor);  // the mapping stays
  if (!bytes.ok()) return bytes.status();
  return MappedFile(*bytes);
}

MappedFile::MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  return *this;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<char*>(bytes_.data()), bytes_.size());
}

}  // namespace mortise::retrieval
