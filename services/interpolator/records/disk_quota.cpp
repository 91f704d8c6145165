#include "services/interpolator/records/disk_quota.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/store/blob_upkeep.h"

namespace mortise::interpolator {

DiskQuota::Build::Build(DiskQuota* quota) : quota_(quota) {
  const std::lock_guard lock(quota_->mutex_);
  quota_->of_maps_.reset();
}

DiskQuota::Build::~Build() {
  const std::lock_guard lock(quota_->mutex_);
  quota_->of_builds_ -= static_cast<double>(bytes_);
  quota_->of_maps_.reset();
}

std::int64_t DiskQuota::Build::bytes() const {
  const std::lock_guard lock(quota_->mutex_);
  return bytes_;
}

// Of maps and builds. The mutex is held by who calls it.
absl::StatusOr<double> DiskQuota::Taken() {
  if (!of_maps_) {
    MORTISE_ASSIGN_OR_RETURN(of_maps_, bytes_of_maps_());
  }
  return static_cast<double>(*of_maps_) + of_builds_;
}

absl::Status DiskQuota::Build::Take(std::int64_t bytes) {
  const std::lock_guard lock(quota_->mutex_);
  return TakeLocked(bytes);
}

absl::Status DiskQuota::Build::TakeFile(const std::string& digest, std::int64_t bytes) {
  const std::lock_guard lock(quota_->mutex_);
  if (files_.contains(digest)) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(TakeLocked(bytes));
  files_.insert(digest);
  return absl::OkStatus();
}

// The mutex is held by who calls it.
absl::Status DiskQuota::Build::TakeLocked(std::int64_t bytes) {
  const auto more = static_cast<double>(bytes);
  MORTISE_ASSIGN_OR_RETURN(double taken, quota_->Taken());
  if (taken + more > quota_->quota_) {
    // Some may have been deleted meanwhile.
    quota_->of_maps_.reset();
    MORTISE_ASSIGN_OR_RETURN(taken, quota_->Taken());
  }
  if (taken + more > quota_->quota_) {
    return WithDetail(
        absl::ResourceExhaustedError(absl::StrFormat(
            "maps take %.6g MB of disk, %.6g MB of them those being built, and %.6g MB more would "
            "be beyond the %.6g MB that they may take together (--map-disk-quota); delete maps "
            "that nobody asks, or evaluate fewer designs",
            taken / 1e6, quota_->of_builds_ / 1e6, more / 1e6, quota_->quota_ / 1e6)),
        {"DISK_QUOTA", "map-disk-quota"});
  }
  bytes_ += bytes;
  quota_->of_builds_ += more;
  return absl::OkStatus();
}

namespace {

// Writes the bytes, also where a file of this name is there that is not what it was.
absl::Status Write(store::BlobFolder& blobs, const std::string& digest, std::string_view bytes) {
  if (absl::IsDataLoss(blobs.Get(digest).status())) MORTISE_RETURN_IF_ERROR(blobs.Remove(digest));
  MORTISE_RETURN_IF_ERROR(blobs.Put(bytes).status());
  // The same file may be there from a map that was deleted, and about to be removed.
  const absl::Status touched = store::TouchBlob(blobs, digest);
  if (!absl::IsNotFound(touched)) return touched;
  // It was removed just then. What is written anew stays.
  return blobs.Put(bytes).status();
}

}  // namespace

absl::StatusOr<std::string> PutFile(store::BlobFolder& blobs, DiskQuota::Build& build,
                                    std::string_view bytes) {
  std::string digest = Sha256Hex(bytes);
  MORTISE_RETURN_IF_ERROR(build.TakeFile(digest, static_cast<std::int64_t>(bytes.size())));
  const absl::Status written = Write(blobs, digest, bytes);
  if (store::IsDiskFull(written)) {
    return WithDetail(
        absl::ResourceExhaustedError(absl::StrCat("the map cannot be stored: ", written.message())),
        {"DISK_FULL", DetailOf(written).field});
  }
  MORTISE_RETURN_IF_ERROR(written);
  return digest;
}

}  // namespace mortise::interpolator
