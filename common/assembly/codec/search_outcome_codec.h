// What the searches of a parametrisation came to, as bytes to keep. Target mortise_assembly_codec.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/assembly/trial/search_outcome.h"

namespace mortise::parametric {

// Returns the outcome as JSON text, with the version of the searches (kSearchVersion).
std::string ToText(const SearchOutcome& outcome);

// Returns the outcome that ToText has written; nothing for one of another version, and for text
// that is damaged.
std::optional<SearchOutcome> SearchOutcomeFrom(std::string_view text);

}  // namespace mortise::parametric
