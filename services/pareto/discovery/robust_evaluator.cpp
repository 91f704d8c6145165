// Sigma points, their moments and the gradients of these.
#include "services/pareto/discovery/robust_evaluator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMaxDeviations = 100;
constexpr double kMinRange = 3;  // in units of h: room for a design with h, 2h to one side

// Where a parameter is evaluated beside the design, and how that makes o and e: weights of what the
// two there differ by from the design itself.
struct Stencil {
  std::array<double, 2> offsets;
  std::array<double, 2> odd, even;
};

Stencil StencilAt(double x, double lower, double upper, double h) {
  const bool below = x - h >= lower, above = x + h <= upper;
  if (below && above) return {{h, -h}, {0.5, -0.5}, {0.5, 0.5}};
  const double side = below ? -1 : 1;
  return {{side * h, side * 2 * h}, {side * 2, side * -0.5}, {-1, 0.5}};
}

// The design and the two beside it for each tolerance, in this order.
class SigmaPoints {
 public:
  SigmaPoints(const Robustness& robustness, const VectorXd& x) : designs_{x} {
    if (robustness.first_order) return;
    for (const Tolerance& tolerance : robustness.tolerances) {
      const Eigen::Index i = tolerance.parameter;
      const double lower = robustness.range.lower[i], upper = robustness.range.upper[i];
      stencils_.push_back(StencilAt(x[i], lower, upper, tolerance.step()));
      for (const double offset : stencils_.back().offsets) {
        VectorXd beside = x;
        beside[i] = std::clamp(x[i] + offset, lower, upper);
        designs_.push_back(std::move(beside));
      }
    }
  }

  const std::vector<VectorXd>& designs() const { return designs_; }
  const std::vector<Stencil>& stencils() const { return stencils_; }

 private:
  std::vector<VectorXd> designs_;
  std::vector<Stencil> stencils_;
};

// Of metrics or constraints, and their Jacobians where all evaluations have one.
struct Moments {
  VectorXd mean, deviation;
  MatrixXd mean_jacobian, deviation_jacobian;

  VectorXd Robust(double k) const { return mean + k * deviation; }
  MatrixXd RobustJacobian(double k) const {
    if (k == 0) return mean_jacobian;
    return mean_jacobian + k * deviation_jacobian;
  }
};

using Values = VectorXd Evaluation::*;
using Jacobian = MatrixXd Evaluation::*;

template <typename Field>
auto Combined(std::span<const Evaluation> evaluations, std::size_t tolerance, Field field,
              const std::array<double, 2>& weights) {
  const std::size_t first = 1 + 2 * tolerance;
  const auto& design = evaluations[0].*field;
  return (weights[0] * (evaluations[first].*field - design) +
          weights[1] * (evaluations[first + 1].*field - design))
      .eval();
}

Moments MomentsOf(std::span<const Evaluation> evaluations, const Robustness& robustness,
                  const std::vector<Stencil>& stencils, Values values, Jacobian jacobian) {
  const bool differentiable = std::ranges::all_of(
      evaluations, [&](const Evaluation& one) { return (one.*jacobian).size() > 0; });
  Moments moments{evaluations[0].*values, VectorXd::Zero((evaluations[0].*values).size()), {}, {}};
  VectorXd variance = moments.deviation;
  MatrixXd half_slope;  // of the variance
  if (differentiable) {
    moments.mean_jacobian = evaluations[0].*jacobian;
    half_slope = MatrixXd::Zero(moments.mean_jacobian.rows(), moments.mean_jacobian.cols());
  }
  for (std::size_t k = 0; k < stencils.size(); ++k) {
    const double p = robustness.tolerances[k].weight(), rest = p * (1 - p);
    const VectorXd odd = Combined(evaluations, k, values, stencils[k].odd);
    const VectorXd even = Combined(evaluations, k, values, stencils[k].even);
    moments.mean += p * even;
    variance += p * odd.cwiseAbs2() + rest * even.cwiseAbs2();
    if (!differentiable) continue;
    const MatrixXd odd_slope = Combined(evaluations, k, jacobian, stencils[k].odd);
    const MatrixXd even_slope = Combined(evaluations, k, jacobian, stencils[k].even);
    moments.mean_jacobian += p * even_slope;
    half_slope += p * odd.asDiagonal() * odd_slope + rest * even.asDiagonal() * even_slope;
  }
  moments.deviation = variance.cwiseSqrt();
  if (differentiable) {
    const VectorXd inverse = moments.deviation.unaryExpr(
        [](double deviation) { return deviation > 0 ? 1 / deviation : 0.0; });
    moments.deviation_jacobian = inverse.asDiagonal() * half_slope;
  }
  return moments;
}

