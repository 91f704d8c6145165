#include "services/catalog/exchange/design_identity.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"

namespace mortise::catalog {

std::string StepTime(const google::protobuf::Timestamp& time) {
  if (time.seconds() == 0) return "";
  return absl::FormatTime("%Y-%m-%dT%H:%M:%S", absl::FromUnixSeconds(time.seconds()),
                          absl::UTCTimeZone());
}

cad::StepIdentity ProductIdentity(const parametric::EvaluatedPart& part,
                                  const DesignIdentity& design) {
  cad::StepIdentity identity;
  identity.revision = design.whole.revision;
  std::vector<std::string> made_of;
  if (!part.item.empty()) made_of.push_back(part.item);
  if (const auto item = design.items.find(part.item); item != design.items.end()) {
    made_of.push_back(absl::StrCat("revision ", item->second.revision));
    if (part.process == parametric::Process::kNone) {
      identity.id = item->second.external_id;
      identity.revision = absl::StrCat(item->second.revision);
    }
  }
  if (!part.material.empty()) made_of.push_back(part.material);
  identity.description = absl::StrJoin(made_of, ", ");
  return identity;
}

}  // namespace mortise::catalog
