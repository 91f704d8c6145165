// Pictures of models as Figure 5-7 has them.
#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "common/render/scene.h"
#include "services/composer/service/open_model.h"

namespace mortise::composer {

// Returns the PNG of a model: each component in a colour of its own, what connects it darker; paler
// where it is not connected. FAILED_PRECONDITION, MODEL_EMPTY. Fails also as ModelDrawings::Get.
absl::StatusOr<std::string> DrawPicture(const OpenModel& model, ModelDrawings& drawings, int width,
                                        int height);

// Draws the body of a model, which must be there, as PNG: the parts of these names, as PlacedPart
// says, in these colours, and all else in grey.
absl::StatusOr<std::string> DrawMarkedParts(const OpenModel& model, ModelDrawings& drawings,
                                            const std::map<std::string, render::Color>& marked,
                                            int width, int height);

}  // namespace mortise::composer