Moments FirstOrder(const Evaluation& evaluation, const Robustness& robustness, Values values,
                   Jacobian jacobian) {
  Moments moments{evaluation.*values, VectorXd::Zero((evaluation.*values).size()), {}, {}};
  if (moments.mean.size() == 0) return moments;
  for (const Tolerance& tolerance : robustness.tolerances) {
    moments.deviation +=
        (tolerance.StandardDeviation() * (evaluation.*jacobian).col(tolerance.parameter))
            .cwiseAbs2();
  }
  moments.deviation = moments.deviation.cwiseSqrt();
  return moments;
}

bool HasNumbers(const Evaluation& evaluation) {
  return evaluation.metrics.allFinite() && evaluation.constraints.allFinite();
}

bool HasGradients(const Evaluation& evaluation, const Robustness& robustness) {
  const auto known = [&](const VectorXd& values, const MatrixXd& jacobian) {
    if (values.size() == 0) return true;
    return jacobian.rows() == values.size() &&
           std::ranges::all_of(robustness.tolerances, [&](const Tolerance& tolerance) {
             return jacobian.col(tolerance.parameter).allFinite();
           });
  };
  return known(evaluation.metrics, evaluation.jacobian) &&
         known(evaluation.constraints, evaluation.constraint_jacobian);
}

Evaluation Failed(const VectorXd& x, std::string reason, std::string message,
                  absl::StatusCode code) {
  Evaluation failed;
  failed.x = x;
  failed.reason = std::move(reason);
  failed.message = std::move(message);
  failed.code = code;
  return failed;
}

// Of the sigma point `number`, which is beside the design.
Evaluation FailedBeside(const SigmaPoints& points, std::size_t number, const Evaluation& beside,
                        const Robustness& robustness) {
  const std::size_t tolerance = (number - 1) / 2;
  const double offset = points.stencils()[tolerance].offsets[(number - 1) % 2];
  const bool evaluated = beside.status == EvaluationStatus::kEvaluated;
  std::string why = beside.message;
  if (why.empty()) why = evaluated ? "a metric or constraint is not finite" : beside.reason;
  return Failed(points.designs().front(), "TOLERANCE_FAILED",
                absl::StrCat("within its tolerances, with ", robustness.tolerances[tolerance].name,
                             offset < 0 ? " less by " : " more by ", std::abs(offset), ": ", why),
                evaluated ? absl::StatusCode::kInternal : beside.code);
}

Evaluation Combine(const SigmaPoints& points, std::span<const Evaluation> evaluations,
                   const Robustness& robustness) {
  const Evaluation& design = evaluations.front();
  if (design.status == EvaluationStatus::kFailed || !HasNumbers(design)) return design;
  for (std::size_t i = 1; i < evaluations.size(); ++i) {
    if (evaluations[i].status == EvaluationStatus::kFailed || !HasNumbers(evaluations[i])) {
      return FailedBeside(points, i, evaluations[i], robustness);
    }
  }
  if (robustness.first_order && !HasGradients(design, robustness)) {
    return Failed(design.x, "GRADIENT_MISSING", "a gradient that its tolerances need is missing",
                  absl::StatusCode::kInternal);
  }
  const auto moments_of = [&](Values values, Jacobian jacobian) {
    return robustness.first_order
               ? FirstOrder(design, robustness, values, jacobian)
               : MomentsOf(evaluations, robustness, points.stencils(), values, jacobian);
  };
  const Moments metrics = moments_of(&Evaluation::metrics, &Evaluation::jacobian);
  const Moments constraints =
      moments_of(&Evaluation::constraints, &Evaluation::constraint_jacobian);
  Evaluation robust;
  robust.x = design.x;
  robust.status = EvaluationStatus::kEvaluated;
  robust.metrics = metrics.Robust(robustness.deviations);
  robust.jacobian = metrics.RobustJacobian(robustness.deviations);
  robust.constraints = constraints.Robust(robustness.deviations);
  robust.constraint_jacobian = constraints.RobustJacobian(robustness.deviations);
  robust.deviations = metrics.deviation;
  return robust;
}

