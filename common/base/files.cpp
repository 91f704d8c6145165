#include "common/base/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"

namespace mortise {
namespace {

absl::Status Failure(const std::filesystem::path& path, std::string_view doing) {
  const int error = errno;
  const std::string message =
      absl::StrCat("cannot ", std::string(doing), " ", path.string(), ": ", std::strerror(error));
  const ErrorDetail detail{"FILE_FAILED", path.string()};
  if (error == ENOENT) return WithDetail(absl::NotFoundError(message), detail);
  if (error == EACCES || error == EROFS || error == EPERM) {
    return WithDetail(absl::PermissionDeniedError(message), detail);
  }
  if (error == ENOSPC) return WithDetail(absl::ResourceExhaustedError(message), detail);
  return WithDetail(absl::InternalError(message), detail);
}

absl::Status WriteAll(int descriptor, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return Failure(path, "write");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::fsync(descriptor) != 0) return Failure(path, "flush");
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> ReadFile(const std::filesystem::path& path, std::size_t limit) {
  // A folder can be opened, and then has the largest of all sizes.
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return WithDetail(
        absl::InvalidArgumentError(absl::StrCat(path.string(), " is a folder, not a file")),
        {"FILE_FAILED", path.string()});
  }
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return Failure(path, "read");
  const std::streamoff size = file.tellg();
  if (size < 0) return Failure(path, "read");
  if (static_cast<std::size_t>(size) > limit) {
    return TooLarge(path.string(), absl::StrCat(limit, " bytes"));
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  file.seekg(0);
  if (!file.read(bytes.data(), size)) return Failure(path, "read");
  return bytes;
}

std::string LowerCaseExtension(const std::filesystem::path& path) {
  return absl::AsciiStrToLower(path.extension().string());
}

absl::Status WriteFile(const std::filesystem::path& path, std::string_view bytes) {
  std::error_code error;
  if (path.has_parent_path()) {
    std::filesystem::create_directories(path.parent_path(), error);
    if (error) {
      errno = error.value();
      return Failure(path.parent_path(), "create the folder");
    }
  }
  const std::filesystem::path temporary = path.string() + "." + NewIdentifier() + ".part";
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0) return Failure(temporary, "create");
  absl::Status status = WriteAll(descriptor, bytes, path);
  ::close(descriptor);
  if (status.ok() && ::rename(temporary.c_str(), path.c_str()) != 0) {
    status = Failure(path, "rename onto");
  }
  if (!status.ok()) ::unlink(temporary.c_str());
  return status;
}

}  // namespace mortise
