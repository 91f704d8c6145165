// Field-by-field conversion of templates and designs; items and materials are in item_codec.cpp.
#include "common/files/template_codec.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/files/axis_codec.h"
#include "common/files/height_field_codec.h"
#include "common/files/template_reader.h"
#include "common/messages/message_digest.h"

namespace mortise::parametric {

Parameter FromProto(const v1::Parameter& message) {
  Parameter parameter = {.name = message.name(),
                         .title = message.title(),
                         .description = message.description(),
                         .unit = message.unit(),
                         .minimum = message.minimum(),
                         .maximum = message.maximum(),
                         .default_value = message.default_value(),
                         .step = message.step(),
                         .choices = {message.choices().begin(), message.choices().end()}};
  FillChoice(parameter);
  return parameter;
}

v1::Parameter ToProto(const Parameter& parameter) {
  v1::Parameter message;
  message.set_name(parameter.name);
  message.set_title(parameter.title);
  message.set_description(parameter.description);
  message.set_unit(parameter.unit);
  message.set_minimum(parameter.minimum);
  message.set_maximum(parameter.maximum);
  message.set_default_value(parameter.default_value);
  message.set_step(parameter.step);
  for (const std::string& choice : parameter.choices) message.add_choices(choice);
  return message;
}

namespace {

void SetProto(const Extent& extent, v1::Extent* message) {
  message->set_from(extent.from);
  message->set_to(extent.to);
}

void SetProto(const ConditionalItem& item, v1::ConditionalItem* message) {
  message->set_when(item.when);
  message->set_item(item.item);
}

void SetProto(const PartRepeat& repeat, v1::PartRepeat* message) {
  message->set_count(repeat.count);
  message->set_x(repeat.x);
  message->set_y(repeat.y);
  message->set_z(repeat.z);
  message->set_index(repeat.index);
}

v1::PartTemplate ToProto(const PartTemplate& part) {
  v1::PartTemplate message;
  message.set_present(part.present);
  for (const PartRepeat& repeat : part.repeat) SetProto(repeat, message.add_repeat());
  for (const ConditionalItem& item : part.items) SetProto(item, message.add_items());
  message.set_name(part.name);
  message.set_title(part.title);
  message.set_item(part.item);
  message.set_length_axis(AxisToProto(part.length_axis));
  message.set_thickness_axis(AxisToProto(part.thickness_axis));
  if (const Box* box = std::get_if<Box>(&part.body)) {
    SetProto(box->x, message.mutable_box()->mutable_x());
    SetProto(box->y, message.mutable_box()->mutable_y());
    SetProto(box->z, message.mutable_box()->mutable_z());
    return message;
  }
  const Prism& prism = std::get<Prism>(part.body);
  message.mutable_prism()->set_axis(AxisToProto(prism.axis));
  for (const OutlinePoint& point : prism.outline) {
    v1::OutlinePoint* added = message.mutable_prism()->add_outline();
    added->set_u(point.u);
    added->set_v(point.v);
  }
  SetProto(prism.extent, message.mutable_prism()->mutable_extent());
  return message;
}

v1::Connection ToProto(const Connection& connection) {
  v1::Connection message;
  message.set_name(connection.name);
  message.set_part(connection.part);
  message.set_face(connection.face);
  message.set_other_part(connection.other_part);
  message.set_item(connection.item);
  message.set_priority(connection.priority);
  message.set_end_distance(connection.end_distance);
  message.set_spacing(connection.spacing);
  message.set_depth_in_part(connection.depth_in_part);
  message.set_present(connection.present);
  message.set_pairing(static_cast<v1::Connection::Pairing>(connection.pairing));
  for (const ConditionalItem& item : connection.items) SetProto(item, message.add_items());
  message.set_row_spacing(connection.row_spacing);
  message.set_side_distance(connection.side_distance);
  return message;
}

absl::StatusOr<BoundaryConditionKind> FromProto(v1::BoundaryCondition::Kind kind,
                                                const std::string& field) {
  const bool is_known =
      v1::BoundaryCondition::Kind_IsValid(kind) && kind != v1::BoundaryCondition::KIND_UNSPECIFIED;
  if (is_known) return static_cast<BoundaryConditionKind>(kind);
  return InvalidField(field,
                      "must be FIXED, SYMMETRIC, DISPLACEMENT, FORCE, PRESSURE, GRAVITY, ROTATION, "
                      "HEAT_FLUX, TEMPERATURE or CONVECTION");
}

v1::BoundaryCondition::Kind ToProto(BoundaryConditionKind kind) {
  return static_cast<v1::BoundaryCondition::Kind>(kind);
}

}  // namespace

absl::StatusOr<BoundaryCondition> FromProto(const v1::BoundaryCondition& message,
                                            const std::string& field) {
  BoundaryCondition condition;
  condition.name = message.name();
  MORTISE_ASSIGN_OR_RETURN(condition.kind, FromProto(message.kind(), absl::StrCat(field, ".kind")));
  condition.part = message.part();
  condition.face = message.face();
  condition.components = {message.components().begin(), message.components().end()};
  condition.load_case = message.load_case();
  condition.present = message.present();
  return condition;
}

namespace {

v1::BoundaryCondition ToProto(const BoundaryCondition& condition) {
  v1::BoundaryCondition message;
  message.set_name(condition.name);
  message.set_kind(ToProto(condition.kind));
  message.set_part(condition.part);
  message.set_face(condition.face);
  for (const std::string& component : condition.components) message.add_components(component);
  message.set_load_case(condition.load_case);
  message.set_present(condition.present);
  return message;
}

}  // namespace

std::vector<NamedValue> FromProto(
    const google::protobuf::RepeatedPtrField<v1::ParameterValue>& messages) {
  std::vector<NamedValue> values;
  for (const v1::ParameterValue& message : messages) {
    values.push_back({message.name(), message.value(), message.choice()});
  }
  return values;
}

absl::StatusOr<TemplateDefinition> FromProto(const v1::Template& message) {
  if (message.kind_case() != v1::Template::KIND_NOT_SET) {
    return InvalidField("kind", "is not a template of parts");
  }
  std::vector<FieldViolation> findings;
  TemplateDefinition definition = ReadTemplate(message, findings);
  MORTISE_RETURN_IF_ERROR(ToStatus(findings));
  return definition;
}

v1::Template ToProto(const TemplateDefinition& definition) {
  v1::Template message;
  message.set_name(definition.name);
  message.set_revision(definition.revision);
  message.set_title(definition.title);
  message.set_description(definition.description);
  message.set_digest(definition.digest);
  for (const Parameter& parameter : definition.parameters) {
    *message.add_parameters() = ToProto(parameter);
  }
  for (const PartTemplate& part : definition.parts) *message.add_parts() = ToProto(part);
  for (const Connection& connection : definition.connections) {
    *message.add_connections() = ToProto(connection);
  }
  for (const BoundaryCondition& condition : definition.boundary_conditions) {
    *message.add_boundary_conditions() = ToProto(condition);
  }
  message.set_reference_temperature(definition.reference_temperature);
  for (const Ground& ground : definition.grounds) *message.add_height_fields() = ToProto(ground);
  return message;
}

absl::StatusOr<TemplateBundle> FromProto(const v1::TemplateBundle& message) {
  TemplateBundle bundle;
  auto definition = FromProto(message.template_());
  if (!definition.ok()) return UnderField("template", definition.status());
  bundle.definition = *std::move(definition);
  for (int i = 0; i < message.items_size(); ++i) {
    auto item = FromProto(message.items(i));
    if (!item.ok()) return UnderField(absl::StrCat("items[", i, "]"), item.status());
    bundle.items.push_back(*std::move(item));
  }
  for (const v1::Material& material : message.materials()) {
    MORTISE_ASSIGN_OR_RETURN(Material converted, FromProto(material));
    bundle.materials.push_back(std::move(converted));
  }
  return bundle;
}

v1::TemplateBundle ToProto(const TemplateBundle& bundle) {
  v1::TemplateBundle message;
  *message.mutable_template_() = ToProto(bundle.definition);
  for (const Item& item : bundle.items) *message.add_items() = ToProto(item);
  for (const Material& material : bundle.materials) *message.add_materials() = ToProto(material);
  return message;
}

std::string TemplateDigest(const v1::Template& message) {
  v1::Template content = message;
  content.clear_name();
  content.clear_revision();
  content.clear_digest();
  content.clear_create_time();
  content.clear_external_ids();
  content.clear_labels();
  content.clear_creator();
  content.clear_placed_template();
  content.clear_placed_template_revision();
  for (v1::HeightField& heights : *content.mutable_height_fields()) heights.clear_digest();
  return MessageDigest(content);
}

std::string BundleDigest(const v1::TemplateBundle& message) {
  v1::TemplateBundle content = message;
  content.mutable_template_()->Clear();
  content.mutable_template_()->set_digest(TemplateDigest(message.template_()));
  ClearRevisions(*content.mutable_items(), *content.mutable_materials());
  // Their own digests say what they are.
  content.clear_shapes();
  content.mutable_assembly()->clear_revision();
  content.mutable_assembly()->clear_create_time();
  content.mutable_assembly()->clear_external_ids();
  content.mutable_assembly()->clear_labels();
  content.mutable_assembly()->clear_creator();
  if (!message.has_assembly()) content.clear_assembly();
  return MessageDigest(content);
}

}  // namespace mortise::parametric
