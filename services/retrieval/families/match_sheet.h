// A picture of a query and what was found for it.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "common/render/image.h"

namespace mortise::retrieval {

// A shape from above and the front right, as large as it fits. INVALID_ARGUMENT for an empty
// surface; sizes in pixels, as render::RenderOptions.
absl::StatusOr<render::Image> DrawSurface(const mesh::SurfaceMesh& surface,
                                          const render::Color& color, int width, int height);

struct SheetEntry {
  mesh::SurfaceMesh surface;
  std::string caption;
};

// A PNG of all in rows, the first, which is the query, in another colour; each as large as it fits
// into its frame. INVALID_ARGUMENT for no entries or an empty surface.
absl::StatusOr<std::string> DrawMatchSheet(const std::vector<SheetEntry>& entries);

}  // namespace mortise::retrieval