absl::Status ValidateTolerance(const Tolerance& tolerance, const DesignSpace& range,
                               const std::string& field) {
  if (!(tolerance.deviation > 0 && std::isfinite(tolerance.deviation))) {
    return InvalidField(absl::StrCat(field, ".deviation"), "must be a finite number above 0");
  }
  const Eigen::Index i = tolerance.parameter;
  if (i < 0 || i >= range.size()) {
    return InvalidField(absl::StrCat(field, ".parameter"), "is not one of the design space");
  }
  const double width = range.upper[i] - range.lower[i];
  if (width < kMinRange * tolerance.step()) {
    return InvalidField(
        absl::StrCat(field, ".deviation"),
        absl::StrCat("may be ", width * tolerance.deviation / (kMinRange * tolerance.step()),
                     " at most where '", tolerance.name, "' has a range of ", width));
  }
  return absl::OkStatus();
}

}  // namespace

double Tolerance::StandardDeviation() const {
  return distribution == Distribution::kNormal ? deviation : deviation / std::sqrt(3.0);
}

double Tolerance::step() const {
  return deviation * std::sqrt(distribution == Distribution::kNormal ? 3.0 : 0.6);
}

double Tolerance::weight() const {
  return distribution == Distribution::kNormal ? 1.0 / 3 : 5.0 / 9;
}

int Robustness::EvaluationsPerDesign() const {
  return first_order ? 1 : 1 + 2 * static_cast<int>(tolerances.size());
}

absl::Status Validate(const Robustness& robustness) {
  std::set<Eigen::Index> parameters;
  for (std::size_t k = 0; k < robustness.tolerances.size(); ++k) {
    const std::string field = absl::StrCat("tolerances[", k, "]");
    MORTISE_RETURN_IF_ERROR(ValidateTolerance(robustness.tolerances[k], robustness.range, field));
    if (!parameters.insert(robustness.tolerances[k].parameter).second) {
      return InvalidField(absl::StrCat(field, ".parameter"), "is given twice");
    }
  }
  if (!(robustness.deviations >= 0 && robustness.deviations <= kMaxDeviations)) {
    return InvalidField("deviations", absl::StrCat("must lie between 0 and ", kMaxDeviations));
  }
  if (robustness.deviations > 0 && robustness.tolerances.empty()) {
    return InvalidField("deviations", "no tolerances are given that metrics could deviate over");
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Evaluation>> RobustEvaluator::Evaluate(
    const std::vector<VectorXd>& designs) {
  std::vector<SigmaPoints> points;
  std::vector<VectorXd> asked;
  for (const VectorXd& x : designs) {
    points.emplace_back(robustness_, x);
    asked.insert(asked.end(), points.back().designs().begin(), points.back().designs().end());
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Evaluation> answers, inner_.Evaluate(asked));
  if (answers.size() != asked.size()) {
    return absl::InternalError(
        absl::StrCat("the evaluator answered ", answers.size(), " of ", asked.size(), " designs"));
  }
  std::vector<Evaluation> robust;
  const auto each = static_cast<std::size_t>(robustness_.EvaluationsPerDesign());
  for (std::size_t i = 0; i < designs.size(); ++i) {
    robust.push_back(Combine(points[i], std::span(answers).subspan(i * each, each), robustness_));
  }
  return robust;
}

}  // namespace mortise::pareto
