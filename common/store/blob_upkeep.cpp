#include "common/store/blob_upkeep.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"

namespace mortise::store {
namespace {

constexpr const char* kParts = "parts";
constexpr std::size_t kDigest = 64;  // characters

struct FileState {
  absl::Time written_at;
  double bytes = 0;
};

// Absent if there is no such file.
std::optional<FileState> StateOf(const std::filesystem::path& path) {
  struct stat status = {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return FileState{absl::TimeFromTimespec(status.st_mtim), static_cast<double>(status.st_size)};
}

absl::Status Failed(const std::filesystem::path& path, const std::string& what) {
  return StorageFailed(path.string(), what);
}

// The files in a folder; none if it is not there.
absl::StatusOr<std::vector<std::filesystem::path>> FilesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  if (error == std::errc::no_such_file_or_directory) return files;
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    files.push_back(entry->path());
  }
  if (error) return Failed(folder, "the folder cannot be listed: " + error.message());
  return files;
}

// Takes the blob away, looks again, and puts it back if somebody wrote or touched it meanwhile:
// between a look and a removal there would always be a moment in which it could become wanted.
absl::StatusOr<bool> RemoveIfOld(const std::filesystem::path& folder,
                                 const std::filesystem::path& blob, absl::Time before) {
  const std::filesystem::path aside = folder / kParts / NewIdentifier();
  if (::rename(blob.c_str(), aside.c_str()) != 0) {
    if (errno == ENOENT) return false;  // another process was first
    return Failed(blob, std::strerror(errno));
  }
  const std::optional<FileState> state = StateOf(aside);
  if (state && state->written_at >= before) {
    if (::rename(aside.c_str(), blob.c_str()) != 0) return Failed(blob, std::strerror(errno));
    return false;
  }
  if (::unlink(aside.c_str()) != 0 && errno != ENOENT) return Failed(aside, std::strerror(errno));
  return true;
}

// Shows each blob to `visit`, which returns a status.
template <typename Visit>
absl::Status VisitBlobs(const std::filesystem::path& folder, const Visit& visit) {
  MORTISE_ASSIGN_OR_RETURN(const auto shelves, FilesIn(folder));
  for (const std::filesystem::path& shelf : shelves) {
    if (shelf.filename() == kParts || !std::filesystem::is_directory(shelf)) continue;
    MORTISE_ASSIGN_OR_RETURN(const auto files, FilesIn(shelf));
    for (const std::filesystem::path& file : files) {
      const std::optional<FileState> state = StateOf(file);
      if (!state || file.filename().native().size() != kDigest) continue;
      MORTISE_RETURN_IF_ERROR(visit(file, *state));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status TouchBlob(BlobFolder& blobs, std::string_view digest) {
  MORTISE_ASSIGN_OR_RETURN(const std::filesystem::path path, blobs.PathOf(digest));
  if (::utimensat(AT_FDCWD, path.c_str(), nullptr, 0) == 0) return absl::OkStatus();
  if (errno == ENOENT) return ResourceNotFound(absl::StrCat("blobs/", std::string(digest)));
  return Failed(path, std::strerror(errno));
}

absl::StatusOr<std::vector<BlobEntry>> ListBlobs(const std::filesystem::path& folder) {
  std::vector<BlobEntry> entries;
  MORTISE_RETURN_IF_ERROR(
      VisitBlobs(folder, [&](const std::filesystem::path& file, const FileState& state) {
        entries.push_back({file.filename(), state.written_at, state.bytes});
        return absl::OkStatus();
      }));
  return entries;
}

absl::StatusOr<RemovedBlobs> RemoveUnusedBlobs(
    const std::filesystem::path& folder, absl::Time before,
    const std::function<bool(const std::string& digest)>& is_used) {
  RemovedBlobs removed;
  MORTISE_RETURN_IF_ERROR(VisitBlobs(
      folder, [&](const std::filesystem::path& file, const FileState& state) -> absl::Status {
        if (state.written_at >= before || is_used(file.filename())) return absl::OkStatus();
        MORTISE_ASSIGN_OR_RETURN(const bool is_gone, RemoveIfOld(folder, file, before));
        if (!is_gone) return absl::OkStatus();
        ++removed.count;
        removed.bytes += state.bytes;
        return absl::OkStatus();
      }));
  return removed;
}

absl::StatusOr<bool> RemoveBlobIfOld(const std::filesystem::path& folder, const std::string& digest,
                                     absl::Time before) {
  return RemoveIfOld(folder, folder / digest.substr(0, 2) / digest, before);
}

absl::StatusOr<RemovedBlobs> RemoveAbandonedParts(const std::filesystem::path& folder,
                                                  absl::Time before) {
  RemovedBlobs removed;
  MORTISE_ASSIGN_OR_RETURN(const auto parts, FilesIn(folder / kParts));
  for (const std::filesystem::path& part : parts) {
    const std::optional<FileState> state = StateOf(part);
    if (!state || state->written_at >= before) continue;
    if (::unlink(part.c_str()) != 0) continue;  // finished or removed meanwhile
    ++removed.count;
    removed.bytes += state->bytes;
  }
  return removed;
}

}  // namespace mortise::store
