// The weights of samples at a point, quickly: for who interpolates with them what is no output of a
// map, such as shapes and fields, at each move of a slider.
#pragma once

#include <vector>

#include "common/maps/refinement_tree.h"

namespace mortise::maps {

// What RefinementTree::Weights says, from allocations that are computed once. Immutable; any number
// of threads may call it at once. It takes 16 bytes for each of the up to 2^K samples that an
// active B-spline takes its value from.
class PackedWeights {
 public:
  // `tree`, of the linear basis, outlives this and stays as it is.
  explicit PackedWeights(const RefinementTree& tree);

  // Writes ψ_k(x) of all samples that act at x (K numbers of the unit box; coordinates outside of
  // it are taken to its faces, NaN to 0), ascending by sample, those of weight 0 left out. Returns
  // the element that x lies in; all those samples lie on it.
  int At(const double* point, std::vector<SampleWeight>& weights) const;

 private:
  const RefinementTree& tree_;
  std::vector<std::size_t> first_;  // of each B-spline, and the end of the last
  std::vector<SampleWeight> allocations_;
};

}  // namespace mortise::maps
