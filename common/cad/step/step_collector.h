// Collects what stands in a document that was read from a STEP file. Private to this folder: it
// brings Open CASCADE.
#pragma once

#include <TDocStd_Document.hxx>
#include <TopTools_MapOfShape.hxx>

#include "absl/status/statusor.h"
#include "common/cad/step/step_assembly.h"
#include "common/cad/step/step_operators.h"
#include "common/cad/step/step_places.h"
#include "common/cad/step/step_reader.h"

namespace mortise::cad {

// Adds groups, products, parts, shapes, leaves and notes of the document's tree to `assembly`, all
// but distinct names (NameAll). A product that stands mirrored becomes a product of its own, unless
// it is its own mirror image. Returns the shapes of the leaves, and what these are compounds of,
// unplaced. Fails with INVALID_ARGUMENT or RESOURCE_EXHAUSTED, "step". `progress`, if it is set, is
// told of each solid.
absl::StatusOr<TopTools_MapOfShape> CollectParts(const Handle(TDocStd_Document) & document,
                                                 const StepOperators& operators,
                                                 const StepPlaces& places,
                                                 const StepProgress& progress,
                                                 StepAssembly& assembly);

}  // namespace mortise::cad
