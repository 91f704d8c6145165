// A picture of a query and what was found for it.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::retrieval {

struct SheetEntry {
  mesh::SurfaceMesh surface;
  std::string caption;
};

// A PNG of all in rows, the first, which is the query, in another colour; each as large as it fits
// into its frame. INVALID_ARGUMENT for no entries or an empty surface.
absl::StatusOr<std::string> DrawMatchSheet(const std::vector<SheetEntry>& entries);

}  // namespace mortise::retrieval
