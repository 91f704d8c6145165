#include "common/files/condition_codec.h"

namespace mortise::parametric {

using Kind = BoundaryConditionKind;

ConditionDefinition ReadHeat(const v1::HeatOnFaces& message, const std::string& field,
                             std::vector<FieldViolation>& findings) {
  const int kinds = (message.flux().empty() ? 0 : 1) + (message.temperature().empty() ? 0 : 1) +
                    (message.convection().empty() ? 0 : 1);
  if (kinds > 1) {
    findings.push_back({field, "must have one of flux, temperature and convection"});
  } else if (message.convection().empty() && !message.ambient().empty()) {
    findings.push_back({field + ".ambient", "is that of a convection, which is missing"});
  }
  ConditionDefinition condition;
  condition.faces = {message.faces().begin(), message.faces().end()};
  if (!message.convection().empty()) {
    condition.kind = Kind::kConvection;
    condition.components = {message.convection(), message.ambient()};
  } else if (!message.temperature().empty()) {
    condition.kind = Kind::kTemperature;
    condition.components = {message.temperature()};
  } else {
    condition.kind = Kind::kHeatFlux;
    condition.components = {message.flux()};
  }
  return condition;
}

void WriteHeat(const ConditionDefinition& condition, v1::HeatOnFaces& message) {
  *message.mutable_faces() = {condition.faces.begin(), condition.faces.end()};
  if (condition.kind == Kind::kConvection) {
    message.set_convection(condition.components.at(0));
    message.set_ambient(condition.components.at(1));
  } else if (condition.kind == Kind::kHeatFlux) {
    message.set_flux(condition.components.at(0));
  } else {
    message.set_temperature(condition.components.at(0));
  }
}

std::vector<std::string> ReadCoordinates(const v1::SpacePoint& point) {
  return {point.x(), point.y(), point.z()};
}

void WriteCoordinates(const ConditionDefinition& condition, std::size_t first,
                      v1::SpacePoint& point) {
  point.set_x(condition.components.at(first));
  point.set_y(condition.components.at(first + 1));
  point.set_z(condition.components.at(first + 2));
}

}  // namespace mortise::parametric
