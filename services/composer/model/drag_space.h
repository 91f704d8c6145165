// What dragging takes of a design's structure, whatever its parameters and whichever node is
// dragged: the equalities eliminated, nothing held in its place, and changes measured as people
// mean nearness. It is made once for each structure (thesis §5.3).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>

#include "common/assembly/parametric_assembly.h"

namespace mortise::composer {

// Immutable; safe to share between threads.
class DragSpace {
 public:
  // O(degrees of freedom² · parameters).
  explicit DragSpace(std::shared_ptr<const parametric::ParametricAssembly> assembly);

  const std::shared_ptr<const parametric::ParametricAssembly>& assembly() const {
    return assembly_;
  }

  // Returns the feasible set in parameters in space (InSpace), with distances by ChangeScales.
  const parametric::FeasibleSet& free() const { return free_; }

  // Returns z of parameters in space: those of the set's own subspace nearest to them.
  Eigen::VectorXd CoordinatesOf(const Eigen::VectorXd& in_space) const;

  // Returns how much memory it takes besides the assembly, bytes.
  std::size_t MemoryUse() const;

 private:
  std::shared_ptr<const parametric::ParametricAssembly> assembly_;
  Eigen::VectorXd weights_;  // of squares of changes
  parametric::FeasibleSet free_;
};

}  // namespace mortise::composer
