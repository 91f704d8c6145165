// Finds which parts and elements touch as drawn.
#pragma once

#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// Pairs of parts that touch, by their index in the assembly, the lower first.
using TouchingParts = std::set<std::pair<int, int>>;

// Returns the parts that come within `tolerance`, m, of each other; where faces are curved, within
// that and what the triangles may miss. They are found by trees of their triangles (proximity.h).
// Fails as FindProximities does, which tells `goes_on` how many parts have been looked at.
absl::StatusOr<TouchingParts> FindTouchingParts(
    const Assembly& assembly, double tolerance,
    const std::function<bool(std::size_t done)>& goes_on = [](std::size_t) { return true; });

// Two parts that do not touch, but nearly.
struct NearMiss {
  int first = 0;   // by index in the assembly
  int second = 0;  // a higher one
  double gap = 0;  // m, between their surfaces
};

// Returns the pairs of parts that FindTouchingParts does not return and whose surfaces come within
// `furthest`, m, of each other, the nearest first. Fails as it does.
absl::StatusOr<std::vector<NearMiss>> FindNearMisses(const Assembly& assembly, double tolerance,
                                                     double furthest);

// Returns of each part one that it belongs together with: the same one of connecting parts that
// touch each other, directly or by others; principal parts by themselves.
std::vector<int> ConnectingTogether(const Assembly& assembly, const TouchingParts& touching);

// Returns the pairs of elements of which some part touches a part of the other.
Contacts ContactsOf(const TouchingParts& touching, const Assembly& assembly,
                    const std::vector<Element>& elements);

// Finds the parts that touch, and returns the elements that do.
absl::StatusOr<Contacts> FindContacts(const Assembly& assembly,
                                      const std::vector<Element>& elements, double tolerance);

}  // namespace mortise::parametric
