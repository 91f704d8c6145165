#include "common/fem/linear/exact_correction.h"

#include <cmath>
#include <limits>
#include <utility>

#include "common/base/errors.h"

namespace mortise::simulator {
namespace {

constexpr int kMaxRounds = 60;
// Rounds in a row in which the error does not halve, after which it will not any more.
constexpr int kStalled = 4;

double Dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a.array() * b.array()).sum();
}

absl::Status NotPositive() {
  return PreconditionFailed("SINGULAR",
                            "the stiffness is not positive definite: stiffnesses or sizes differ "
                            "beyond what numbers can hold",
                            "supports");
}

}  // namespace

absl::StatusOr<Correction> CorrectSolution(const CorrectedSystem& system,
                                           const Eigen::Matrix3Xd& load, double tolerance,
                                           Eigen::Matrix3Xd& x) {
  Correction correction;
  correction.error = std::numeric_limits<double>::infinity();
  Eigen::Matrix3Xd best = x, residual = load - system.multiply(x), direction;
  Eigen::Matrix3Xd before;  // the residual of the round before
  double last = 0;          // times its step
  for (int stalled = 0;; ++correction.rounds) {
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd step, system.solve(residual));
    const double rest = Dot(residual, step), energy = Dot(load, x);
    if (!std::isfinite(rest) || !(energy >= 0)) return NotPositive();
    const double error = rest == 0 ? 0 : std::sqrt(std::abs(rest) / energy);
    if (error <= tolerance) {
      x += step;
      correction.error = error;
      return correction;
    }
    stalled = error < 0.5 * correction.error ? 0 : stalled + 1;
    if (error < correction.error) {
      correction.error = error;
      best = x;
    }
    if (stalled == kStalled || correction.rounds == kMaxRounds) break;
    if (correction.rounds == 0) {
      direction = step;
    } else {
      // Rounding makes the preconditioner vary: what the residual before has of this step counts.
      direction = step + (rest - Dot(before, step)) / last * direction;
    }
    last = rest;
    const double curvature = Dot(direction, system.multiply(direction));
    if (!(curvature > 0)) return NotPositive();
    x += Dot(direction, residual) / curvature * direction;
    before = std::move(residual);
    residual = load - system.multiply(x);
  }
  x = std::move(best);
  return correction;
}

}  // namespace mortise::simulator
