// Finds what of a model nothing holds, or holds so that it cannot move as it is to, as may be when
// a component is connected, or a node is taken out (thesis §5.4, §5.6).
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/template_definition.h"
#include "services/composer/connecting/part_connection.h"
#include "services/composer/holding/motion_rules.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// Principal parts that are joined to each other, and to nothing that stands; or that cannot move.
struct UnheldParts {
  std::vector<std::string> parts;  // as PlacedPart says
  std::string text;                // in which way, for people
};

// Returns the parts of an assembly, as it is drawn, that JudgeWhole (joint_rules.h) finds
// unconnected or only touching the rest: no fastener leads from them to what stands; then those
// that JudgeMotion (motion_rules.h) finds held fast. Whether parts are glued is not known, so that
// parts of designs of experts may be among them. `connections` are all of the assembly's
// (ConnectionsOf), `items` those of its parts, and `design_of` as JudgeMotion takes it.
std::vector<UnheldParts> FindUnheldParts(const parametric::Assembly& drawn,
                                         const std::vector<CollectionConnection>& connections,
                                         const std::vector<parametric::Item>& items,
                                         const DesignOf& design_of = nullptr);

// The same of a design as it is now; `design_of` is asked of its parts as drawn. Fails as DrawnAt
// and ConnectionsOf. O(parts²): an assembly of 200 parts takes some 50 ms.
absl::StatusOr<std::vector<UnheldParts>> FindUnheldParts(const Design& design,
                                                         const std::vector<parametric::Item>& items,
                                                         const DesignOf& design_of = nullptr);

}  // namespace mortise::composer
