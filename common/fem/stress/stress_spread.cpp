#include "common/fem/stress/stress_spread.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/fem/elements/shape_functions.h"
#include "common/fem/stress/element_stress.h"
#include "common/fem/stress/stress_derivative.h"

namespace mortise::simulator {
namespace {

// Of quadratic elements stress is linear and its equivalent is not; where sides are curved the
// volume of a point is a cubic polynomial.
const std::vector<TetrahedronPoint>& RuleOf(const mesh::TetrahedralMesh& mesh) {
  return TetrahedronRule(mesh.IsQuadratic() ? 5 : 1);
}

// A measure is (∫ f dV), or a function of (∫ f dV / V), f the von Mises stress or its square. Its
// derivative is `factor` times that of ∫ (f − offset) dV, `offset` held.
struct Linearised {
  bool squared = false;
  double offset = 0;
  double factor = 1;
};

Linearised Linearise(SpreadMeasure measure, double value, double volume) {
  switch (measure) {
    case SpreadMeasure::kMean:
      return {.offset = value, .factor = 1 / volume};
    case SpreadMeasure::kRootMeanSquare:
      return {.squared = true,
              .offset = value * value,
              .factor = value > 0 ? 1 / (2 * value * volume) : 0};
    case SpreadMeasure::kIntegral:
      break;
  }
  return {};
}

}  // namespace

double StressSpread::RootMeanSquare() const {
  return std::sqrt(von_mises.cwiseAbs2().dot(volume) / Volume());
}

double StressSpread::Percentile(double share) const {
  std::vector<std::pair<double, double>> points;  // stress and volume
  points.reserve(static_cast<std::size_t>(von_mises.size()));
  for (Eigen::Index k = 0; k < von_mises.size(); ++k) {
    points.emplace_back(von_mises[k], volume[k]);
  }
  std::sort(points.begin(), points.end());
  const double wanted = share * Volume();
  double counted = 0;
  for (const auto& [stress, of_point] : points) {
    counted += of_point;
    if (counted >= wanted) return stress;
  }
  return points.back().first;  // rounding left a little
}

StressSpread SpreadOf(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                      const Eigen::Matrix3Xd& displacement, const Eigen::VectorXd& temperature,
                      ThreadTeam& team) {
  const auto& rule = RuleOf(mesh);
  const auto points = static_cast<Eigen::Index>(rule.size());
  StressSpread spread;
  spread.von_mises.resize(points * mesh.tetrahedra.cols());
  spread.volume.resize(points * mesh.tetrahedra.cols());
  team.ForRanges(static_cast<int>(mesh.tetrahedra.cols()), [&](int begin, int end) {
    ElementStress stress(mesh, materials, displacement, temperature);
    for (Eigen::Index e = begin; e < end; ++e) {
      stress.MoveTo(e);
      Eigen::Index at = points * e;
      for (const TetrahedronPoint& of_rule : rule) {
        const ElementPoint point = EvaluateElement(stress.positions(), of_rule.barycentric);
        spread.von_mises[at] = VonMises(stress.At(point, of_rule.barycentric));
        spread.volume[at++] = of_rule.weight * point.determinant / 6;
      }
    }
  });
  return spread;
}

StressSpread SpreadInPart(const mesh::TetrahedralMesh& mesh, const StressSpread& spread, int part) {
  const Eigen::Index points = spread.volume.size() / mesh.tetrahedra.cols();
  std::vector<Eigen::Index> own;
  for (Eigen::Index k = 0; k < spread.volume.size(); ++k) {
    if (mesh.part[k / points] == part) own.push_back(k);
  }
  return {spread.von_mises(own), spread.volume(own)};
}

double ValueOf(SpreadMeasure measure, const StressSpread& spread) {
  switch (measure) {
    case SpreadMeasure::kMean:
      return spread.Mean();
    case SpreadMeasure::kRootMeanSquare:
      return spread.RootMeanSquare();
    case SpreadMeasure::kIntegral:
      break;
  }
  return spread.Integral();
}

// With S = D dσ_v/dσ, σ_v the von Mises stress, dσ_v = S : ∇du, and where nodes move by V
// δ(∇u) = −∇u ∇V and δ(dV) = tr(∇V) dV.
SpreadDerivative DerivativeOf(SpreadMeasure measure, const mesh::TetrahedralMesh& mesh,
                              const std::vector<Material>& materials,
                              const Eigen::Matrix3Xd& displacement, int part, ThreadTeam& team) {
  StressSpread spread = SpreadOf(mesh, materials, displacement, {}, team);
  if (part >= 0) spread = SpreadInPart(mesh, spread, part);
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  SpreadDerivative derivative{ValueOf(measure, spread), none, none};
  const Linearised linear = Linearise(measure, derivative.value, spread.Volume());
  const Eigen::VectorXd cold;
  ElementStress stress(mesh, materials, displacement, cold);
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    if (part >= 0 && mesh.part[e] != part) continue;
    stress.MoveTo(e);
    for (const TetrahedronPoint& of_rule : RuleOf(mesh)) {
      const ElementPoint point = EvaluateElement(stress.positions(), of_rule.barycentric);
      const Vector6d sigma = stress.At(point, of_rule.barycentric);
      const double equivalent = VonMises(sigma);
      const double value = linear.squared ? equivalent * equivalent : equivalent;
      const double slope = linear.squared ? 2 * equivalent : 1;
      const double weight = linear.factor * of_rule.weight * point.determinant / 6;
      const Eigen::Matrix3d sensitivity =
          weight * slope * StressTensor(stress.stiffness() * VonMisesGradient(sigma));
      const Eigen::Matrix3d turned = stress.DisplacementGradient(point).transpose() * sensitivity;
      for (Eigen::Index k = 0; k < mesh.tetrahedra.rows(); ++k) {
        const int node = mesh.tetrahedra(k, e);
        const auto gradient = point.gradients.col(k);
        derivative.by_displacement.col(node) += sensitivity * gradient;
        derivative.by_position.col(node) +=
            weight * (value - linear.offset) * gradient - turned * gradient;
      }
    }
  }
  return derivative;
}

}  // namespace mortise::simulator
