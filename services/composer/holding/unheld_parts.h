// Finds what of a model nothing holds, as may be when a node is taken out of it (thesis §5.4).
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// Principal parts that are joined to each other, and to nothing that stands.
struct UnheldParts {
  std::vector<std::string> parts;  // as PlacedPart says
  std::string text;                // in which way, for people
};

// Returns the parts of a design, as it is now, that JudgeWhole (joint_rules.h) finds unconnected or
// only touching the rest: no fastener leads from them to what stands. Whether they are glued is not
// known, so that parts of designs of experts may be among them. Fails as DrawnAt and ConnectionsOf.
// O(parts²): an assembly of 200 parts takes some 50 ms.
absl::StatusOr<std::vector<UnheldParts>> FindUnheldParts(const Design& design);

}  // namespace mortise::composer
