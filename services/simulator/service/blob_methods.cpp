#include "services/simulator/service/blob_methods.h"

#include <cstdint>
#include <memory>

#include "common/base/errors.h"
#include "common/host/chunk_stream.h"
#include "common/host/file_quota.h"
#include "common/store/blob_folder.h"
#include "common/store/blob_upkeep.h"

namespace mortise::simulator::methods {
namespace {

constexpr int64_t kBlobLimit = int64_t{1} << 30;

using Reader = rpc::UploadReader<v1::Chunk, v1::UploadBlobResponse>;

// Receives a blob.
class BlobReader final : public Reader {
 public:
  BlobReader(store::BlobFolder* blobs, rpc::FileQuota* quota)
      : assembler_(blobs, kBlobLimit), quota_(quota) {}

  absl::Status OnMessage(const v1::Chunk& chunk) override {
    // The assembler refuses what is larger.
    if (room_ == nullptr && chunk.total_size() > 0 && chunk.total_size() <= kBlobLimit) {
      MORTISE_ASSIGN_OR_RETURN(room_, quota_->MakeRoom(chunk.total_size()));
    }
    return assembler_.Append(chunk);
  }

  absl::StatusOr<v1::UploadBlobResponse> Complete() override {
    v1::UploadBlobResponse response;
    MORTISE_ASSIGN_OR_RETURN(*response.mutable_sha256(), assembler_.Finish());
    if (room_ != nullptr) room_->Keep();
    return response;
  }

 private:
  rpc::ChunkAssembler assembler_;
  rpc::FileQuota* const quota_;
  std::unique_ptr<rpc::FileQuota::Room> room_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Reader>> UploadBlob(const Simulator& simulator, const rpc::Call&) {
  return std::make_unique<BlobReader>(simulator.blobs, simulator.quota);
}

absl::Status DownloadBlob(const Simulator& simulator, const rpc::Call&,
                          const v1::DownloadBlobRequest& asked,
                          const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
  // What is fetched is not the first to go where room is wanted.
  const absl::Status there = store::TouchBlob(*simulator.blobs, asked.sha256());
  if (absl::IsInvalidArgument(there)) {
    return InvalidField("sha256", "must be 64 lower-case hexadecimal digits");
  }
  MORTISE_RETURN_IF_ERROR(there);
  rpc::StreamBlob(simulator.blobs, asked.sha256(), {asked.sha256(), "application/octet-stream"},
                  writer);
  return absl::OkStatus();
}

}  // namespace mortise::simulator::methods
