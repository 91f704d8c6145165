#include "services/simulator/material.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::simulator {
namespace {

// Nearer to incompressible than this, displacement elements lock and answers are worthless.
constexpr double kLargestPoissonsRatio = 0.4999;

}  // namespace

double Material::Lambda() const {
  return youngs_modulus * poissons_ratio / ((1 + poissons_ratio) * (1 - 2 * poissons_ratio));
}

double Material::Mu() const { return youngs_modulus / (2 * (1 + poissons_ratio)); }

absl::Status CheckMaterial(const Material& material, const std::string& field) {
  const auto refuse = [&](const char* name, const char* message) {
    return InvalidField(absl::StrCat(field, ".", name),
                        absl::StrCat("of material '", material.name, "' ", message));
  };
  if (!std::isfinite(material.density) || material.density <= 0) {
    return refuse("density", "must be positive");
  }
  if (!std::isfinite(material.youngs_modulus) || material.youngs_modulus <= 0) {
    return refuse("youngs_modulus", "must be positive");
  }
  if (!(material.poissons_ratio > -1 && material.poissons_ratio <= kLargestPoissonsRatio)) {
    return refuse("poissons_ratio", "must lie above -1 and at most at 0.4999");
  }
  if (!std::isfinite(material.strength) || material.strength < 0) {
    return refuse("strength", "must not be negative");
  }
  return absl::OkStatus();
}

Matrix6d StiffnessMatrix(const Material& material) {
  const double lambda = material.Lambda(), mu = material.Mu();
  Matrix6d stiffness = Matrix6d::Zero();
  stiffness.topLeftCorner<3, 3>().setConstant(lambda);
  for (int i = 0; i < 3; ++i) {
    stiffness(i, i) += 2 * mu;
    stiffness(i + 3, i + 3) = mu;
  }
  return stiffness;
}

double VonMises(const Vector6d& stress) {
  const double xy = stress[0] - stress[1], yz = stress[1] - stress[2], zx = stress[2] - stress[0];
  return std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3 * stress.tail<3>().squaredNorm());
}

}  // namespace mortise::simulator
