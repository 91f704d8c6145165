// Says what Pareto discovery knows about physics: a box of designs, and metrics that somebody
// evaluates.
//
// Notation of all files here: D parameters, d metrics (all to be minimised), m constraints (g <=
// 0), x in R^D a design in SI units, u in [0, 1]^D the same design in unit coordinates of its box,
// F(x) in R^d its performance.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/evaluation/failures/failure_tally.h"

namespace mortise::pareto {

// The box lower <= x <= upper, componentwise. A parameter with lower == upper is fixed.
struct DesignSpace {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
  // The steps of the values that a workshop can set: lower + k step (and the upper bound, if it is
  // one of them). A step of 0 allows any value; no steps at all allow any value of every parameter.
  Eigen::VectorXd step = {};

  Eigen::Index size() const { return lower.size(); }

  // Map between x and u. FromUnit never leaves the box, returns the nearest value that can be set,
  // and hits a bound that can be set exactly for u = 0 or 1.
  Eigen::VectorXd FromUnit(const Eigen::VectorXd& u) const;
  Eigen::VectorXd ToUnit(const Eigen::VectorXd& x) const;

  // Returns the nearest design within the box that can be set; x itself, bit for bit, if it is one.
  Eigen::VectorXd Nearest(const Eigen::VectorXd& x) const;
};

// Fails with INVALID_ARGUMENT naming parameters[i].lower or .upper when a bound is not finite or
// they are reversed; naming "parameters" when there are none or more than `limit`.
absl::Status Validate(const DesignSpace& space, Eigen::Index limit = 512);

enum class EvaluationStatus {
  kEvaluated,  // metrics and constraints are valid, whether or not the constraints are met
  kFailed,     // this design cannot be built or analysed; counted, never fatal
};

// The answer for one design.
struct Evaluation {
  Eigen::VectorXd x;  // D
  EvaluationStatus status = EvaluationStatus::kFailed;
  Eigen::VectorXd metrics;   // d; empty when failed
  Eigen::MatrixXd jacobian;  // d x D, dF/dx; empty when no gradients are offered. A row of NaN:
                             // none offered for that metric.
  Eigen::VectorXd constraints = {};          // m, met where <= 0; empty when failed
  Eigen::MatrixXd constraint_jacobian = {};  // m x D, as `jacobian`
  // The standard deviation of each metric over the tolerances (robust_evaluator.h), d; empty
  // without tolerances.
  Eigen::VectorXd deviations = {};
  // The reason why it failed: for people, and as the evaluator's constant ("RIGID_MOTION") and
  // code.
  std::string message = {};
  std::string reason = {};
  absl::StatusCode code = absl::StatusCode::kUnknown;
};

// Whether an evaluation has metrics and constraints to go by: it is evaluated, and all of them are
// finite.
bool IsUsable(const Evaluation& evaluation);

// Returns why an evaluation that is not usable is not: what it failed for, or "NOT_FINITE".
evaluation::FailedDesign FailureOf(const Evaluation& evaluation);

// Fails with INVALID_ARGUMENT naming "metrics", "deviations", "constraints", "jacobian" or
// "constraint_jacobian" where an evaluation has another count of them than `metrics` d,
// `constraints` m and `parameters` D ask for. A failed evaluation need have none.
absl::Status CheckAnswer(const Evaluation& evaluation, Eigen::Index parameters,
                         Eigen::Index metrics, Eigen::Index constraints);

// Evaluates designs in batches.
class Evaluator {
 public:
  virtual ~Evaluator() = default;

  // Returns one evaluation for each design, in the same order. A non-OK status means that the
  // evaluator itself is out of reach: discovery stops and keeps what it has found. It is called
  // from several threads at once when RunOptions::lanes > 1.
  virtual absl::StatusOr<std::vector<Evaluation>> Evaluate(
      const std::vector<Eigen::VectorXd>& designs) = 0;

  // Asks calls of Evaluate that are under way to return soon, with a failure. Any thread may call
  // this.
  virtual void Interrupt() {}
};

}  // namespace mortise::pareto
