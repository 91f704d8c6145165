// Finds the entry of a design that has been evaluated, so that none is evaluated twice.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <unordered_map>

#include "services/pareto/archive/archive.h"

namespace mortise::pareto {

class EvaluatedDesigns {
 public:
  // Takes an entry of `archive`; of several with the same unit coordinates, the first counts.
  void Add(const Archive& archive, std::size_t entry);

  // Returns the entry with these unit coordinates, equal to the last bit (0 and -0 are the same).
  std::optional<std::size_t> Find(const Archive& archive, const Eigen::VectorXd& u) const;

 private:
  std::unordered_multimap<std::size_t, std::size_t> entries_;  // by hash of u
};

}  // namespace mortise::pareto
