#include "services/catalog/records/drawing_records.h"

#include <utility>

#include "common/cad/step/step_reader.h"

namespace mortise::catalog {

rpc::UploadedKind Drawings(int64_t most) {
  return {.records = "drawings",
          .field = "drawing",
          .full_reason = "DRAWINGS_FULL",
          .most_in_one = cad::kMaxStepBytes,
          .most_together = most,
          .grace = kDrawingGrace};
}

std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadDrawingResponse>> ReceiveDrawing(
    store::Store* store, store::BlobFolder* blobs, int64_t most) {
  return std::make_unique<rpc::UploadedFileReader<v1::UploadDrawingResponse>>(store, blobs,
                                                                              Drawings(most));
}

absl::StatusOr<std::string> GetDrawing(store::Store* store, store::BlobFolder* blobs,
                                       const std::string& sha256) {
  return rpc::GetUploaded(*store, blobs, Drawings(), sha256);
}

}  // namespace mortise::catalog
