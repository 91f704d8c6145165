#include "services/retrieval/service/uploaded_meshes.h"

#include <chrono>

#include "common/host/uploaded_files.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"
#include "common/store/store.h"

namespace mortise::retrieval {
namespace {

constexpr std::chrono::hours kPause{1};

rpc::UploadedKind Meshes() {
  return {.records = kMeshRecords,
          .field = "upload",
          .full_reason = "UPLOADS_FULL",
          .most_in_one = mesh::kMaxSceneBytes};
}

}  // namespace

UploadedMeshes::UploadedMeshes(store::Store* store, store::BlobFolder* blobs,
                               const std::filesystem::path& folder)
    : store_(store), blobs_(blobs), tidying_(kPause, [store, blobs, folder] {
        rpc::TidyUploads(*store, blobs, folder, Meshes());
      }) {}

std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadMeshResponse>> UploadedMeshes::Receive()
    const {
  return std::make_unique<rpc::UploadedFileReader<v1::UploadMeshResponse>>(store_, blobs_,
                                                                           Meshes());
}

absl::StatusOr<std::string> UploadedMeshes::Get(const std::string& sha256) const {
  return rpc::GetUploaded(*store_, blobs_, Meshes(), sha256);
}

}  // namespace mortise::retrieval
