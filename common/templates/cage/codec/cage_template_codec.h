// Reads cage templates from mortise/v1/cage_template.proto and its text form. Target
// mortise_cage_template_codec.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "common/templates/cage/cage_template.h"
#include "mortise/v1/cage_template.pb.h"

namespace mortise::parametric {

// Returns the template as structs. INVALID_ARGUMENT naming every field that structs cannot express:
// coordinates and triangles that do not come in threes, conditions without a kind, heat with both a
// flux and a temperature or neither. Whether the content makes sense is for ValidateCageTemplate.
absl::StatusOr<CageTemplate> FromProto(const v1::CageTemplate& message);

// Writes a template; nothing is lost: FromProto(ToProto(t)) has the content of t.
v1::CageTemplate ToProto(const CageTemplate& definition);

// Reads the text of one file. INVALID_ARGUMENT naming `origin` with every line and column at fault,
// or the fields as FromProto; RESOURCE_EXHAUSTED past 4 MiB.
absl::StatusOr<CageTemplate> ParseCageTemplateText(std::string_view text,
                                                   const std::string& origin);

}  // namespace mortise::parametric
