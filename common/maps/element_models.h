// A smooth local model of the samples around each element, from which the coefficients of cubic
// B-splines come. Private to this folder. Our own.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/maps/refinement_tree.h"

namespace mortise::maps {

// For each element and output the function of least norm through the samples on it and on its
// neighbours that are not cut off (on the box's faces also on theirs, as there are none on the
// other side), after a linear function was taken off by least squares: f(z) = linear + Σ_i w_i Π_d
// k(z_d, z_id), z in edges of the element. Of three kernels k, from nearly a polynomial to a narrow
// Gaussian, that is taken which predicts each sample best from the others (leaving one out). Where
// it does so hardly better than the linear function, as at a kink or a narrow peak, the
// multi-linear function through the element's corners takes its place, which does not overshoot.
// Linear functions are their own models.
class ElementModels {
 public:
  // values: outputs × samples; cut_off: as of ComputeCoefficients. All three outlive this.
  ElementModels(const RefinementTree& tree, const Eigen::MatrixXd& values,
                const std::vector<std::uint8_t>& cut_off);

  // The coefficient of a B-spline of `level` at `centre` in the uniform cubic spline that follows
  // the model of `element`: Π_d (1 - h²/6 ∂²/∂x_d²) f at the centre (Marsden's identity; exact for
  // cubic polynomials). On a uniform line that is (8p - p₋ - p₊)/6 for a parabola through three
  // samples.
  Eigen::VectorXd Coefficient(int element, int level, const LatticePoint& centre);

 private:
  struct Model {
    Eigen::VectorXd trust{};  // for each output, from 0 (multi-linear) to 1
    std::vector<int> samples{};
    Eigen::MatrixXd places{};      // K × samples, in edges from the element's centre
    Eigen::MatrixXd linear{};      // outputs × (1 + K)
    Eigen::MatrixXd weights{};     // outputs × samples
    std::vector<int> kernel_of{};  // for each output, the number of its kernel
  };
  const Model& ModelOf(int element);
  Eigen::VectorXd MultiLinear(int element, const Eigen::VectorXd& place) const;
  void Fit(Model& model) const;
  Eigen::VectorXd LocalPlace(int element, const LatticePoint& point) const;
  std::vector<int> SamplesAround(int element) const;
  std::vector<int> Thinned(int element, const std::vector<std::pair<double, int>>& nearest) const;
  bool IsOnFace(int element) const;

  const RefinementTree& tree_;
  const Eigen::MatrixXd& values_;
  const std::vector<std::uint8_t>& cut_off_;
  std::vector<Model> models_;  // for each node, made when first asked for
};

}  // namespace mortise::maps
