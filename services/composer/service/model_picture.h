// Pictures of models as Figure 5-7 has them.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "services/composer/service/open_model.h"

namespace mortise::composer {

// Returns the PNG of a model: each component in a colour of its own, what connects it darker; paler
// where it is not connected. FAILED_PRECONDITION, MODEL_EMPTY. Fails also as ModelDrawings::Get.
absl::StatusOr<std::string> DrawPicture(const OpenModel& model, ModelDrawings& drawings, int width,
                                        int height);

}  // namespace mortise::composer
