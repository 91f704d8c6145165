// Pictures of shapes in rows, as Figures 4-10, 4-12 and 4-14 have them.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "common/render/image.h"

namespace mortise::retrieval {

class ShapeSheet {
 public:
  // What a shape is, which its colour tells: as in Figure 4-14.
  enum class Kind { kQuery, kMeanShape, kDesign };

  explicit ShapeSheet(int columns) : columns_(columns) {}

  // The next picture of the row, or of the next one. INVALID_ARGUMENT for an empty surface.
  absl::Status Add(const mesh::SurfaceMesh& surface, Kind kind, const std::string& caption);

  // A small white picture where nothing was added.
  absl::StatusOr<render::Image> Draw() const;

 private:
  int columns_;
  std::vector<render::Image> pictures_;
  std::vector<std::string> captions_;
};

}  // namespace mortise::retrieval
