// The ellipsoid that bounds a tangent primitive, measured on the manifold itself.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "absl/status/statusor.h"
#include "services/retrieval/cover/parallel_evaluator.h"
#include "services/retrieval/cover/primitive.h"
#include "services/retrieval/cover/tangent_frame.h"

namespace mortise::retrieval {

// What a tangent is fitted to.
struct TangentSite {
  const Eigen::VectorXd& parameters;  // K: q
  const Eigen::VectorXd& value;       // N: M(q)
  int structure = 0;
  double delta = 0;
  std::uint64_t seed = 0;  // of the places between the axes
};

// Returns a tangent primitive with the first `axes` >= 1 axes of the frame, in descending order of
// radii.
//
// A point of the manifold near the centre has a foot on the tangent space, and its distance from
// the foot, d, bounds the foot's distance from the manifold. Along each axis, either way, points
// are evaluated further and further out until d is nearly 0.9 δ or the boundary is met, where the
// ellipsoid may go on by r_δ = √(δ² - d²) (thesis §4.4.2, with 0.9 δ for δ). What cannot be
// evaluated, or has another structure, is a boundary too. Two to eight evaluations an axis.
//
// Between several axes, 4 m places of the ellipsoid are then compared with the nearest points of
// the manifold that one Newton step finds, and all radii shrink until each is within δ: two
// evaluations a place and round, most often one round. A ball of radius δ is always tight, and
// where all shrinking ends.
absl::StatusOr<Primitive> FitTangent(ParallelEvaluator& evaluator, const TangentFrame& frame,
                                     Eigen::Index axes, const TangentSite& site);

// Keeps the first `axes` axes of a primitive; 0 makes it a point. A part of what is tight is tight.
void KeepAxes(Eigen::Index axes, Primitive* primitive);

}  // namespace mortise::retrieval
