// How much disk the files of a service's blob folder may take together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/host/unused_files.h"

namespace mortise::rpc {

// Reasons of RESOURCE_EXHAUSTED: no room now, and no room ever for a file of this size.
inline constexpr char kFileQuota[] = "FILE_QUOTA";
inline constexpr char kFileBeyondQuota[] = "FILE_BEYOND_QUOTA";

// Keeps count of what the files take. It looks at all of them at its first use, every ten minutes,
// and when there seems to be too little room: then what other processes have written into the
// folder or removed from it counts, too. Who has room does not wait for a look. Thread safe.
class FileQuota {
 public:
  // `named`: the files that stay whatever happens. `quota`: bytes, the most that all may take.
  // `flag`: of the program, which sets it. Store and operations outlive it.
  FileQuota(store::Store* store, operations::Operations* operations, std::filesystem::path folder,
            NamedFiles named, double quota, std::string flag);

  // Room for a file that is being written: for what has come of it, so that nothing goes for what
  // is only announced. What is not kept is free again once this is destroyed.
  class Room {
   public:
    // The quota outlives it.
    explicit Room(FileQuota* quota) : quota_(quota) {}
    ~Room();
    Room(const Room&) = delete;
    Room& operator=(const Room&) = delete;

    // Makes room for so many bytes more, before they are written: where there is none, the oldest
    // files go that nothing names and that were not written, named or fetched within the last
    // minute. RESOURCE_EXHAUSTED, FILE_QUOTA, saying what all files take and may take, where that
    // is not enough. Fails as RemoveOldestFiles.
    absl::Status Grow(std::int64_t bytes);

    // From now on the file is there. `is_new`: whether there was none of the same bytes before.
    void Keep(bool is_new) { adds_ = is_new ? bytes_ : 0; }

   private:
    FileQuota* const quota_;
    double bytes_ = 0;
    double adds_ = 0;  // of these to the files that are there
  };

  // RESOURCE_EXHAUSTED, FILE_BEYOND_QUOTA, where one file of so many bytes alone is too much, so
  // that there will never be room for it.
  absl::Status CheckSize(std::int64_t bytes) const;

 private:
  absl::Status Take(double bytes);
  bool TakeIfThere(double bytes);
  absl::StatusOr<bool> Look(double wanted);
  absl::Status Full(double bytes);
  double Lacking(double bytes) const { return taken_ + held_ + bytes - quota_; }

  store::Store* const store_;
  operations::Operations* const operations_;
  const std::filesystem::path folder_;
  const NamedFiles named_;
  const double quota_;
  const std::string flag_;
  std::mutex looking_;  // locked before mutex_, by who looks
  std::mutex mutex_;
  // Guarded by mutex_:
  double taken_ = 0;          // bytes of files that are there
  double held_ = 0;           // bytes of rooms
  double added_in_look_ = 0;  // bytes of files that have come since the last look began
  std::int64_t looks_ = 0;    // that have begun
  std::int64_t in_vain_ = 0;  // the last of them that found nothing that could go
  std::optional<absl::Time> looked_at_;
};

}  // namespace mortise::rpc
