// STEP files of import requests, read: sent with the request, or uploaded before.
#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/cad/step/step_assembly.h"

namespace mortise::store {
class BlobFolder;
class Store;
}  // namespace mortise::store

namespace mortise::catalog {

// What a file shows; its shapes have names.
using Drawing = std::shared_ptr<const cad::StepAssembly>;

// Thread safe. Remembers the latest files, 128 MiB of them, and reads one once for all who ask at
// the same time: those who write annotations send the same one again and again.
class DrawingSource {
 public:
  // Both outlive it.
  DrawingSource(store::Store* store, store::BlobFolder* blobs);

  // Of the file itself, or of one that was uploaded, by its digest. Fails as UnpackStep, GetDrawing
  // and cad::ReadStepInChild do; INVALID_ARGUMENT, "drawing", for both.
  absl::StatusOr<Drawing> Read(const std::string& step, const std::string& drawing);

 private:
  store::Store* const store_;
  store::BlobFolder* const blobs_;
  SingleFlightCache<Drawing> read_;  // by digest of the file
};

// What is said of "step", said of "drawing": of a file that was uploaded.
absl::Status OfUpload(const absl::Status& status);

}  // namespace mortise::catalog
