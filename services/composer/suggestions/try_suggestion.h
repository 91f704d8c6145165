// Tries what is suggested, before it is said to fit.
#pragma once

#include <vector>

#include "services/composer/connecting/connect.h"
#include "services/composer/suggestions/suggest.h"

namespace mortise::composer {

// Returns what becomes of a component, dropped where it is, when it is snapped to the body and
// connected as Snap and Connect do without being told anything else. `name` is what it would be
// called in the model. `original` is the design that it is a sub-tree of, null where it is all of
// it. What comes to be held by nothing but its place does not fit.
SuggestionTrial TryComponent(const Design& body, const Design& dropped, const std::string& name,
                             const Original* original,
                             const std::vector<const CollectionConnection*>& others,
                             const ConnectOptions& options);

}  // namespace mortise::composer
