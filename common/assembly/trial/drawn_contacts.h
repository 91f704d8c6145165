// What touches as drawn.
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/relations/relationship.h"

namespace mortise::parametric {

// By their index in the assembly, lower first.
using TouchingParts = std::set<std::pair<int, int>>;

// Parts that come within `tolerance`, m, of each other; where faces are curved, within that and
// what the triangles may miss. By trees of their triangles (proximity.h). Fails as those.
absl::StatusOr<TouchingParts> FindTouchingParts(const Assembly& assembly, double tolerance);

// Elements of which some part touches a part of the other.
Contacts ContactsOf(const TouchingParts& touching, const Assembly& assembly,
                    const std::vector<Element>& elements);

// Both in one.
absl::StatusOr<Contacts> FindContacts(const Assembly& assembly,
                                      const std::vector<Element>& elements, double tolerance);

}  // namespace mortise::parametric
