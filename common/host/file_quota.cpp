#include "common/host/file_quota.h"

#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/store/blob_upkeep.h"
#include "common/store/store.h"

namespace mortise::rpc {
namespace {

constexpr absl::Duration kLookAgain = absl::Minutes(10);
// More room than is lacking is made at once, as a share of the quota: finding the oldest files
// takes a look at all of them.
constexpr double kAhead = 0.01;

}  // namespace

FileQuota::FileQuota(store::Store* store, operations::Operations* operations,
                     std::filesystem::path folder, NamedFiles named, double quota, std::string flag)
    : store_(store),
      operations_(operations),
      folder_(std::move(folder)),
      named_(std::move(named)),
      quota_(quota),
      flag_(std::move(flag)) {}

FileQuota::Room::~Room() {
  const std::lock_guard lock(quota_->mutex_);
  quota_->held_ -= bytes_;
  if (is_kept_) quota_->taken_ += bytes_;
}

// The mutex is held by who calls it.
absl::Status FileQuota::Look() {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<store::BlobEntry> files, store::ListBlobs(folder_));
  taken_ = 0;
  for (const store::BlobEntry& file : files) taken_ += file.bytes;
  looked_at_ = store_->Now();
  return absl::OkStatus();
}

// Likewise.
absl::Status FileQuota::RemoveOldest(double bytes) {
  MORTISE_ASSIGN_OR_RETURN(
      const store::RemovedBlobs removed,
      RemoveOldestFiles(*store_, *operations_, folder_, named_, bytes + kAhead * quota_));
  if (removed.count > 0) {
    Log(LogLevel::kInfo, "removed the oldest files to make room",
        {{"files", removed.count}, {"bytes", removed.bytes}});
  }
  taken_ -= removed.bytes;
  return absl::OkStatus();
}

absl::StatusOr<std::unique_ptr<FileQuota::Room>> FileQuota::MakeRoom(std::int64_t bytes) {
  const auto wanted = static_cast<double>(bytes);
  if (wanted > quota_) {
    return WithDetail(absl::ResourceExhaustedError(absl::StrFormat(
                          "a file of %.6g MB is beyond the %.6g MB that all files may take "
                          "together (--%s)",
                          wanted / 1e6, quota_ / 1e6, flag_)),
                      {kFileBeyondQuota, flag_});
  }
  const std::lock_guard lock(mutex_);
  const bool is_old = !looked_at_ || store_->Now() - *looked_at_ > kLookAgain;
  if (is_old || Lacking(wanted) > 0) MORTISE_RETURN_IF_ERROR(Look());
  if (Lacking(wanted) > 0) MORTISE_RETURN_IF_ERROR(RemoveOldest(Lacking(wanted)));
  if (Lacking(wanted) > 0) {
    return WithDetail(absl::ResourceExhaustedError(absl::StrFormat(
                          "files take %.6g MB of disk, and %.6g MB more would be beyond the %.6g "
                          "MB that they may "
                          "take together (--%s); all that could go have gone",
                          (taken_ + held_) / 1e6, wanted / 1e6, quota_ / 1e6, flag_)),
                      {kFileQuota, flag_});
  }
  held_ += wanted;
  return std::make_unique<Room>(this, wanted);
}

}  // namespace mortise::rpc
