// Says what each kind of boundary condition is and takes, whatever template it is written in, and
// its numbers at given parameters. Mirrors BoundaryCondition of mortise/v1/design.proto.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/design/template_definition.h"
#include "common/design/template_validation.h"

namespace mortise::parametric {

// A number of a condition.
struct ConditionComponent {
  const char* field;  // where CAD templates and cages say it, below the condition
  const char* unit;
  bool coordinate = false;  // of a vector: CAD templates and cages may leave it empty
  bool positive = false;    // must be greater than 0
};

// Returns the components of a kind, in their order.
std::span<const ConditionComponent> ComponentsOf(BoundaryConditionKind kind);

// Returns where CAD templates and cages say the faces of a condition of this kind, below the
// condition.
std::string FacesField(BoundaryConditionKind kind);

// Whether the kind acts on a face, and not on the whole body.
bool ActsOnFace(BoundaryConditionKind kind);

bool IsSupport(BoundaryConditionKind kind);
bool IsLoad(BoundaryConditionKind kind);
bool IsHeat(BoundaryConditionKind kind);

// A condition as CAD templates and cages write it.
struct ConditionDefinition {
  BoundaryConditionKind kind = BoundaryConditionKind::kFixed;
  std::vector<std::string> faces;       // references; none for the whole body
  std::vector<std::string> components;  // expressions, as many as ComponentsOf has
  std::string load_case;                // of a load; empty where it acts in every one
};

// The numbers of a condition at given parameters; those that its kind lacks are 0.
struct ConditionNumbers {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N in all, spread over the faces; kForce
  double pressure = 0;                              // Pa, against the faces; kPressure
  double heat_flux = 0;                             // W/m² into the part; kHeatFlux
  double temperature = 0;  // K; kTemperature; of the surroundings, kConvection
  double coefficient = 0;  // W/(m²·K); kConvection
  // m along those of x, y, z that are there; kDisplacement
  std::array<std::optional<double>, 3> displacement{};
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      // m/s²; kGravity
  Eigen::Vector3d axis_point = Eigen::Vector3d::Zero();        // m; kRotation
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s; kRotation
};

// Returns the numbers of a condition whose components have these values, nothing where they are
// empty.
ConditionNumbers NumbersOf(BoundaryConditionKind kind,
                           std::span<const std::optional<double>> values);

// Returns what is wrong with a finite value of a component; empty if nothing.
std::string FaultOf(const ConditionComponent& component, double value);

// Returns what is wrong with a reference temperature of this value, K; empty if nothing.
std::string FaultOfTemperature(double value);

// Reports a load case of what is no load, or one that is no identifier, at "`field`.load_case", and
// a displacement that is free along all axes at `field`.
void CheckCondition(const std::string& field, BoundaryConditionKind kind,
                    std::span<const std::string> components, const std::string& load_case,
                    std::vector<FieldViolation>& findings);

// A kind of condition that a template has, and its load case.
struct ConditionUse {
  BoundaryConditionKind kind;
  std::string load_case;
};

// Reports more than 20 load cases, or two rotations in one of them, at `field`, and at
// "reference_temperature" one that nothing of the template can differ from, because it has no heat.
void CheckConditionsTogether(const std::string& field, std::span<const ConditionUse> conditions,
                             const std::string& reference_temperature,
                             std::vector<FieldViolation>& findings);

}  // namespace mortise::parametric
