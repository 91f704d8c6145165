#include "services/composer/holding/unheld_parts.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/composer/holding/joint_rules.h"
#include "services/composer/holding/joints.h"

namespace mortise::composer {

std::vector<UnheldParts> FindUnheldParts(const parametric::Assembly& drawn,
                                         const std::vector<CollectionConnection>& connections,
                                         const std::vector<parametric::Item>& items,
                                         const DesignOf& design_of) {
  // What the principals are made of does not matter.
  const std::vector<Joint> joints = JointsOf(drawn, connections, items, {});
  std::vector<UnheldParts> unheld;
  for (Finding& finding : JudgeWhole(PrincipalNames(drawn), joints)) {
    if (finding.rule != kUnconnected && finding.rule != kOnlyTouches) continue;
    unheld.push_back(
        {std::move(finding.parts), absl::StrCat("held by nothing now: ", finding.text)});
  }
  for (Finding& finding : JudgeMotion(drawn, joints, design_of)) {
    unheld.push_back({std::move(finding.parts), std::move(finding.text)});
  }
  return unheld;
}

absl::StatusOr<std::vector<UnheldParts>> FindUnheldParts(const Design& design,
                                                         const std::vector<parametric::Item>& items,
                                                         const DesignOf& design_of) {
  MORTISE_ASSIGN_OR_RETURN(const Redrawn redrawn, Redraw(design));
  const parametric::Assembly& drawn = redrawn.assembly;
  MORTISE_ASSIGN_OR_RETURN(const std::vector<CollectionConnection> connections,
                           ConnectionsOf(drawn.name, drawn));
  return FindUnheldParts(drawn, connections, items, OfRedrawn(redrawn, design_of));
}

}  // namespace mortise::composer
