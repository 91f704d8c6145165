// Keeps a folder of blobs (blob_folder.h) free of what nobody refers to any more, beside others who
// write, touch and read blobs in it, in this process and elsewhere.
//
// Whoever begins to refer to a blob that may be old touches it first; then it is as new as one just
// written, and stays while it is younger than the grace period of those who remove.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/store/blob_folder.h"

namespace mortise::store {

// Makes a blob as new as if it had just been written. NOT_FOUND; INVALID_ARGUMENT, "digest".
absl::Status TouchBlob(BlobFolder& blobs, std::string_view digest);

struct BlobEntry {
  std::string digest;
  absl::Time written_at;  // or touched
  double bytes = 0;
};

// Returns all blobs of `folder`, in no order. INTERNAL, STORAGE_FAILED.
absl::StatusOr<std::vector<BlobEntry>> ListBlobs(const std::filesystem::path& folder);

// What was removed.
struct RemovedBlobs {
  int count = 0;
  double bytes = 0;
};

// Removes the blobs of `folder` that were written and touched before `before` and are not
// `is_used`. A blob that is written or touched meanwhile stays. INTERNAL, STORAGE_FAILED.
absl::StatusOr<RemovedBlobs> RemoveUnusedBlobs(
    const std::filesystem::path& folder, absl::Time before,
    const std::function<bool(const std::string& digest)>& is_used);

// Removes one such blob; returns whether it is gone by this. INTERNAL, STORAGE_FAILED.
absl::StatusOr<bool> RemoveBlobIfOld(const std::filesystem::path& folder, const std::string& digest,
                                     absl::Time before);

// Removes parts of blobs that nobody has written to since `before`: their writers have died.
absl::StatusOr<RemovedBlobs> RemoveAbandonedParts(const std::filesystem::path& folder,
                                                  absl::Time before);

}  // namespace mortise::store
