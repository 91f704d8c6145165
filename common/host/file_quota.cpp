#include "common/host/file_quota.h"

#include <utility>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
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
  quota_->taken_ += adds_;
  quota_->added_in_look_ += adds_;
}

absl::Status FileQuota::Room::Grow(std::int64_t bytes) {
  const auto more = static_cast<double>(bytes);
  MORTISE_RETURN_IF_ERROR(quota_->Take(more));
  bytes_ += more;
  return absl::OkStatus();
}

absl::Status FileQuota::CheckSize(std::int64_t bytes) const {
  const auto wanted = static_cast<double>(bytes);
  if (wanted <= quota_) return absl::OkStatus();
  return WithDetail(absl::ResourceExhaustedError(absl::StrFormat(
                        "a file of %.6g MB is beyond the %.6g MB that all files may take "
                        "together (--%s)",
                        wanted / 1e6, quota_ / 1e6, flag_)),
                    {kFileBeyondQuota, flag_});
}

absl::Status FileQuota::Take(double bytes) {
  bool is_due = false;
  std::int64_t looks = 0;
  {
    const std::lock_guard lock(mutex_);
    is_due = looked_at_ && store_->Now() - *looked_at_ > kLookAgain;
    if (is_due) looked_at_ = store_->Now();  // one is enough: others go on meanwhile
    looks = looks_;
  }
  if (!is_due && TakeIfThere(bytes)) return absl::OkStatus();
  const std::lock_guard looking(looking_);
  if (is_due) MORTISE_RETURN_IF_ERROR(Look(bytes).status());
  while (!TakeIfThere(bytes)) {
    // Of many that wait here while nothing can go, one looks.
    if (in_vain_ > looks) return Full(bytes);
    MORTISE_ASSIGN_OR_RETURN(const bool is_gone, Look(bytes));
    if (!is_gone) return TakeIfThere(bytes) ? absl::OkStatus() : Full(bytes);
  }
  return absl::OkStatus();
}

bool FileQuota::TakeIfThere(double bytes) {
  const std::lock_guard lock(mutex_);
  if (!looked_at_ || Lacking(bytes) > 0) return false;
  held_ += bytes;
  return true;
}

// Counts the files, and lets the oldest go as far as there is too little room. Returns whether some
// are gone. The caller has locked looking_.
absl::StatusOr<bool> FileQuota::Look(double wanted) {
  double most = 0;
  std::int64_t look = 0;
  {
    const std::lock_guard lock(mutex_);
    most = quota_ - held_ - wanted;
    added_in_look_ = 0;
    look = ++looks_;
  }
  MORTISE_ASSIGN_OR_RETURN(const TidiedFiles files,
                           RemoveOldestFiles(*store_, *operations_, folder_, named_,
                                             {.most = most, .ahead = kAhead * quota_}));
  if (files.removed.count > 0) {
    Log(LogLevel::kInfo, "removed the oldest files to make room",
        {{"files", files.removed.count}, {"bytes", files.removed.bytes}});
  }
  const std::lock_guard lock(mutex_);
  // What came meanwhile may have been seen or not.
  taken_ = files.left + added_in_look_;
  looked_at_ = store_->Now();
  if (files.left > most && files.removed.count == 0) in_vain_ = look;
  return files.removed.count > 0;
}

absl::Status FileQuota::Full(double bytes) {
  const std::lock_guard lock(mutex_);
  return WithDetail(absl::ResourceExhaustedError(absl::StrFormat(
                        "files take %.6g MB of disk, and %.6g MB more would be beyond the %.6g MB "
                        "that they may take together (--%s); all that could go have gone",
                        (taken_ + held_) / 1e6, bytes / 1e6, quota_ / 1e6, flag_)),
                    {kFileQuota, flag_});
}

}  // namespace mortise::rpc
