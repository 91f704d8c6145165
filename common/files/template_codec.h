// Converts templates, items, materials and designs between the structs of this folder and the
// messages of mortise/v1/item.proto, template.proto and design.proto. Target
// mortise_template_codec; only adapters link it.
//
// From… functions check what structs cannot express (unknown enum values, missing bodies, an item's
// axes given twice) and fail with INVALID_ARGUMENT naming the field; whether the content makes
// sense is for template_validation.h. Nothing is lost in either direction except what is no
// content, which structs do not carry: external ids, labels, and the creator, times, digests of
// heights and what a template was placed of, set by the service. Heights come back without their
// datum.
#pragma once

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/design/template_definition.h"
#include "common/design/template_validation.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::parametric {

absl::StatusOr<Material> FromProto(const v1::Material& message);
absl::StatusOr<Item> FromProto(const v1::Item& message);
// Returns what can be read of an item, and findings about the rest, which is as a new one's.
Item ReadItem(const v1::Item& message, std::vector<FieldViolation>& findings);
// What a choice leaves out is filled in (FillChoice).
Parameter FromProto(const v1::Parameter& message);
// Returns a condition of any kind; `field` is the path of the message.
absl::StatusOr<BoundaryCondition> FromProto(const v1::BoundaryCondition& message,
                                            const std::string& field);
// Only templates of parts; for any kind see common/templates/template_codec.h.
absl::StatusOr<EvaluatedBoundaryCondition> FromProto(const v1::EvaluatedBoundaryCondition& message,
                                                     const std::string& field);
absl::StatusOr<TemplateDefinition> FromProto(const v1::Template& message);
absl::StatusOr<TemplateBundle> FromProto(const v1::TemplateBundle& message);
absl::StatusOr<EvaluatedDesign> FromProto(const v1::EvaluatedDesign& message);
std::vector<NamedValue> FromProto(
    const google::protobuf::RepeatedPtrField<v1::ParameterValue>& messages);

v1::Parameter ToProto(const Parameter& parameter);
v1::Material ToProto(const Material& material);
v1::Item ToProto(const Item& item);
v1::Template ToProto(const TemplateDefinition& definition);
v1::TemplateBundle ToProto(const TemplateBundle& bundle);
v1::Structure ToProto(const Structure& structure);
v1::EvaluatedDesign ToProto(const EvaluatedDesign& design);

// Returns the SHA-256 of a template's content: of everything but name, external ids, labels and
// what the service sets.
std::string TemplateDigest(const v1::Template& message);

// Returns the SHA-256 of all that a bundle's F(q) depends on: the template's content and that of
// the items and materials, each without revision, external ids, labels, creator and times.
std::string BundleDigest(const v1::TemplateBundle& message);

}  // namespace mortise::parametric
