// What parts are made of.
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/status.h"

namespace mortise::simulator {

// Stress and strain as vectors: xx, yy, zz, xy, yz, xz; shear strains are twice the tensor's.
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// An isotropic linear-elastic material.
struct Material {
  std::string name;
  double density = 0;         // kg/m³
  double youngs_modulus = 0;  // Pa
  double poissons_ratio = 0;
  double strength = 0;  // Pa; 0 where unknown

  // Lamé's constants: stress = λ tr(ε) I + 2 μ ε.
  double Lambda() const;  // Pa
  double Mu() const;      // Pa
};

// INVALID_ARGUMENT below `field` unless density and modulus are positive and Poisson's ratio lies
// within -1 and 0.5, both excluded: at 0.5 the material is incompressible and the stiffness
// infinite.
absl::Status CheckMaterial(const Material& material, const std::string& field);

// The stiffness D: stress = D · strain, Pa.
Matrix6d StiffnessMatrix(const Material& material);

// The equivalent uniaxial stress √(½((σx−σy)²+(σy−σz)²+(σz−σx)²)+3(τxy²+τyz²+τxz²)), Pa.
double VonMises(const Vector6d& stress);

}  // namespace mortise::simulator
