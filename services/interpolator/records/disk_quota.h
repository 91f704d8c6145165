// How much disk all maps together may take: those that are stored, and those being built.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/store/blob_folder.h"

namespace mortise::interpolator {

inline constexpr double kDefaultDiskQuota = 100e9;  // bytes

// Thread safe. What counts is what maps say that they take: a map that is deleted counts no more,
// although its files stay until the upkeep removes them. Builds that other processes run on the
// same store count when they are through.
class DiskQuota {
 public:
  // `quota`: bytes, the most that all may take. `bytes_of_maps` tells what those stored take.
  DiskQuota(double quota, std::function<absl::StatusOr<std::int64_t>()> bytes_of_maps)
      : quota_(quota), bytes_of_maps_(std::move(bytes_of_maps)) {}

  // What one build has written so far. It counts until this is destroyed: the map that has been
  // stored by then counts in its place.
  class Build {
   public:
    explicit Build(DiskQuota* quota);
    ~Build();
    Build(const Build&) = delete;
    Build& operator=(const Build&) = delete;

    // Counts bytes that are about to be written, or have been by an earlier run.
    // RESOURCE_EXHAUSTED, DISK_QUOTA, saying what all maps take and may take, where they do not
    // fit: then they do not count. Else fails as `bytes_of_maps`.
    absl::Status Take(std::int64_t bytes);

    // The same of a file with this digest, which counts once however often it is written.
    absl::Status TakeFile(const std::string& digest, std::int64_t bytes);

    // Returns how many have been counted.
    std::int64_t bytes() const;

   private:
    absl::Status TakeLocked(std::int64_t bytes);

    DiskQuota* const quota_;
    // Guarded by the quota's mutex:
    std::int64_t bytes_ = 0;
    std::set<std::string> files_;  // digests of those counted
  };

 private:
  absl::StatusOr<double> Taken();

  const double quota_;
  const std::function<absl::StatusOr<std::int64_t>()> bytes_of_maps_;
  mutable std::mutex mutex_;
  // Guarded by mutex_:
  double of_builds_ = 0;
  std::optional<std::int64_t> of_maps_;  // as last read; nothing where they may have changed
};

// Stores a file of a build, whose bytes it takes of the quota first (TakeFile), and returns its
// digest.
// RESOURCE_EXHAUSTED, DISK_QUOTA, or DISK_FULL where the disk has no room left; else fails as
// BlobFolder::Put.
absl::StatusOr<std::string> PutFile(store::BlobFolder& blobs, DiskQuota::Build& build,
                                    std::string_view bytes);

}  // namespace mortise::interpolator
