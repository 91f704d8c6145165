// STEP files that were uploaded for an import: bytes in the blob folder, and a record that says
// since when.
//
// A record is written only while its blob is there, and a blob goes only within a write transaction
// that removes its record: a blob without a record is never left.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/rpc/stream_reactors.h"
#include "common/store/blob_folder.h"
#include "common/store/store.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::catalog {

// Receives one file, at most as large as cad::kMaxStepBytes. RESOURCE_EXHAUSTED naming the limit;
// INVALID_ARGUMENT naming "offset", "data", "total_size" or "sha256". Nothing is kept of an upload
// that breaks off or is refused.
std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadDrawingResponse>> ReceiveDrawing(
    store::Store* store, store::BlobFolder* blobs);

// The bytes of a drawing that was uploaded. INVALID_ARGUMENT, "drawing", for one that was not.
absl::StatusOr<std::string> GetDrawing(store::Store* store, store::BlobFolder* blobs,
                                       const std::string& sha256);

// Forgets the drawings that were last uploaded before `time`. Returns how many.
absl::StatusOr<int64_t> ForgetDrawings(store::Store* store, store::BlobFolder* blobs,
                                       absl::Time time);

}  // namespace mortise::catalog
