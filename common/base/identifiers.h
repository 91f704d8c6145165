// Identifiers and resource names ("templates/table", "operations/pareto/0198c1…").
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise {

// Returns a new unique identifier: 26 lower-case letters and digits, of which the first ten are the
// time in milliseconds, so that identifiers sort by age. Those of one process sort strictly by age,
// also within a millisecond and after its clock was set back. Not a secret: one may tell the next.
// Thread safe.
std::string NewIdentifier();

// Whether `text` can be one segment of a resource name: 1 to 63 characters, lower-case letters,
// digits and hyphens, starting and ending with a letter or digit.
bool IsResourceId(std::string_view text);

// Splits "templates/table" after checking that it has the form collection/id, with `collection` as
// given; returns the id. INVALID_ARGUMENT naming `field` otherwise.
absl::StatusOr<std::string> ParseResourceName(std::string_view name, std::string_view collection,
                                              std::string_view field);

}  // namespace mortise
