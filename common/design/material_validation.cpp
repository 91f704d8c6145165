// Checks of materials: ranges, and that every deformation takes energy.
#include <cmath>

#include "common/design/field_checks.h"
#include "common/design/template_validation.h"

namespace mortise::parametric {
namespace {

// How far from singular the scaled compliance must be; the nine constants are known to a few
// digits.
constexpr double kMinDeterminant = 1e-9;

// A compliance is positive definite where this is: [1 -lr -lt; -lr 1 -rt; -lt -rt 1], in which each
// ratio is scaled by the square root of the moduli: lr = ν_LR √(E_R / E_L), and so on.
struct ScaledRatios {
  double lr, lt, rt;

  explicit ScaledRatios(const OrthotropicElasticity& e)
      : lr(e.poissons_ratio_lr * std::sqrt(e.youngs_modulus_r / e.youngs_modulus_l)),
        lt(e.poissons_ratio_lt * std::sqrt(e.youngs_modulus_t / e.youngs_modulus_l)),
        rt(e.poissons_ratio_rt * std::sqrt(e.youngs_modulus_t / e.youngs_modulus_r)) {}

  double Determinant() const { return 1 - lr * lr - lt * lt - rt * rt - 2 * lr * lt * rt; }
};

struct NamedConstant {
  const char* field;
  double value;
};

// What is wrong in itself is named before what is only missing.
void CheckModuli(const OrthotropicElasticity& e, std::vector<FieldViolation>& findings) {
  const NamedConstant moduli[] = {{"orthotropic.youngs_modulus_l", e.youngs_modulus_l},
                                  {"orthotropic.youngs_modulus_r", e.youngs_modulus_r},
                                  {"orthotropic.youngs_modulus_t", e.youngs_modulus_t},
                                  {"orthotropic.shear_modulus_lr", e.shear_modulus_lr},
                                  {"orthotropic.shear_modulus_lt", e.shear_modulus_lt},
                                  {"orthotropic.shear_modulus_rt", e.shear_modulus_rt}};
  for (const NamedConstant& modulus : moduli) {
    if (modulus.value != 0) CheckPositive(modulus.field, modulus.value, findings);
  }
  const NamedConstant ratios[] = {{"orthotropic.poissons_ratio_lr", e.poissons_ratio_lr},
                                  {"orthotropic.poissons_ratio_lt", e.poissons_ratio_lt},
                                  {"orthotropic.poissons_ratio_rt", e.poissons_ratio_rt}};
  for (const NamedConstant& ratio : ratios) {
    if (ratio.value > -1 && std::isfinite(ratio.value)) continue;
    findings.push_back({ratio.field, "must be a finite number greater than -1"});
  }
  for (const NamedConstant& modulus : moduli) {
    if (modulus.value == 0) {
      findings.push_back({modulus.field, "is missing: all six moduli are needed"});
    }
  }
}

bool IsPositive(double value) { return value > 0 && std::isfinite(value); }

void CheckElasticity(const OrthotropicElasticity& e, std::vector<FieldViolation>& findings) {
  CheckModuli(e, findings);
  // Of moduli that are none, ratios would be scaled to anything.
  if (!IsPositive(e.youngs_modulus_l) || !IsPositive(e.youngs_modulus_r) ||
      !IsPositive(e.youngs_modulus_t)) {
    return;
  }
  const ScaledRatios scaled(e);
  bool is_possible = true;  // by each ratio alone
  const auto check = [&](const char* field, double ratio, double scaled_ratio, const char* limit) {
    if (std::abs(scaled_ratio) < 1) return;
    is_possible = false;
    if (!(ratio > -1) || !std::isfinite(ratio)) return;  // which has been told
    findings.push_back({field, std::string("must be smaller in size than ") + limit +
                                   ", or a deformation would set energy free"});
  };
  check("orthotropic.poissons_ratio_lr", e.poissons_ratio_lr, scaled.lr,
        "sqrt(youngs_modulus_l / youngs_modulus_r)");
  check("orthotropic.poissons_ratio_lt", e.poissons_ratio_lt, scaled.lt,
        "sqrt(youngs_modulus_l / youngs_modulus_t)");
  check("orthotropic.poissons_ratio_rt", e.poissons_ratio_rt, scaled.rt,
        "sqrt(youngs_modulus_r / youngs_modulus_t)");
  if (is_possible && scaled.Determinant() < kMinDeterminant) {
    findings.push_back({"orthotropic",
                        "is not positive definite: its three Poisson's ratios are together too "
                        "large, and a deformation would set energy free"});
  }
}

}  // namespace

std::vector<FieldViolation> ValidateMaterial(const Material& material) {
  std::vector<FieldViolation> findings;
  CheckResourceName(material.name, "materials", findings);
  CheckTitle("title", material.title, findings);
  CheckPositive("density", material.density, findings);
  CheckPositive("youngs_modulus", material.youngs_modulus, findings);
  CheckPositive("strength", material.strength, findings);
  CheckNotNegative("thermal_conductivity", material.thermal_conductivity, findings);
  CheckNotNegative("thermal_expansion", material.thermal_expansion, findings);
  if (!(material.poissons_ratio > -1 && material.poissons_ratio < 0.5)) {
    findings.push_back({"poissons_ratio", "must lie between -1 and 0.5, ends excluded"});
  }
  if (material.orthotropic) CheckElasticity(*material.orthotropic, findings);
  return findings;
}

}  // namespace mortise::parametric
