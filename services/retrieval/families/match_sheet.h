// Pictures of a query, of what was found for it, and of what was fitted to it.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "common/render/image.h"

namespace mortise::retrieval {

// Returns a shape from above and the front right, as large as it fits. INVALID_ARGUMENT for an
// empty surface; sizes in pixels, as render::RenderOptions.
absl::StatusOr<render::Image> DrawSurface(const mesh::SurfaceMesh& surface,
                                          const render::Color& color, int width, int height);

struct SheetEntry {
  mesh::SurfaceMesh surface;
  std::string caption;
};

// Returns a PNG of all in rows, the first, which is the query, in another colour; each as large as
// it fits into its frame. INVALID_ARGUMENT for no entries or an empty surface.
absl::StatusOr<std::string> DrawMatchSheet(const std::vector<SheetEntry>& entries);

// A design as it was fitted, and what is written below it and the query in one place, as how far
// the two are off each other.
struct FitEntry {
  SheetEntry design;
  std::string comparison;
};

// Returns a PNG with a row for each design, which stands where it does in the query's frame: the
// query, the design, and both in one place, the query's edges over the design, all three seen from
// the same side at the same size. INVALID_ARGUMENT for no designs or an empty surface.
absl::StatusOr<std::string> DrawFitSheet(const SheetEntry& query,
                                         const std::vector<FitEntry>& designs);

}  // namespace mortise::retrieval
