// What fills space while connections are looked for: both sides, and the connecting parts so far.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/assembly/connections/connection_optimizer.h"
#include "services/composer/connecting/candidate.h"
#include "services/composer/connecting/side_overlaps.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {

// Of one thread.
class FilledSpace {
 public:
  // Both sides as they are; they need not outlive it. O(parts).
  explicit FilledSpace(const BothSides& sides);

  // Returns into what else than it connects a connection's own parts would run, for people; empty
  // if into nothing. `sides` are those that it was made of.
  std::string ClashOf(const Candidate& candidate, const parametric::OptimizedConnection& placed,
                      const BothSides& sides) const;

  // Where the two sides reach into each other, whether a connection has it so or not. It is looked
  // for once.
  const std::vector<SideOverlap>& Overlaps() const;

  // Adds the connecting parts of a connection that is used.
  void Add(const Candidate& candidate, const parametric::OptimizedConnection& placed);

 private:
  std::vector<SolidPart> body_, component_, connecting_;
  mutable std::optional<std::vector<SideOverlap>> overlaps_;
};

}  // namespace mortise::composer
