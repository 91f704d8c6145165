// Meshes that are too large for a message and were uploaded for a search (host/uploaded_files.h).
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/base/repeated_work.h"
#include "common/rpc/stream_reactors.h"
#include "mortise/v1/retrieval.pb.h"

namespace mortise::store {
class BlobFolder;
class Store;
}  // namespace mortise::store

namespace mortise::retrieval {

// The kind of their records, whose keys are the digests of their files.
inline constexpr char kMeshRecords[] = "meshes";

// Thread safe. Every hour it forgets what was last uploaded a day ago or longer, on a thread of its
// own, and removes uploads that broke off with the process that received them.
class UploadedMeshes {
 public:
  // Store and blobs, which are in `folder`, outlive it.
  UploadedMeshes(store::Store* store, store::BlobFolder* blobs,
                 const std::filesystem::path& folder);

  // Receives one file of at most 64 MiB. RESOURCE_EXHAUSTED naming the limit, reason UPLOADS_FULL
  // where all meshes together would take more than 2 GiB or be more than 4,000; INVALID_ARGUMENT
  // naming "offset", "data", "total_size" or "sha256". Nothing is kept of an upload that breaks off
  // or is refused.
  std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadMeshResponse>> Receive() const;

  // Returns the bytes of a mesh that was uploaded. INVALID_ARGUMENT, "upload", for one that was
  // not.
  absl::StatusOr<std::string> Get(const std::string& sha256) const;

 private:
  store::Store* const store_;
  store::BlobFolder* const blobs_;
  const RepeatedWork tidying_;
};

}  // namespace mortise::retrieval
