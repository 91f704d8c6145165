// Failures of requests that are wrong in several fields at once. In the spirit of errors.h, whose
// InvalidField is for one; DetailOf gives the first, and UnderField prefixes each.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"

namespace mortise {

// One of several things wrong with a request.
struct FieldViolation {
  std::string field;    // as ErrorDetail::field
  std::string message;  // without the field
};

// Fails with INVALID_ARGUMENT, reason FIELD_INVALID: none of these fields is usable. One violation
// gives what InvalidField gives; there must be at least one.
absl::Status InvalidFields(const std::vector<FieldViolation>& violations);

// Returns what InvalidFields was given, if that was more than one; else empty.
std::vector<FieldViolation> ViolationsOf(const absl::Status& status);

}  // namespace mortise
