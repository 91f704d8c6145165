// External ids and labels in cells of comma-separated values; lists have semicolons between their
// entries, as all lists in cells do.
#pragma once

#include <google/protobuf/map.h>
#include <google/protobuf/repeated_ptr_field.h>

#include <string>

#include "absl/status/status.h"

namespace mortise::parametric {

// Adds the external ids of a cell, "100-4711/A; 4711": the space around each is none of it. Whether
// they may be such is not looked at.
void ReadExternalIds(const std::string& text,
                     google::protobuf::RepeatedPtrField<std::string>* external_ids);

// Adds the labels of a cell, "site=Hamburg; stocked": a value ends at the next semicolon, and is
// empty where there is no equals sign. INVALID_ARGUMENT, without a field, for a key that is there
// twice. Whether they may be such is not looked at.
absl::Status ReadLabels(const std::string& text,
                        google::protobuf::Map<std::string, std::string>* labels);

}  // namespace mortise::parametric
