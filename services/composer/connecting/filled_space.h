// What fills space while connections are looked for: both sides, and the connecting parts so far.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "common/assembly/connections/connection_optimizer.h"
#include "services/composer/connecting/candidate.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {

class FilledSpace {
 public:
  // Both sides as they are; they need not outlive it. O(parts).
  explicit FilledSpace(const BothSides& sides);

  // Returns into what else than it connects a connection's own parts would run, for people; empty
  // if into nothing. `sides` are those that it was made of.
  std::string ClashOf(const Candidate& candidate, const parametric::OptimizedConnection& placed,
                      const BothSides& sides) const;

  // Adds the connecting parts of a connection that is used.
  void Add(const Candidate& candidate, const parametric::OptimizedConnection& placed);

 private:
  std::vector<SolidPart> body_, component_, connecting_;
};

}  // namespace mortise::composer
