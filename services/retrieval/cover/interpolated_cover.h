// Covers a manifold with few evaluations of it, by covering what interpolates it.
//
// A cover asks for tens of thousands of points of the manifold, to be sure that nothing is left
// uncovered and to measure radii, and a point of a family takes from milliseconds, for the
// descriptor, to a quarter of a second where solids are made. But a descriptor changes smoothly
// with the parameters, and need only be known to a part of δ. Our own, after the practice of
// surrogate models:
//
// - Some points are evaluated: samples, and every other one moved along a ray from the middle to
//   the boundary, so that little lies outside of what is known. Those that lie nearly where another
//   does are left out: they tell nothing, and what interpolates both is nearly singular. They are
//   projected onto their leading principal components, which leave out no more than δ/20.
// - Within each structure they are interpolated by cubic radial basis functions with a polynomial
//   tail (linear, or quadratic where there are points enough). The error is measured by leaving out
//   one point after the other, which for such functions needs no second fit (Rippa 1999). As long
//   as one in twenty errors is more than δ/5, the number of points is doubled, for those structures
//   of which that is so; unless that is no use any more, as the errors are more than three quarters
//   of those that there were with half as many points, or there may be no more: then up to δ/2 will
//   do. Solids that are meshed anew each time have descriptors with noise, which no number of
//   points takes away: of those that need not meet the points as well, the best is taken.
// - What interpolates is then covered as the manifold would be (manifold_cover.h), with δ less that
//   error and less δ/20, and its primitives are lifted from the principal components. So a design
//   that is interpolated with no more than that error is no further than δ from them; one in twenty
//   may be further. A larger error is paid with more primitives, not with designs.
//
// Designs of structures that are too rare to be interpolated are evaluated each by itself.
#pragma once

#include "absl/status/statusor.h"
#include "services/retrieval/cover/manifold_cover.h"

namespace mortise::retrieval {

// Covers as CoverManifold does, with the same options and errors; `evaluations` and `failures` of
// the result count those of the manifold itself, and `interpolation_error` is the error. Where
// interpolation will not do, because a fiftieth of the designs cannot be made or 1536 points of a
// structure that many designs have, or 4096 of all, are not enough, it is CoverManifold. The same
// seed gives the same bits with any number of threads.
absl::StatusOr<Cover> CoverByInterpolation(const Manifold& manifold, const CoverOptions& options);

}  // namespace mortise::retrieval
