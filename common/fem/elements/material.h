// The materials that parts are made of.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace mortise::simulator {

// Stress and strain as vectors: xx, yy, zz, xy, yz, xz; shear strains are twice the tensor's.
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// A material whose properties differ along three directions at right angles to each other. Of wood
// these are the grain (1), the radius of the tree (2) and the tangent to its rings (3).
struct Orthotropy {
  Eigen::Vector3d youngs_modulus = Eigen::Vector3d::Zero();  // Pa: E₁, E₂, E₃
  // ν₁₂, ν₂₃, ν₁₃: νᵢⱼ is the contraction along j for each unit of stretch along i, pulled along i.
  Eigen::Vector3d poissons_ratio = Eigen::Vector3d::Zero();
  Eigen::Vector3d shear_modulus = Eigen::Vector3d::Zero();  // Pa: G₁₂, G₂₃, G₁₃
  // Columns are the directions 1, 2, 3 in space, a rotation: the first column is the grain.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d thermal_expansion = Eigen::Vector3d::Zero();  // 1/K, along 1, 2, 3
  Eigen::Vector3d conductivity = Eigen::Vector3d::Zero();       // W/(m K), along 1, 2, 3
};

// A linear-elastic material, isotropic unless it has an orthotropy, which then replaces the
// isotropic modulus, Poisson's ratio, expansion and conductivity.
struct Material {
  std::string name;
  double density = 0;         // kg/m³
  double youngs_modulus = 0;  // Pa
  double poissons_ratio = 0;
  double strength = 0;           // Pa; 0 where unknown
  double thermal_expansion = 0;  // 1/K; 0 where unknown
  double conductivity = 0;       // W/(m K)
  std::optional<Orthotropy> orthotropy{};

  // Lamé's constants of an isotropic material: stress = λ tr(ε) I + 2 μ ε.
  double Lambda() const;  // Pa
  double Mu() const;      // Pa
};

// Fails with INVALID_ARGUMENT below `field` unless density and moduli are positive, Poisson's ratio
// lies within -1 and 0.5, both excluded (at 0.5 the material is incompressible and the stiffness
// infinite), and an orthotropic stiffness is positive definite with axes that are a rotation.
absl::Status CheckMaterial(const Material& material, const std::string& field);

// Fails with INVALID_ARGUMENT below `field` unless the material conducts heat in every direction.
absl::Status CheckConductivity(const Material& material, const std::string& field);

// Returns the grain along `grain` and direction 2 as near to `radial` as a right angle allows: axes
// of an orthotropy. Where the two are parallel, direction 2 is any direction across the grain.
Eigen::Matrix3d GrainAxes(const Eigen::Vector3d& grain, const Eigen::Vector3d& radial);

// Returns the stiffness D in space: stress = D · strain, Pa. The material has been checked.
Matrix6d StiffnessMatrix(const Material& material);

// Returns the strain of a body that is free to expand, for each kelvin of warming.
Vector6d ThermalStrain(const Material& material);

// Returns a note on materials that warmth strains nowhere, for where thermal stress is computed: 0
// also stands where nobody knows the expansion. It is empty if there are none.
std::string NoteOnExpansion(const std::vector<Material>& materials);

// Returns the conductivity in space: heat flux = −k · gradient of temperature, W/(m K).
Eigen::Matrix3d ConductivityMatrix(const Material& material);

// Returns the strain of a displacement whose derivatives by x, y and z are the columns of
// `gradient`: shear strains twice the tensor's. Here, as it is needed for each integration point of
// each element.
inline Vector6d StrainOf(const Eigen::Matrix3d& gradient) {
  Vector6d strain;
  strain << gradient(0, 0), gradient(1, 1), gradient(2, 2), gradient(0, 1) + gradient(1, 0),
      gradient(1, 2) + gradient(2, 1), gradient(0, 2) + gradient(2, 0);
  return strain;
}

// Returns xx yy zz xy yz xz as a symmetric matrix.
Eigen::Matrix3d StressTensor(const Vector6d& stress);

// Returns the equivalent uniaxial stress √(½((σx−σy)²+(σy−σz)²+(σz−σx)²)+3(τxy²+τyz²+τxz²)), Pa.
double VonMises(const Vector6d& stress);

// Returns the largest principal stress, Pa: what pulls most, negative where all directions are
// pressed.
double MaximumPrincipal(const Vector6d& stress);

}  // namespace mortise::simulator
