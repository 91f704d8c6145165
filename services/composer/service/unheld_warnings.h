// Warnings of parts of a model that nothing holds, or that are held so that they cannot move as
// they are to.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "services/composer/connecting/connect.h"
#include "services/composer/service/open_model.h"

namespace mortise::composer {

// Whether a warning is of parts that nothing holds.
bool IsOfUnheld(const v1::ModelWarning& warning);

// Returns the parts of the body that nothing holds (FindUnheldParts) and that the model does not
// warn of: the designs that it is made of have them so, as they do not tell what is glued.
// `drawing` is the body's. Fails as FindUnheldParts and ContentsOf.
absl::StatusOr<std::set<std::string>> UnheldByDesign(const OpenModel& model,
                                                     const Drawing& drawing);

// The same of parts of a component, as they are called in its own assembly: those that are so in
// the design that it comes from, whose `connections` these are. `whole` is the component where it
// is all of that.
absl::StatusOr<std::set<std::string>> UnheldByDesign(
    const Design& whole, const std::vector<CollectionConnection>& connections,
    const Drawing& drawing);

// Makes the model warn of what of its body nothing holds now, but for what is all of `by_design`,
// and of nothing that is held again. Fails as FindUnheldParts and ContentsOf.
absl::Status WarnOfUnheld(const std::set<std::string>& by_design, const Drawing& drawing,
                          OpenModel* model);

// What is by its design where no fastener holds the component to the body it was connected to.
struct UnheldBefore {
  std::set<std::string> component;  // parts of it, as its assembly calls them
  std::set<std::string> body;       // parts of the body before
};

// The same after a component was connected: of what was warned of before, of the component, and,
// where nothing fastens the two, of what has become of the body. Nothing new is said of what is as
// it was in its design.
absl::Status WarnOfUnheldNow(const Connected& connected, const UnheldBefore& before,
                             const Drawing& drawing, OpenModel* model);

// Whether any fastener holds a component to the body.
bool IsFastened(const Connected& connected);

}  // namespace mortise::composer
