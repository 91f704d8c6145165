// Conditions of CAD templates and of cages to and from their messages, which name the same kinds
// alike: v1::Feature and v1::CageCondition.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/field_violations.h"
#include "common/design/boundary_condition.h"
#include "mortise/v1/cad_template.pb.h"

namespace mortise::parametric {

// Returns the kind of heat that a message has, a flux that is missing where it has none. What it
// has besides is reported.
ConditionDefinition ReadHeat(const v1::HeatOnFaces& message, const std::string& field,
                             std::vector<FieldViolation>& findings);
void WriteHeat(const ConditionDefinition& condition, v1::HeatOnFaces& message);

std::vector<std::string> ReadCoordinates(const v1::SpacePoint& point);
// Sets the coordinates to three of the components from `first`.
void WriteCoordinates(const ConditionDefinition& condition, std::size_t first,
                      v1::SpacePoint& point);

// Return nothing where the message is none of these kinds. What is wrong is reported below
// `field`.
template <typename Message>
std::optional<ConditionDefinition> ReadCondition(const Message& message, const std::string& field,
                                                 std::vector<FieldViolation>& findings) {
  using Kind = BoundaryConditionKind;
  const auto list = [](const auto& names) {
    return std::vector<std::string>(names.begin(), names.end());
  };
  if (message.has_fixed()) {
    return ConditionDefinition{Kind::kFixed, list(message.fixed().faces()), {}, {}};
  }
  if (message.has_symmetric()) {
    return ConditionDefinition{Kind::kSymmetric, list(message.symmetric().faces()), {}, {}};
  }
  if (message.has_displacement()) {
    return ConditionDefinition{Kind::kDisplacement,
                               list(message.displacement().faces()),
                               ReadCoordinates(message.displacement().displacement()),
                               {}};
  }
  if (message.has_force()) {
    return ConditionDefinition{Kind::kForce, list(message.force().faces()),
                               ReadCoordinates(message.force().force()),
                               message.force().load_case()};
  }
  if (message.has_pressure()) {
    return ConditionDefinition{Kind::kPressure,
                               list(message.pressure().faces()),
                               {message.pressure().pressure()},
                               message.pressure().load_case()};
  }
  if (message.has_gravity()) {
    return ConditionDefinition{Kind::kGravity,
                               {},
                               ReadCoordinates(message.gravity().acceleration()),
                               message.gravity().load_case()};
  }
  if (message.has_rotation()) {
    ConditionDefinition rotation{Kind::kRotation,
                                 {},
                                 ReadCoordinates(message.rotation().axis_point()),
                                 message.rotation().load_case()};
    for (std::string& component : ReadCoordinates(message.rotation().angular_velocity())) {
      rotation.components.push_back(std::move(component));
    }
    return rotation;
  }
  if (message.has_heat()) return ReadHeat(message.heat(), field + ".heat", findings);
  return std::nullopt;
}

template <typename Message>
void WriteCondition(const ConditionDefinition& condition, Message& message) {
  using Kind = BoundaryConditionKind;
  const auto faces = [&condition](auto& kind) {
    *kind.mutable_faces() = {condition.faces.begin(), condition.faces.end()};
  };
  switch (condition.kind) {
    case Kind::kFixed:
      faces(*message.mutable_fixed());
      break;
    case Kind::kSymmetric:
      faces(*message.mutable_symmetric());
      break;
    case Kind::kDisplacement:
      faces(*message.mutable_displacement());
      WriteCoordinates(condition, 0, *message.mutable_displacement()->mutable_displacement());
      break;
    case Kind::kForce:
      faces(*message.mutable_force());
      WriteCoordinates(condition, 0, *message.mutable_force()->mutable_force());
      message.mutable_force()->set_load_case(condition.load_case);
      break;
    case Kind::kPressure:
      faces(*message.mutable_pressure());
      message.mutable_pressure()->set_pressure(condition.components.at(0));
      message.mutable_pressure()->set_load_case(condition.load_case);
      break;
    case Kind::kGravity:
      WriteCoordinates(condition, 0, *message.mutable_gravity()->mutable_acceleration());
      message.mutable_gravity()->set_load_case(condition.load_case);
      break;
    case Kind::kRotation:
      WriteCoordinates(condition, 0, *message.mutable_rotation()->mutable_axis_point());
      WriteCoordinates(condition, 3, *message.mutable_rotation()->mutable_angular_velocity());
      message.mutable_rotation()->set_load_case(condition.load_case);
      break;
    case Kind::kHeatFlux:
    case Kind::kTemperature:
    case Kind::kConvection:
      WriteHeat(condition, *message.mutable_heat());
      break;
  }
}

}  // namespace mortise::parametric
