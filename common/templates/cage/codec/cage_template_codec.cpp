#include "common/templates/cage/codec/cage_template_codec.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/template_validation.h"
#include "common/files/condition_codec.h"
#include "common/files/template_codec.h"
#include "common/messages/proto_text.h"

namespace mortise::parametric {
namespace {

using google::protobuf::RepeatedField;

CagePoint Read(const v1::SpacePoint& point) { return {point.x(), point.y(), point.z()}; }

void Write(const CagePoint& from, v1::SpacePoint& to) {
  to.set_x(from.x);
  to.set_y(from.y);
  to.set_z(from.z);
}

// Columns of three.
template <typename Number>
Eigen::Matrix<Number, 3, Eigen::Dynamic> ReadColumns(const RepeatedField<Number>& numbers,
                                                     const std::string& field,
                                                     std::vector<FieldViolation>& findings) {
  if (numbers.size() % 3 != 0) {
    findings.push_back({field, absl::StrCat("has ", numbers.size(), " numbers, not threes")});
  }
  Eigen::Matrix<Number, 3, Eigen::Dynamic> columns(3, numbers.size() / 3);
  for (Eigen::Index i = 0; i < columns.size(); ++i) {
    columns.data()[i] = numbers.Get(static_cast<int>(i));
  }
  return columns;
}

template <typename Number>
void WriteColumns(const Eigen::Matrix<Number, 3, Eigen::Dynamic>& columns,
                  RepeatedField<Number>& numbers) {
  numbers.Add(columns.data(), columns.data() + columns.size());
}

CageCondition ReadCondition(const v1::CageCondition& message, const std::string& field,
                            std::vector<FieldViolation>& findings) {
  CageCondition condition;
  if (auto read = parametric::ReadCondition<v1::CageCondition>(message, field, findings)) {
    static_cast<ConditionDefinition&>(condition) = *std::move(read);
  } else {
    findings.push_back({field, "does not say what kind of condition it is"});
  }
  condition.name = message.name();
  condition.present = message.present();
  return condition;
}

}  // namespace

absl::StatusOr<CageTemplate> FromProto(const v1::CageTemplate& message) {
  std::vector<FieldViolation> findings;
  CageTemplate definition;
  definition.name = message.name();
  definition.title = message.title();
  definition.description = message.description();
  definition.material = message.material();
  for (const v1::Parameter& parameter : message.parameters()) {
    definition.parameters.push_back(parametric::FromProto(parameter));
  }
  for (const v1::CadDefinition& entry : message.definitions()) {
    definition.definitions.push_back({entry.name(), entry.value()});
  }
  definition.surface.vertices =
      ReadColumns(message.surface().vertices(), "surface.vertices", findings);
  for (int i = 0; i < message.surface().faces_size(); ++i) {
    const v1::CageFace& face = message.surface().faces(i);
    definition.surface.faces.push_back(
        {face.name(), ReadColumns(face.triangles(),
                                  absl::StrCat("surface.faces[", i, "].triangles"), findings)});
  }
  for (const v1::SpacePoint& vertex : message.cage().vertices()) {
    definition.cage.vertices.push_back(Read(vertex));
  }
  definition.cage.triangles = ReadColumns(message.cage().triangles(), "cage.triangles", findings);
  for (int i = 0; i < message.conditions_size(); ++i) {
    definition.conditions.push_back(
        ReadCondition(message.conditions(i), absl::StrCat("conditions[", i, "]"), findings));
  }
  definition.reference_temperature = message.reference_temperature();
  MORTISE_RETURN_IF_ERROR(ToStatus(findings));
  return definition;
}

v1::CageTemplate ToProto(const CageTemplate& definition) {
  v1::CageTemplate message;
  message.set_name(definition.name);
  message.set_title(definition.title);
  message.set_description(definition.description);
  message.set_material(definition.material);
  for (const Parameter& parameter : definition.parameters) {
    *message.add_parameters() = parametric::ToProto(parameter);
  }
  for (const CageDefinition& named : definition.definitions) {
    v1::CadDefinition& entry = *message.add_definitions();
    entry.set_name(named.name);
    entry.set_value(named.value);
  }
  WriteColumns(definition.surface.vertices, *message.mutable_surface()->mutable_vertices());
  for (const CageFace& face : definition.surface.faces) {
    v1::CageFace& entry = *message.mutable_surface()->add_faces();
    entry.set_name(face.name);
    WriteColumns(face.triangles, *entry.mutable_triangles());
  }
  for (const CagePoint& vertex : definition.cage.vertices) {
    Write(vertex, *message.mutable_cage()->add_vertices());
  }
  WriteColumns(definition.cage.triangles, *message.mutable_cage()->mutable_triangles());
  for (const CageCondition& condition : definition.conditions) {
    v1::CageCondition& entry = *message.add_conditions();
    entry.set_name(condition.name);
    entry.set_present(condition.present);
    WriteCondition(condition, entry);
  }
  message.set_reference_temperature(definition.reference_temperature);
  return message;
}

absl::StatusOr<CageTemplate> ParseCageTemplateText(std::string_view text,
                                                   const std::string& origin) {
  v1::CageTemplate message;
  MORTISE_RETURN_IF_ERROR(ParseProtoText(text, origin, message));
  return FromProto(message);
}

}  // namespace mortise::parametric
