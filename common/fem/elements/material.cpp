#include "common/fem/elements/material.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"

namespace mortise::simulator {
namespace {

// Nearer to incompressible than this, displacement elements lock and answers are worthless.
constexpr double kMaxPoissonsRatio = 0.4999;

// Strain from stress along the material's own axes: the normal ones; shears are apart.
Eigen::Matrix3d NormalCompliance(const Orthotropy& orthotropy) {
  const Eigen::Vector3d& young = orthotropy.youngs_modulus;
  const Eigen::Vector3d& poisson = orthotropy.poissons_ratio;
  Eigen::Matrix3d compliance = young.cwiseInverse().asDiagonal();
  compliance(0, 1) = compliance(1, 0) = -poisson[0] / young[0];
  compliance(1, 2) = compliance(2, 1) = -poisson[1] / young[1];
  compliance(0, 2) = compliance(2, 0) = -poisson[2] / young[0];
  return compliance;
}

// Whether a symmetric matrix with ones on the diagonal is positive definite, by some margin: its
// leading minors are positive.
bool IsDefinite(const Eigen::Matrix3d& scaled) {
  constexpr double kMargin = 1e-4;
  return 1 - scaled(0, 1) * scaled(0, 1) > kMargin && scaled.determinant() > kMargin;
}

// T with strain along the axes = T · strain in space; the columns of `axes` are the axes.
Matrix6d StrainTransformation(const Eigen::Matrix3d& axes) {
  static constexpr int kPair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
  Matrix6d transformation;
  for (int r = 0; r < 6; ++r) {
    const auto [i, j] = kPair[r];
    for (int c = 0; c < 6; ++c) {
      const auto [p, q] = kPair[c];
      // ε'ᵢⱼ = Σ aₚᵢ εₚq aqⱼ; engineering shear strains are twice the tensor's.
      const double sum = axes(p, i) * axes(q, j) + axes(q, i) * axes(p, j);
      transformation(r, c) = (r < 3 ? 0.5 : 1.0) * sum;
    }
  }
  return transformation;
}

bool AllPositive(const Eigen::Vector3d& values) {
  return values.allFinite() && values.minCoeff() > 0;
}

absl::Status CheckOrthotropy(const Orthotropy& orthotropy, const std::string& field) {
  if (!AllPositive(orthotropy.youngs_modulus)) {
    return InvalidField(field + ".youngs_modulus", "all three must be positive");
  }
  if (!AllPositive(orthotropy.shear_modulus)) {
    return InvalidField(field + ".shear_modulus", "all three must be positive");
  }
  if (!orthotropy.poissons_ratio.allFinite()) {
    return InvalidField(field + ".poissons_ratio", "must be finite");
  }
  if (!orthotropy.axes.allFinite() || !orthotropy.axes.isUnitary(1e-9) ||
      orthotropy.axes.determinant() < 0) {
    return InvalidField(field + ".axes", "must be three right-handed directions at right angles");
  }
  if (!orthotropy.thermal_expansion.allFinite()) {
    return InvalidField(field + ".thermal_expansion", "must be finite");
  }
  // Scaled by the moduli, so that weak directions count as much as strong ones.
  const Eigen::Matrix3d compliance = NormalCompliance(orthotropy);
  const Eigen::Vector3d scale = compliance.diagonal().cwiseSqrt().cwiseInverse();
  if (!IsDefinite(scale.asDiagonal() * compliance * scale.asDiagonal())) {
    return InvalidField(field + ".poissons_ratio",
                        "with these moduli some load would do no work or release energy: the "
                        "stiffness is not positive definite");
  }
  return absl::OkStatus();
}

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
  if (!std::isfinite(material.strength) || material.strength < 0) {
    return refuse("strength", "must not be negative");
  }
  if (material.orthotropy) return CheckOrthotropy(*material.orthotropy, field + ".orthotropy");
  if (!std::isfinite(material.youngs_modulus) || material.youngs_modulus <= 0) {
    return refuse("youngs_modulus", "must be positive");
  }
  if (!(material.poissons_ratio > -1 && material.poissons_ratio <= kMaxPoissonsRatio)) {
    return refuse("poissons_ratio", "must lie above -1 and at most at 0.4999");
  }
  if (!std::isfinite(material.thermal_expansion)) {
    return refuse("thermal_expansion", "must be finite");
  }
  return absl::OkStatus();
}

absl::Status CheckConductivity(const Material& material, const std::string& field) {
  if (material.orthotropy) {
    if (AllPositive(material.orthotropy->conductivity)) return absl::OkStatus();
    return InvalidField(field + ".orthotropy.conductivity", "all three must be positive");
  }
  if (std::isfinite(material.conductivity) && material.conductivity > 0) return absl::OkStatus();
  return InvalidField(field + ".conductivity",
                      absl::StrCat("of material '", material.name, "' must be positive"));
}

Eigen::Matrix3d GrainAxes(const Eigen::Vector3d& grain, const Eigen::Vector3d& radial) {
  Eigen::Matrix3d axes;
  axes.col(0) = grain.normalized();
  Eigen::Vector3d across = radial - axes.col(0) * axes.col(0).dot(radial);
  if (!(across.norm() > 1e-9 * radial.norm())) across = axes.col(0).unitOrthogonal();
  axes.col(1) = across.normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

Matrix6d StiffnessMatrix(const Material& material) {
  if (material.orthotropy) {
    Matrix6d own = Matrix6d::Zero();
    own.topLeftCorner<3, 3>() = NormalCompliance(*material.orthotropy).inverse();
    own.diagonal().tail<3>() = material.orthotropy->shear_modulus;
    const Matrix6d turn = StrainTransformation(material.orthotropy->axes);
    const Matrix6d stiffness = turn.transpose() * own * turn;
    return 0.5 * (stiffness + stiffness.transpose());
  }
  const double lambda = material.Lambda(), mu = material.Mu();
  Matrix6d stiffness = Matrix6d::Zero();
  stiffness.topLeftCorner<3, 3>().setConstant(lambda);
  for (int i = 0; i < 3; ++i) {
    stiffness(i, i) += 2 * mu;
    stiffness(i + 3, i + 3) = mu;
  }
  return stiffness;
}

Vector6d ThermalStrain(const Material& material) {
  Eigen::Matrix3d strain = material.thermal_expansion * Eigen::Matrix3d::Identity();
  if (material.orthotropy) {
    const Eigen::Matrix3d& axes = material.orthotropy->axes;
    strain = axes * material.orthotropy->thermal_expansion.asDiagonal() * axes.transpose();
  }
  Vector6d vector;
  vector << strain(0, 0), strain(1, 1), strain(2, 2), 2 * strain(0, 1), 2 * strain(1, 2),
      2 * strain(0, 2);
  return vector;
}

std::string NoteOnExpansion(const std::vector<Material>& materials) {
  std::set<std::string> names;
  for (const Material& material : materials) {
    if (ThermalStrain(material).isZero(0)) names.insert(absl::StrCat("'", material.name, "'"));
  }
  if (names.empty()) return "";
  return absl::StrCat("thermal stress: the thermal expansion of ", absl::StrJoin(names, ", "),
                      " is 0, or not known: warmth does not strain what is made of it");
}

Eigen::Matrix3d ConductivityMatrix(const Material& material) {
  if (!material.orthotropy) return material.conductivity * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d& axes = material.orthotropy->axes;
  return axes * material.orthotropy->conductivity.asDiagonal() * axes.transpose();
}

Eigen::Matrix3d StressTensor(const Vector6d& stress) {
  Eigen::Matrix3d tensor;
  tensor << stress[0], stress[3], stress[5],  //
      stress[3], stress[1], stress[4],        //
      stress[5], stress[4], stress[2];
  return tensor;
}

double VonMises(const Vector6d& stress) {
  const double xy = stress[0] - stress[1], yz = stress[1] - stress[2], zx = stress[2] - stress[0];
  return std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3 * stress.tail<3>().squaredNorm());
}

// The largest root of the characteristic polynomial, by the cosine of a third of an angle.
double MaximumPrincipal(const Vector6d& stress) {
  const double mean = stress.head<3>().mean();
  const Eigen::Matrix3d deviator = StressTensor(stress) - mean * Eigen::Matrix3d::Identity();
  const double size = std::sqrt(deviator.squaredNorm() / 6);
  if (!(size > 0)) return mean;
  const double cosine = std::clamp(0.5 * (deviator / size).determinant(), -1.0, 1.0);
  return mean + 2 * size * std::cos(std::acos(cosine) / 3);
}

}  // namespace mortise::simulator
