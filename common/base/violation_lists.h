// Lists of what is wrong with the fields of a request, whether that is one or several.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "common/base/field_violations.h"

namespace mortise {

// Returns what InvalidField or InvalidFields was given. Of an INVALID_ARGUMENT without a field, its
// message with an empty one; nothing of all other statuses.
std::vector<FieldViolation> AllViolationsOf(const absl::Status& status);

// Everything that is wrong by either. A failure that is no INVALID_ARGUMENT stands alone, the first
// before the second. OK if both are.
absl::Status CombineViolations(const absl::Status& first, const absl::Status& second);

}  // namespace mortise
