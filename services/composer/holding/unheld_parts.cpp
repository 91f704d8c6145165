#include "services/composer/holding/unheld_parts.h"

#include <utility>

#include "common/base/errors.h"
#include "services/composer/connecting/part_connection.h"
#include "services/composer/holding/joint_rules.h"
#include "services/composer/holding/joints.h"

namespace mortise::composer {

absl::StatusOr<std::vector<UnheldParts>> FindUnheldParts(const Design& design) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Assembly drawn, DrawnAt(design));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<CollectionConnection> connections,
                           ConnectionsOf(drawn.name, drawn));
  // What the fasteners are does not matter for whether there are any.
  const std::vector<Joint> joints = JointsOf(drawn, connections, {}, {});
  std::vector<UnheldParts> unheld;
  for (Finding& finding : JudgeWhole(PrincipalNames(drawn), joints)) {
    if (finding.rule != kUnconnected && finding.rule != kOnlyTouches) continue;
    unheld.push_back({std::move(finding.parts), std::move(finding.text)});
  }
  return unheld;
}

}  // namespace mortise::composer
