#include "services/retrieval/service/uploaded_meshes.h"

#include <chrono>
#include <utility>

#include "absl/time/clock.h"
#include "common/base/logging.h"
#include "common/host/uploaded_files.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"
#include "common/store/blob_upkeep.h"
#include "common/store/store.h"

namespace mortise::retrieval {
namespace {

constexpr std::chrono::hours kPause{1};

rpc::UploadedKind Meshes() {
  return {.records = "meshes",
          .field = "upload",
          .full_reason = "UPLOADS_FULL",
          .most_in_one = mesh::kMaxSceneBytes};
}

}  // namespace

UploadedMeshes::UploadedMeshes(store::Store* store, store::BlobFolder* blobs,
                               std::filesystem::path folder)
    : store_(store),
      blobs_(blobs),
      folder_(std::move(folder)),
      tidying_(kPause, [this] { Tidy(); }) {}

std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadMeshResponse>> UploadedMeshes::Receive()
    const {
  return std::make_unique<rpc::UploadedFileReader<v1::UploadMeshResponse>>(store_, blobs_,
                                                                           Meshes());
}

absl::StatusOr<std::string> UploadedMeshes::Get(const std::string& sha256) const {
  return rpc::GetUploaded(*store_, blobs_, Meshes(), sha256);
}

void UploadedMeshes::Tidy() const {
  const auto forgotten = rpc::ForgetUploaded(*store_, blobs_, Meshes(), store_->Now() - kMeshLife);
  if (!forgotten.ok()) {
    Log(LogLevel::kWarning, "old meshes could not be removed",
        {{"error", forgotten.status().ToString()}});
  } else if (*forgotten > 0) {
    Log(LogLevel::kInfo, "forgot meshes that were uploaded", {{"meshes", *forgotten}});
  }
  const auto abandoned = store::RemoveAbandonedParts(folder_, absl::Now() - kMeshLife);
  if (!abandoned.ok()) {
    Log(LogLevel::kWarning, "unfinished uploads could not be removed",
        {{"error", abandoned.status().ToString()}});
  }
}

}  // namespace mortise::retrieval
