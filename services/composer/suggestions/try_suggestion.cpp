#include "services/composer/suggestions/try_suggestion.h"

#include <string>

#include "services/composer/snapping/snap.h"

namespace mortise::composer {

SuggestionTrial TryComponent(const Design& body, const Design& dropped, const std::string& name,
                             const Original* original,
                             const std::vector<const CollectionConnection*>& others,
                             const ConnectOptions& options) {
  using Outcome = SuggestionTrial::Outcome;
  const absl::StatusOr<Snapped> snapped =
      Snap(dropped, original == nullptr ? nullptr : &original->design, body);
  if (!snapped.ok()) return {Outcome::kFitsNot, std::string(snapped.status().message())};
  const absl::StatusOr<ConnectTrial> made =
      TryToConnect(body, snapped->component, name, original, others, options);
  if (!made.ok()) return {Outcome::kFitsNot, std::string(made.status().message())};
  if (!made->is_fastened) return {Outcome::kFitsNot, "nothing fastens it"};
  if (made->warnings.empty()) return {Outcome::kFits, ""};
  return {Outcome::kHeldInPart, made->warnings.front().text};
}

}  // namespace mortise::composer
