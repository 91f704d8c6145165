#include "services/simulator/service/blob_methods.h"

#include <cstdint>
#include <memory>
#include <string>

#include "common/base/errors.h"
#include "common/host/chunk_stream.h"
#include "common/host/file_quota.h"
#include "common/store/blob_folder.h"
#include "services/simulator/service/file_upkeep.h"

namespace mortise::simulator::methods {
namespace {

constexpr int64_t kBlobLimit = int64_t{1} << 30;

using Reader = rpc::UploadReader<v1::Chunk, v1::UploadBlobResponse>;

// Receives a blob. It takes room as it comes: an upload that only says how large it will be takes
// nothing from others.
class BlobReader final : public Reader {
 public:
  BlobReader(store::BlobFolder* blobs, rpc::FileQuota* quota)
      : blobs_(blobs), assembler_(blobs, kBlobLimit), quota_(quota), room_(quota) {}

  absl::Status OnMessage(const v1::Chunk& chunk) override {
    MORTISE_RETURN_IF_ERROR(assembler_.Check(chunk));
    MORTISE_RETURN_IF_ERROR(quota_->CheckSize(chunk.total_size()));
    MORTISE_RETURN_IF_ERROR(room_.Grow(static_cast<int64_t>(chunk.data().size())));
    return assembler_.Append(chunk);
  }

  absl::StatusOr<v1::UploadBlobResponse> Complete() override {
    MORTISE_ASSIGN_OR_RETURN(const std::string digest, assembler_.Digest());
    const bool is_new = !blobs_->Size(digest).ok();
    v1::UploadBlobResponse response;
    MORTISE_ASSIGN_OR_RETURN(*response.mutable_sha256(), assembler_.Finish());
    room_.Keep(is_new);
    return response;
  }

 private:
  store::BlobFolder* const blobs_;
  rpc::ChunkAssembler assembler_;
  rpc::FileQuota* const quota_;
  rpc::FileQuota::Room room_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Reader>> UploadBlob(const Simulator& simulator, const rpc::Call&) {
  return std::make_unique<BlobReader>(simulator.blobs, simulator.quota);
}

absl::Status DownloadBlob(const Simulator& simulator, const rpc::Call&,
                          const v1::DownloadBlobRequest& asked,
                          const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
  // What is fetched is not the first to go where room is wanted.
  const absl::Status there = KeepYoung(*simulator.blobs, asked.sha256());
  if (absl::IsInvalidArgument(there)) {
    return InvalidField("sha256", "must be 64 lower-case hexadecimal digits");
  }
  MORTISE_RETURN_IF_ERROR(there);
  rpc::StreamBlob(simulator.blobs, asked.sha256(), {asked.sha256(), "application/octet-stream"},
                  writer);
  return absl::OkStatus();
}

}  // namespace mortise::simulator::methods
