// Templates that a request names.
#pragma once

#include <google/protobuf/repeated_ptr_field.h>

#include <string>

#include "absl/status/status.h"

namespace mortise::retrieval {

// Fails with INVALID_ARGUMENT naming "templates" where there are more than 1000, and "templates[2]"
// that is no name of a template. Whether there is such a template is not asked.
absl::Status CheckTemplateNames(const google::protobuf::RepeatedPtrField<std::string>& templates);

// Returns a template, or a group of its assembly, as captions have it: "table"; "cabinet, drawer".
std::string ShownName(const std::string& template_name, const std::string& group);

}  // namespace mortise::retrieval
