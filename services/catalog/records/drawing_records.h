// Drawings, STEP files and meshes, that were uploaded for an import (host/uploaded_files.h).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/host/uploaded_files.h"
#include "common/rpc/stream_reactors.h"
#include "common/store/blob_folder.h"
#include "common/store/store.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::catalog {

// How much all drawings may take together, bytes.
inline constexpr int64_t kMaxDrawingBytes = int64_t{2} << 30;

// How long a drawing is not forgotten to make room for others: who uploads one is about to import
// it.
inline constexpr absl::Duration kDrawingGrace = absl::Hours(1);

// Returns what drawings are among uploads. `most`: bytes of all together.
rpc::UploadedKind Drawings(int64_t most = kMaxDrawingBytes);

// Receives one file, at most as large as cad::kMaxStepBytes. If all drawings together would take
// more than `most` bytes, or be more than 4,000, those that were last uploaded longest ago are
// forgotten, but none within kDrawingGrace. RESOURCE_EXHAUSTED naming the limit, reason
// DRAWINGS_FULL if it is one of all together; INVALID_ARGUMENT naming "offset", "data",
// "total_size" or "sha256". Nothing is kept of an upload that breaks off or is refused.
std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadDrawingResponse>> ReceiveDrawing(
    store::Store* store, store::BlobFolder* blobs, int64_t most = kMaxDrawingBytes);

// Returns the bytes of a drawing that was uploaded. INVALID_ARGUMENT, "drawing", for one that was
// not.
absl::StatusOr<std::string> GetDrawing(store::Store* store, store::BlobFolder* blobs,
                                       const std::string& sha256);

}  // namespace mortise::catalog
