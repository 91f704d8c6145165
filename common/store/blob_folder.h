// Large values in a folder, named by the SHA-256 digest of their bytes.
//
// A blob is written beside its place and renamed into it, so nobody sees half of one, and writing
// the same bytes twice stores them once. Blobs are never changed. The folder may be shared by
// several processes, or be a bucket mount.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::store {

// Writes one blob piece by piece. Dropped without Finish, it leaves nothing behind.
class BlobWriter {
 public:
  virtual ~BlobWriter() = default;

  // INTERNAL, STORAGE_FAILED naming the path.
  virtual absl::Status Append(std::string_view bytes) = 0;

  // Returns the digest of what was appended so far, as Finish would return it.
  virtual std::string Digest() const = 0;

  // Flushes to disk, puts the blob into its place and returns its digest. Call once, last.
  virtual absl::StatusOr<std::string> Finish() = 0;
};

// Whether a failure to write a blob is for want of room: on the disk, or within what a file may
// grow to there or in this process.
bool IsDiskFull(const absl::Status& status);

class BlobFolder {
 public:
  // Creates the folder if it is missing and checks that it can be written; INTERNAL,
  // STORAGE_FAILED naming the path otherwise.
  static absl::StatusOr<std::unique_ptr<BlobFolder>> Open(const std::filesystem::path& folder);

  // Stores bytes and returns their digest: 64 lower-case hexadecimal digits.
  absl::StatusOr<std::string> Put(std::string_view bytes);

  absl::StatusOr<std::unique_ptr<BlobWriter>> Write();

  // Returns the whole blob. INVALID_ARGUMENT for a malformed digest, NOT_FOUND, RESOURCE_EXHAUSTED
  // past `limit` bytes, DATA_LOSS if the bytes on disk no longer have this digest.
  absl::StatusOr<std::string> Get(std::string_view digest,
                                  std::size_t limit = std::size_t{1} << 30);

  // Up to `length` bytes from `offset`, for streaming; empty at the end. Does not check the digest.
  absl::StatusOr<std::string> GetRange(std::string_view digest, uint64_t offset,
                                       std::size_t length);

  // Returns the size in bytes; NOT_FOUND.
  absl::StatusOr<uint64_t> Size(std::string_view digest);

  // Returns where the blob's file is, for libraries that read files; NOT_FOUND.
  absl::StatusOr<std::filesystem::path> PathOf(std::string_view digest);

  // Removes a blob; OK if there is none. The caller knows that nobody refers to it.
  absl::Status Remove(std::string_view digest);

 private:
  explicit BlobFolder(std::filesystem::path folder);

  std::filesystem::path folder_;
};

}  // namespace mortise::store
