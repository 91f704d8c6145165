// How much disk the files of a service's blob folder may take together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
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

// Thread safe. What other processes write into the same folder counts from the next look at it on:
// after ten minutes, or when there seems to be too little room.
class FileQuota {
 public:
  // `named`: the files that stay whatever happens. `quota`: bytes, the most that all may take.
  // `flag`: of the program, which sets it. Store and operations outlive it.
  FileQuota(store::Store* store, operations::Operations* operations, std::filesystem::path folder,
            NamedFiles named, double quota, std::string flag);

  // Room for a file that is being written. What is not kept is free again once this is destroyed.
  class Room {
   public:
    Room(FileQuota* quota, double bytes) : quota_(quota), bytes_(bytes) {}
    ~Room();
    Room(const Room&) = delete;
    Room& operator=(const Room&) = delete;

    // From now on the file is there.
    void Keep() { is_kept_ = true; }

   private:
    FileQuota* const quota_;
    const double bytes_;
    bool is_kept_ = false;
  };

  // Makes room: where there is none, the oldest files go that nothing names and that were not
  // written, named or fetched within the last minute. RESOURCE_EXHAUSTED, FILE_QUOTA, saying what
  // all files take and may take, where that is not enough; FILE_BEYOND_QUOTA where one file alone
  // is too much, so that there will never be room for it. Fails as RemoveOldestFiles.
  absl::StatusOr<std::unique_ptr<Room>> MakeRoom(std::int64_t bytes);

 private:
  absl::Status Look();
  absl::Status RemoveOldest(double bytes);
  double Lacking(double bytes) const { return taken_ + held_ + bytes - quota_; }

  store::Store* const store_;
  operations::Operations* const operations_;
  const std::filesystem::path folder_;
  const NamedFiles named_;
  const double quota_;
  const std::string flag_;
  std::mutex mutex_;
  // Guarded by mutex_:
  double taken_ = 0;  // bytes of files that are there
  double held_ = 0;   // bytes of rooms
  std::optional<absl::Time> looked_at_;
};

}  // namespace mortise::rpc
