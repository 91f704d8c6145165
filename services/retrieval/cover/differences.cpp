// Differences of three points, on either side of the middle one or on one side of the first.
#include "services/retrieval/cover/differences.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/errors.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kMinStep = 1e-3;  // of a parameter's extent
constexpr double kMaxStep = 1.0 / 16;
constexpr double kMinPart = 1e-3;  // of a step: with less room than this there is none

// The step as a part of an extent.
double StepPart(double noise) {
  return std::clamp(std::pow(std::max(0.0, noise), 0.25), kMinStep, kMaxStep);
}

// Where the two other points of a difference lie, as changes of one parameter; 0: nowhere.
struct Stencil {
  double first = 0;
  double second = 0;
};

Stencil StencilWithin(double room_up, double room_down, double step) {
  if (step <= 0) return {};
  const double aside = std::min({room_up, room_down, step});
  const double ahead = std::min(std::max(room_up, room_down) / 2, step);
  if (aside >= ahead && aside >= kMinPart * step) return {aside, -aside};
  if (ahead < kMinPart * step) return {};
  const double sign = room_up >= room_down ? 1 : -1;
  return {sign * ahead, sign * 2 * ahead};
}

// The derivatives at 0 of the parabola through (0, y0), (a, y1), (b, y2).
void FitParabola(const Stencil& at, const VectorXd& y0, const VectorXd& y1, const VectorXd& y2,
                 Index column, Derivatives* result) {
  const VectorXd slope1 = (y1 - y0) / at.first;
  const VectorXd slope2 = (y2 - y0) / at.second;
  const VectorXd bend = (slope2 - slope1) / (at.second - at.first);
  result->first.col(column) = slope1 - at.first * bend;
  result->second.col(column) = 2 * bend;
}

}  // namespace

VectorXd DifferenceSteps(const VectorXd& extents, double noise) {
  return StepPart(noise) * extents;
}

double DerivativeError(double noise) { return std::max(0.0, noise) / StepPart(noise); }

absl::StatusOr<Derivatives> CentralDifferences(ParallelEvaluator& evaluator, const VectorXd& q,
                                               const VectorXd& value, const VectorXd& steps) {
  const LinearConstraints& constraints = evaluator.manifold().constraints();
  std::vector<Stencil> stencils;
  std::vector<VectorXd> points;
  for (Index k = 0; k < q.size(); ++k) {
    const VectorXd unit = VectorXd::Unit(q.size(), k);
    stencils.push_back(
        StencilWithin(RoomAlong(constraints, q, unit), RoomAlong(constraints, q, -unit), steps[k]));
    if (stencils.back().first == 0) continue;
    points.emplace_back(q + stencils.back().first * unit);
    points.emplace_back(q + stencils.back().second * unit);
  }
  const auto values = evaluator.Evaluate(points);
  for (const auto& each : values) MORTISE_RETURN_IF_ERROR(each.status());
  Derivatives result;
  result.first.setZero(value.size(), q.size());
  result.second.setZero(value.size(), q.size());
  std::size_t next = 0;
  for (Index k = 0; k < q.size(); ++k) {
    const Stencil& stencil = stencils[static_cast<std::size_t>(k)];
    if (stencil.first == 0) continue;
    FitParabola(stencil, value, *values[next], *values[next + 1], k, &result);
    next += 2;
  }
  return result;
}

}  // namespace mortise::retrieval
