// How good a cover is, measured on the manifold that it covers (thesis §4.7.1, Figure 4-8).
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "services/retrieval/cover/manifold.h"
#include "services/retrieval/cover/primitive.h"

namespace mortise::retrieval {

// What an error is measured with.
struct ErrorSampling {
  int count = 1000;        // of errors
  std::uint64_t seed = 1;  // another than the cover's
  int threads = 1;
};

// Returns the distances of fresh samples of the manifold from the nearest primitive of their
// structure, in ascending order. Samples that cannot be evaluated are left out.
absl::StatusOr<std::vector<double>> CoverageErrors(const Manifold& manifold,
                                                   const std::vector<Primitive>& primitives,
                                                   const ErrorSampling& sampling);

// Returns the distances of random places on the cover's tangents from the manifold, in ascending
// order; no tangents, no errors, as points lie on it. Each tangent is chosen as often, and a place
// anywhere in its ellipsoid. The nearest point of the manifold is looked for by projected
// Gauss-Newton steps from the tangent's centre and from the nearest of `count` samples, so that
// each error is an upper bound: a denser ground truth, as the thesis has it, would not be feasible
// with seven parameters.
absl::StatusOr<std::vector<double>> FittingErrors(const Manifold& manifold,
                                                  const std::vector<Primitive>& primitives,
                                                  const ErrorSampling& sampling);

// Returns the smallest value that at least `part` (0 to 1) of the ascending `errors` do not exceed;
// 0 for none.
double Quantile(const std::vector<double>& errors, double part);

}  // namespace mortise::retrieval
