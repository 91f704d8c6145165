// STEP files and meshes of import requests, read: sent with the request, or uploaded before.
#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/cad/step/step_assembly.h"
#include "common/cad/step/step_isolation.h"
#include "services/catalog/exchange/mesh_drawing.h"

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
  // and cad::ReadStepInChild do, with its `options`; INVALID_ARGUMENT, "drawing", for both.
  absl::StatusOr<Drawing> Read(const std::string& step, const std::string& drawing,
                               const cad::StepChildOptions& options = {});

  // The same of a mesh (DrawingOfScene), which the whole is called after by `file_name`. Fails as
  // mesh::ReadScene and DrawingOfScene do, "file"; INVALID_ARGUMENT, "drawing", for both.
  absl::StatusOr<Drawing> ReadMesh(const std::string& file, const std::string& drawing,
                                   const std::string& file_name, const MeshDrawingOptions& options);

 private:
  // Returns the bytes that were sent or uploaded; `field` is that of those that were sent.
  absl::StatusOr<std::string> BytesOf(const std::string& sent, const std::string& drawing,
                                      const char* field);

  store::Store* const store_;
  store::BlobFolder* const blobs_;
  SingleFlightCache<Drawing> read_;  // by digest of the file
};

// What is said of the field `from`, said of `to`: of "step", where it is about a mesh ("file") or a
// file that was uploaded ("drawing").
absl::Status RenameField(const absl::Status& status, const std::string& from,
                         const std::string& to);

}  // namespace mortise::catalog
