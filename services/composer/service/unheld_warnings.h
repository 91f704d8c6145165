// Warnings of parts of a model that nothing holds any more.
#pragma once

#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "services/composer/service/open_model.h"

namespace mortise::composer {

// Whether a warning is of parts that nothing holds.
bool IsOfUnheld(const v1::ModelWarning& warning);

// Returns the parts of the body that nothing holds and that the model does not warn of: the designs
// that it is made of have them so, as they do not tell what is glued. Fails as FindUnheldParts.
absl::StatusOr<std::set<std::string>> UnheldByDesign(const OpenModel& model);

// Makes the model warn of what of its body nothing holds now, but for what is all of `by_design`,
// and of nothing that is held again. Fails as FindUnheldParts.
absl::Status WarnOfUnheld(const std::set<std::string>& by_design, OpenModel* model);

// The same after parts have come to the body: what was not warned of before is as their designs
// have it.
absl::Status WarnOfStillUnheld(OpenModel* model);

}  // namespace mortise::composer
