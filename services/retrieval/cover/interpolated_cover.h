// Covers a manifold with few evaluations of it, by covering what interpolates it.
//
// A cover asks for tens of thousands of points of the manifold, to be sure that nothing is left
// uncovered and to measure radii, and a point of a family takes from milliseconds, for the
// descriptor, to a quarter of a second where solids are made. But a descriptor changes smoothly
// with the parameters, and need only be known to a part of δ. Our own, after the practice of
// surrogate models:
//
// - Some points are evaluated: samples, and every other one moved along a ray from the middle to
//   the boundary, so that little lies outside of what is known. They are projected onto their
//   leading principal components, which leave out no more than δ/20.
// - Within each structure they are interpolated by cubic radial basis functions with a polynomial
//   tail (linear, or quadratic where there are points enough). The error is measured by leaving out
//   one point after the other, which for such functions needs no second fit (Rippa 1999). As long
//   as one in twenty errors is more than δ/5, the number of points is doubled.
// - What interpolates is then covered as the manifold would be (manifold_cover.h), with three
//   quarters of δ, and its primitives are lifted from the principal components. So a design that is
//   interpolated to δ/5 is no further than δ from them; one in twenty may be further.
//
// Designs of structures that are too rare to be interpolated are evaluated each by itself.
#pragma once

#include "absl/status/statusor.h"
#include "services/retrieval/cover/manifold_cover.h"

namespace mortise::retrieval {

// Covers as CoverManifold does, with the same options and errors; `evaluations` and `failures` of
// the result count those of the manifold itself. Where interpolation will not do, because a
// fiftieth of the designs cannot be made or 1536 points of a structure that many designs have are
// not enough, it is CoverManifold. The same seed gives the same bits with any number of threads.
absl::StatusOr<Cover> CoverByInterpolation(const Manifold& manifold, const CoverOptions& options);

}  // namespace mortise::retrieval
