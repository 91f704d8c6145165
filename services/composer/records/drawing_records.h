// Drawings of models in the store. Each model has its own, so that all of it goes when it goes, and
// nothing is missing when what it came from is gone from the catalog.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/store/store.h"
#include "services/composer/records/drawing.h"

namespace mortise::composer {

// Records hold mortise.v1.AssemblyBundle without shapes, and mortise.v1.Shape; keys are
// "{model id}/{digest}".
inline constexpr char kDrawings[] = "modelDrawings";
inline constexpr char kShapes[] = "modelShapes";

// Keeps a drawing of the model called `model` ("models/desk"); one that it has already stays.
absl::Status PutDrawing(store::Transaction& transaction, const std::string& model,
                        const Drawing& drawing);

// A drawing of a model by its digest. INTERNAL, STORAGE_FAILED where it is missing or damaged.
absl::StatusOr<Drawing> GetDrawing(store::ReadTransaction& transaction, const std::string& model,
                                   const std::string& digest);

}  // namespace mortise::composer
