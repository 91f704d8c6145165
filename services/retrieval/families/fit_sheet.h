// A picture of a query beside the designs that were fitted to it.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::retrieval {

struct FitSheetEntry {
  mesh::SurfaceMesh surface;  // of the design, where it stands in the query's frame
  std::string caption;
};

// A PNG with a row for each design: the query, the design, and both in one place, the query's edges
// over the design, all three seen from the same side at the same size. INVALID_ARGUMENT for no
// entries or an empty surface.
absl::StatusOr<std::string> DrawFitSheet(const FitSheetEntry& query,
                                         const std::vector<FitSheetEntry>& designs);

}  // namespace mortise::retrieval
