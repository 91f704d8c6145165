// Converts the ground of templates between structs and the messages of mortise/v1/template.proto.
// Target mortise_files; only adapters use it.
#pragma once

#include <google/protobuf/repeated_ptr_field.h>

#include <string>
#include <vector>

#include "common/base/field_violations.h"
#include "common/design/template_definition.h"
#include "mortise/v1/template.pb.h"

namespace mortise::parametric {

// Returns the ground of a template, its datum taken off, and findings about what cannot be read
// ("height_fields[0].grid.heights[7]"), for which flat ground stands. Names are not checked.
std::vector<Ground> ReadGrounds(const google::protobuf::RepeatedPtrField<v1::HeightField>& messages,
                                std::vector<FieldViolation>& findings);

// Returns ground as a message whose datum is 0.
v1::HeightField ToProto(const Ground& ground);

// Returns the SHA-256 of the heights, where they lie and their datum.
std::string HeightsDigest(const v1::HeightField& message);

}  // namespace mortise::parametric
