// Reads CAD templates from mortise/v1/cad_template.proto and its text form. Target
// mortise_cad_template_codec.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "common/templates/features/cad_template.h"
#include "mortise/v1/cad_template.pb.h"

namespace mortise::cad {

// Returns the template as structs. INVALID_ARGUMENT naming every field that structs cannot express:
// features without a kind, profiles without a shape, unknown operations. Whether the content makes
// sense is for ValidateCadTemplate.
absl::StatusOr<CadTemplate> FromProto(const v1::CadTemplate& message);

// Writes a template; nothing is lost: FromProto(ToProto(t)) has the content of t.
v1::CadTemplate ToProto(const CadTemplate& definition);

// Reads the text of one file. INVALID_ARGUMENT naming `origin` with every line and column at fault,
// or the fields as FromProto; RESOURCE_EXHAUSTED past 4 MiB.
absl::StatusOr<CadTemplate> ParseCadTemplateText(std::string_view text, const std::string& origin);

}  // namespace mortise::cad
