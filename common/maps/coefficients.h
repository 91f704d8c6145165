// The coefficients q of the active B-splines of a map, from its samples' values (A.11).
// Private to this folder.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/maps/refinement_tree.h"

namespace mortise::maps {

// values: outputs × samples. cut_off: for each node, 1 where it is an element without a value; the
// cubic basis does not read samples that touch only such. Returns outputs × tree.splines().count(),
// zero where one is not active.
Eigen::MatrixXd ComputeCoefficients(const RefinementTree& tree, const Eigen::MatrixXd& values,
                                    const std::vector<std::uint8_t>& cut_off);

}  // namespace mortise::maps
