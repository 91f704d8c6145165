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

void ShareNoIds(std::vector<cad::StepProduct>& products) {
  std::map<std::string, int> uses;
  for (const cad::StepProduct& product : products) ++uses[product.identity.id];
  for (cad::StepProduct& product : products) {
    cad::StepIdentity& identity = product.identity;
    if (identity.id.empty() || uses[identity.id] == 1) continue;
    identity.description =
        absl::StrCat(identity.id, identity.description.empty() ? "" : ", ", identity.description);
    identity.id.clear();
  }
}

}  // namespace mortise::catalog
