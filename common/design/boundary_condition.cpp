#include "common/design/boundary_condition.h"

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/expressions/identifier.h"

namespace mortise::parametric {
namespace {

using Kind = BoundaryConditionKind;

constexpr std::size_t kMaxLoadCases = 20;  // each takes a solution of its own

constexpr ConditionComponent kForceComponents[] = {
    {"force.force.x", "N", true}, {"force.force.y", "N", true}, {"force.force.z", "N", true}};
constexpr ConditionComponent kPressureComponents[] = {{"pressure.pressure", "Pa"}};
constexpr ConditionComponent kFluxComponents[] = {{"heat.flux", "W/m²"}};
constexpr ConditionComponent kTemperatureComponents[] = {{"heat.temperature", "K", false, true}};
constexpr ConditionComponent kConvectionComponents[] = {
    {"heat.convection", "W/(m²·K)", false, true}, {"heat.ambient", "K", false, true}};
constexpr ConditionComponent kDisplacementComponents[] = {
    {"displacement.displacement.x", "m", true},
    {"displacement.displacement.y", "m", true},
    {"displacement.displacement.z", "m", true}};
constexpr ConditionComponent kGravityComponents[] = {{"gravity.acceleration.x", "m/s²", true},
                                                     {"gravity.acceleration.y", "m/s²", true},
                                                     {"gravity.acceleration.z", "m/s²", true}};
constexpr ConditionComponent kRotationComponents[] = {
    {"rotation.axis_point.x", "m", true},           {"rotation.axis_point.y", "m", true},
    {"rotation.axis_point.z", "m", true},           {"rotation.angular_velocity.x", "rad/s", true},
    {"rotation.angular_velocity.y", "rad/s", true}, {"rotation.angular_velocity.z", "rad/s", true}};

constexpr ConditionComponent kReference = {"reference_temperature", "K", false, true};

// Also of one that acts in every load case, beside that of a single one.
bool HasTwoRotations(std::span<const ConditionUse> conditions,
                     const std::set<std::string>& load_cases) {
  const auto count = [&](const std::string& load_case) {
    return std::count_if(conditions.begin(), conditions.end(), [&](const ConditionUse& condition) {
      return condition.kind == Kind::kRotation &&
             (condition.load_case.empty() || condition.load_case == load_case);
    });
  };
  return count("") > 1 || std::any_of(load_cases.begin(), load_cases.end(),
                                      [&](const auto& name) { return count(name) > 1; });
}

}  // namespace

std::span<const ConditionComponent> ComponentsOf(Kind kind) {
  switch (kind) {
    case Kind::kFixed:
    case Kind::kSymmetric:
      return {};
    case Kind::kForce:
      return kForceComponents;
    case Kind::kPressure:
      return kPressureComponents;
    case Kind::kHeatFlux:
      return kFluxComponents;
    case Kind::kTemperature:
      return kTemperatureComponents;
    case Kind::kConvection:
      return kConvectionComponents;
    case Kind::kDisplacement:
      return kDisplacementComponents;
    case Kind::kGravity:
      return kGravityComponents;
    case Kind::kRotation:
      return kRotationComponents;
  }
  return {};
}

std::string FacesField(Kind kind) {
  switch (kind) {
    case Kind::kFixed:
      return "fixed.faces";
    case Kind::kSymmetric:
      return "symmetric.faces";
    case Kind::kDisplacement:
      return "displacement.faces";
    case Kind::kForce:
      return "force.faces";
    case Kind::kPressure:
      return "pressure.faces";
    case Kind::kHeatFlux:
    case Kind::kTemperature:
    case Kind::kConvection:
      return "heat.faces";
    case Kind::kGravity:
    case Kind::kRotation:
      break;
  }
  return {};
}

bool ActsOnFace(Kind kind) { return kind != Kind::kGravity && kind != Kind::kRotation; }

bool IsSupport(Kind kind) {
  return kind == Kind::kFixed || kind == Kind::kSymmetric || kind == Kind::kDisplacement;
}

bool IsHeat(Kind kind) {
  return kind == Kind::kHeatFlux || kind == Kind::kTemperature || kind == Kind::kConvection;
}

bool IsLoad(Kind kind) { return !IsSupport(kind) && !IsHeat(kind); }

ConditionNumbers NumbersOf(Kind kind, std::span<const std::optional<double>> values) {
  const auto at = [&](std::size_t i) { return i < values.size() ? values[i].value_or(0) : 0; };
  ConditionNumbers numbers;
  switch (kind) {
    case Kind::kFixed:
    case Kind::kSymmetric:
      break;
    case Kind::kForce:
      numbers.force = {at(0), at(1), at(2)};
      break;
    case Kind::kPressure:
      numbers.pressure = at(0);
      break;
    case Kind::kHeatFlux:
      numbers.heat_flux = at(0);
      break;
    case Kind::kTemperature:
      numbers.temperature = at(0);
      break;
    case Kind::kConvection:
      numbers.coefficient = at(0);
      numbers.temperature = at(1);
      break;
    case Kind::kDisplacement:
      std::copy_n(values.begin(), std::min<std::size_t>(values.size(), 3),
                  numbers.displacement.begin());
      break;
    case Kind::kGravity:
      numbers.acceleration = {at(0), at(1), at(2)};
      break;
    case Kind::kRotation:
      numbers.axis_point = {at(0), at(1), at(2)};
      numbers.angular_velocity = {at(3), at(4), at(5)};
      break;
  }
  return numbers;
}

std::string FaultOf(const ConditionComponent& component, double value) {
  if (!component.positive || value > 0) return {};
  return absl::StrCat("is ", value, " ", component.unit, ": must be greater than 0");
}

std::string FaultOfTemperature(double value) { return FaultOf(kReference, value); }

void CheckCondition(const std::string& field, Kind kind, std::span<const std::string> components,
                    const std::string& load_case, std::vector<FieldViolation>& findings) {
  if (!load_case.empty() && !IsLoad(kind)) {
    findings.push_back(
        {field + ".load_case", "is only of loads: supports and heat act in every load case"});
  } else if (!load_case.empty() && !IsIdentifier(load_case)) {
    findings.push_back({field + ".load_case",
                        absl::StrCat("'", load_case.substr(0, 80), "' is not an identifier")});
  }
  if (kind == Kind::kDisplacement &&
      std::all_of(components.begin(), components.end(),
                  [](const std::string& component) { return component.empty(); })) {
    findings.push_back(
        {field, "is free along x, y and z: give the displacement along one of them"});
  }
}

void CheckConditionsTogether(const std::string& field, std::span<const ConditionUse> conditions,
                             const std::string& reference_temperature,
                             std::vector<FieldViolation>& findings) {
  std::set<std::string> load_cases;
  for (const ConditionUse& condition : conditions) {
    if (!condition.load_case.empty()) load_cases.insert(condition.load_case);
  }
  if (load_cases.size() > kMaxLoadCases) {
    findings.push_back({field, absl::StrCat("have ", load_cases.size(), " load cases; at most ",
                                            kMaxLoadCases, " are accepted")});
  }
  if (HasTwoRotations(conditions, load_cases)) {
    findings.push_back({field, "have two rotations in one load case: a body turns about one axis"});
  }
  if (reference_temperature.empty()) return;
  if (std::none_of(conditions.begin(), conditions.end(),
                   [](const ConditionUse& condition) { return IsHeat(condition.kind); })) {
    findings.push_back({"reference_temperature",
                        "is there, but no condition of heat whose temperatures differ from it"});
  }
}

}  // namespace mortise::parametric
