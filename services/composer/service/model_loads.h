// Supports and loads of models, as their templates have them.
#pragma once

#include "absl/status/statusor.h"
#include "mortise/v1/template.pb.h"
#include "services/composer/records/model_drawings.h"
#include "services/composer/service/open_model.h"

namespace mortise::composer {

// Returns a template with the boundary conditions of the body of a model, and nothing else. Fails
// as SupportsAndLoads and ModelDrawings::Get.
absl::StatusOr<v1::Template> LoadsOf(const OpenDesign& body, const OpenModel& model,
                                     ModelDrawings& drawings);

}  // namespace mortise::composer
