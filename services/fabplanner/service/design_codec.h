// From the messages of the catalog to what the planner makes. Only adapters use it.
#pragma once

#include "absl/status/statusor.h"
#include "mortise/v1/catalog.pb.h"
#include "services/fabplanner/plan/design.h"

namespace mortise::fabplanner {

// Reads the design to make: parts, whatever their shape and whether they are of items, and pegs.
// INVALID_ARGUMENT naming the field at fault.
absl::StatusOr<Design> DesignFrom(const v1::EvaluatedDesign& evaluated);

// Adds what the drawing, if it has parts, says of the design's: their sub-assemblies, titles and
// repetitions. Parts that it does not have stay as they are.
void AddDrawing(const v1::Assembly& assembly, Design* design);

// Reads the items of the bundle.
absl::StatusOr<Items> ItemsFrom(const v1::TemplateBundle& bundle);

}  // namespace mortise::fabplanner
