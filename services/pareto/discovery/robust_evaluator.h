// Evaluates what a workshop builds: metrics are their mean plus k deviations over stated tolerances
// (§9.1.2).
//
// Parameters with a tolerance vary independently around their design values. The mean m and the
// standard deviation s of a metric f over them are found by a three-point Gauss rule along each of
// the n parameters, through the design (2n + 1 evaluations):
//
//   o = (f(+h) - f(-h)) / 2,  e = (f(+h) + f(-h)) / 2 - f(0),
//   m = f(0) + sum_i p e_i,   s^2 = sum_i p o_i^2 + p (1 - p) e_i^2
//
// with h = sqrt(3) deviation, p = 1/3 for a normal and h = sqrt(3/5) half-width, p = 5/9 for a
// uniform distribution. The mean is exact for quadratics, and both for sums of quadratics in one
// parameter each; s leaves out what two parameters bring only together (f_ij^2 s_i^2 s_j^2). It is
// never negative, unlike the variance of the unscented transform (Julier, Uhlmann 1997), whose mean
// for a normal distribution is the same.
//
// Where f(-h) or f(+h) lies beyond what can be evaluated it is extrapolated from f(0), f(h), f(2h)
// on the other side, which keeps all of that. So designs at a bound stay possible.
//
// To first order it takes one evaluation with gradients: m = f(0), s^2 = sum_i (f_i s_i)^2.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "services/pareto/archive/evaluation.h"

namespace mortise::pareto {

// The tolerance of a parameter: how far what is built may be off in it.
struct Tolerance {
  enum class Distribution { kUniform, kNormal };

  Eigen::Index parameter = 0;
  std::string name;      // of the parameter, for people
  double deviation = 0;  // SI; half-width of the uniform, standard deviation of the normal one
  Distribution distribution = Distribution::kUniform;

  double StandardDeviation() const;
  double step() const;    // h
  double weight() const;  // p
};

struct Robustness {
  std::vector<Tolerance> tolerances;
  double deviations = 0;     // k
  DesignSpace range;         // what can be evaluated, whatever bounds and steps designs have
  bool first_order = false;  // needs gradients of all metrics and constraints

  // Returns how many evaluations one design takes.
  int EvaluationsPerDesign() const;
};

// Fails with INVALID_ARGUMENT naming "tolerances[i].deviation" when it is not a finite number above
// 0 or the range is less than three h wide, "tolerances[i].parameter" for one given twice,
// "deviations" for a number that is negative, not finite, above 100, or without tolerances.
absl::Status Validate(const Robustness& robustness);

// Evaluates designs by what `inner` says of them and those around. Metrics and constraints (g <= 0)
// are m + k s each, with gradients wherever all evaluations of a design have them (not to first
// order), and Evaluation::deviations is s of the metrics. A design fails if one around it does:
// "TOLERANCE_FAILED" with which, and why. Thread safe if `inner` is, which must outlive it.
class RobustEvaluator : public Evaluator {
 public:
  RobustEvaluator(Evaluator& inner, Robustness robustness)
      : inner_(inner), robustness_(std::move(robustness)) {}

  absl::StatusOr<std::vector<Evaluation>> Evaluate(
      const std::vector<Eigen::VectorXd>& designs) override;
  void Interrupt() override { inner_.Interrupt(); }

 private:
  Evaluator& inner_;
  const Robustness robustness_;
};

}  // namespace mortise::pareto
