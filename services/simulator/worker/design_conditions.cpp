#include "services/simulator/worker/design_conditions.h"

#include <algorithm>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::simulator {
namespace {

using parametric::BoundaryConditionKind;
using parametric::EvaluatedBoundaryCondition;
using parametric::EvaluatedDesign;

template <typename Is>
bool AnyCondition(const EvaluatedDesign& design, const Is& is) {
  return std::any_of(design.boundary_conditions.begin(), design.boundary_conditions.end(), is);
}

// The loads of a load case, those of all for an empty name.
LoadCase& LoadsOf(const std::string& load_case, DesignModel& model) {
  if (load_case.empty()) return model.analysis;
  for (NamedLoadCase& named : model.load_cases) {
    if (named.name == load_case) return named.loads;
  }
  return model.load_cases.emplace_back(NamedLoadCase{load_case, {}, false}).loads;
}

void AddSupport(const EvaluatedBoundaryCondition& condition, const mesh::NamedFace& face,
                DesignModel& model) {
  Support& support = model.analysis.supports.emplace_back();
  support.face = face;
  support.symmetric = condition.kind == BoundaryConditionKind::kSymmetric;
  if (condition.kind != BoundaryConditionKind::kDisplacement) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    support.fixed[axis] = condition.displacement[axis].has_value();
    support.displacement[static_cast<Eigen::Index>(axis)] =
        condition.displacement[axis].value_or(0);
  }
}

void AddLoad(const EvaluatedBoundaryCondition& condition, const mesh::NamedFace& face,
             LoadCase& loads) {
  switch (condition.kind) {
    case BoundaryConditionKind::kForce:
      loads.forces.push_back({face, condition.force});
      break;
    case BoundaryConditionKind::kPressure:
      loads.pressures.push_back({face, condition.pressure});
      break;
    case BoundaryConditionKind::kGravity:
      loads.gravity += condition.acceleration;
      break;
    default:
      loads.rotation = Rotation{condition.axis_point, condition.angular_velocity};
      break;
  }
}

void AddHeat(const EvaluatedBoundaryCondition& condition, const mesh::NamedFace& face,
             DesignModel& model) {
  HeatCase& heat = model.heat ? *model.heat : model.heat.emplace();
  switch (condition.kind) {
    case BoundaryConditionKind::kHeatFlux:
      heat.fluxes.push_back({face, condition.heat_flux});
      break;
    case BoundaryConditionKind::kTemperature:
      heat.temperatures.push_back({face, condition.temperature});
      break;
    default:
      heat.convections.push_back({face, condition.coefficient, condition.temperature});
      break;
  }
}

absl::Status AddCondition(const EvaluatedDesign& design, std::size_t index, DesignModel& model) {
  const EvaluatedBoundaryCondition& condition = design.boundary_conditions[index];
  mesh::NamedFace face;
  if (parametric::ActsOnFace(condition.kind)) {
    face = {parametric::FindPart(design, condition.part), condition.face};
    if (face.part < 0) {
      return InvalidField(absl::StrCat("boundary_conditions[", index, "].part"),
                          absl::StrCat("there is no load-bearing part '", condition.part, "'"));
    }
    model.condition_faces.emplace_back(condition.name, face);
  }
  if (parametric::IsSupport(condition.kind)) {
    AddSupport(condition, face, model);
  } else if (parametric::IsHeat(condition.kind)) {
    AddHeat(condition, face, model);
  } else {
    AddLoad(condition, face, LoadsOf(condition.load_case, model));
  }
  return absl::OkStatus();
}

}  // namespace

bool HasHeat(const EvaluatedDesign& design) {
  return AnyCondition(design,
                      [](const auto& condition) { return parametric::IsHeat(condition.kind); });
}

bool IsLoaded(const EvaluatedDesign& design) {
  return (HasHeat(design) && design.reference_temperature) ||
         AnyCondition(design, [](const EvaluatedBoundaryCondition& condition) {
           const auto& moved = condition.displacement;
           return parametric::IsLoad(condition.kind) ||
                  std::any_of(moved.begin(), moved.end(),
                              [](const auto& along) { return along.value_or(0) != 0; });
         });
}

std::size_t CountLoadCases(const EvaluatedDesign& design) {
  std::set<std::string> names;
  for (const EvaluatedBoundaryCondition& condition : design.boundary_conditions) {
    if (!condition.load_case.empty()) names.insert(condition.load_case);
  }
  return std::max<std::size_t>(names.size(), 1);
}

absl::Status CheckSupported(const EvaluatedDesign& design) {
  if (AnyCondition(design,
                   [](const auto& condition) { return parametric::IsSupport(condition.kind); })) {
    return absl::OkStatus();
  }
  return PreconditionFailed(
      "NO_SUPPORTS",
      absl::StrCat(
          "nothing holds ", design.template_name,
          ": give it boundary_conditions, at least one of kind FIXED that names a part and "
          "a face of it (or SYMMETRIC or DISPLACEMENT), and loads of kind FORCE, PRESSURE, "
          "GRAVITY or ROTATION; or give them to the analysis as its setup (mortise analyze "
          "--support, --load or --setup)"),
      "boundary_conditions");
}

absl::Status CheckLoaded(const EvaluatedDesign& design) {
  if (IsLoaded(design)) return absl::OkStatus();
  return PreconditionFailed(
      "NO_LOADS",
      absl::StrCat(
          "nothing loads ", design.template_name,
          ": give it boundary_conditions of kind FORCE or PRESSURE that name a part and "
          "a face of it, GRAVITY or ROTATION, or heat and a reference_temperature; without "
          "one, every displacement and stress is 0"),
      "boundary_conditions");
}

absl::Status CheckHeated(const EvaluatedDesign& design) {
  if (!HasHeat(design)) {
    return PreconditionFailed(
        "NO_HEAT",
        absl::StrCat(
            "nothing heats ", design.template_name,
            ": give it boundary_conditions of kind HEAT_FLUX that name a part and a face of "
            "it, and of kind CONVECTION or TEMPERATURE where the heat leaves"),
        "boundary_conditions");
  }
  if (AnyCondition(design, [](const auto& condition) {
        return condition.kind == BoundaryConditionKind::kTemperature ||
               condition.kind == BoundaryConditionKind::kConvection;
      })) {
    return absl::OkStatus();
  }
  return PreconditionFailed(
      "FREE_TEMPERATURE",
      absl::StrCat(design.template_name,
                   " has heat without a fixed temperature or convection: any temperature would do; "
                   "give it boundary_conditions of kind CONVECTION or TEMPERATURE"),
      "boundary_conditions");
}

absl::Status AddConditions(const EvaluatedDesign& bearing, DesignModel& model) {
  for (std::size_t i = 0; i < bearing.boundary_conditions.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(AddCondition(bearing, i, model));
  }
  model.reference_temperature = bearing.reference_temperature;
  return absl::OkStatus();
}

}  // namespace mortise::simulator
