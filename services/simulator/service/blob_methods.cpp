#include "services/simulator/service/blob_methods.h"

#include <cstdint>

#include "common/base/errors.h"
#include "common/host/chunk_stream.h"
#include "common/store/blob_folder.h"

namespace mortise::simulator::methods {
namespace {

constexpr int64_t kBlobLimit = int64_t{1} << 30;

using Reader = rpc::UploadReader<v1::Chunk, v1::UploadBlobResponse>;

// Receives a blob.
class BlobReader final : public Reader {
 public:
  explicit BlobReader(store::BlobFolder* blobs) : assembler_(blobs, kBlobLimit) {}

  absl::Status OnMessage(const v1::Chunk& chunk) override { return assembler_.Append(chunk); }

  absl::StatusOr<v1::UploadBlobResponse> Complete() override {
    v1::UploadBlobResponse response;
    MORTISE_ASSIGN_OR_RETURN(*response.mutable_sha256(), assembler_.Finish());
    return response;
  }

 private:
  rpc::ChunkAssembler assembler_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Reader>> UploadBlob(const Simulator& simulator, const rpc::Call&) {
  return std::make_unique<BlobReader>(simulator.blobs);
}

absl::Status DownloadBlob(const Simulator& simulator, const rpc::Call&,
                          const v1::DownloadBlobRequest& asked,
                          const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
  const absl::Status there = simulator.blobs->Size(asked.sha256()).status();
  if (absl::IsInvalidArgument(there)) {
    return InvalidField("sha256", "must be 64 lower-case hexadecimal digits");
  }
  MORTISE_RETURN_IF_ERROR(there);
  rpc::StreamBlob(simulator.blobs, asked.sha256(), {asked.sha256(), "application/octet-stream"},
                  writer);
  return absl::OkStatus();
}

}  // namespace mortise::simulator::methods
