#include "services/composer/service/unheld_warnings.h"

#include <algorithm>
#include <functional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/composer/holding/unheld_parts.h"

namespace mortise::composer {
namespace {

std::set<std::string> PartsWarnedOf(const OpenModel& model) {
  std::set<std::string> parts;
  for (const v1::ModelWarning& warning : model.warnings) {
    parts.insert(warning.elements().begin(), warning.elements().end());
  }
  return parts;
}

absl::Status Warn(const std::function<bool(const std::string&)>& is_of_interest, OpenModel* model) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<UnheldParts> all,
                           FindUnheldParts(model->body->design));
  std::erase_if(model->warnings, IsOfUnheld);
  for (const UnheldParts& unheld : all) {
    if (std::none_of(unheld.parts.begin(), unheld.parts.end(), is_of_interest)) continue;
    v1::ModelWarning& added = model->warnings.emplace_back();
    const auto owner = model->owners.find(unheld.parts.front());
    if (owner != model->owners.end()) added.set_component(owner->second);
    added.set_element(unheld.parts.front());
    added.mutable_elements()->Assign(unheld.parts.begin(), unheld.parts.end());
    added.set_text(absl::StrCat("held by nothing now: ", unheld.text));
  }
  return absl::OkStatus();
}

}  // namespace

bool IsOfUnheld(const v1::ModelWarning& warning) { return !warning.elements().empty(); }

absl::StatusOr<std::set<std::string>> UnheldByDesign(const OpenModel& model) {
  const std::set<std::string> warned = PartsWarnedOf(model);
  MORTISE_ASSIGN_OR_RETURN(const std::vector<UnheldParts> all, FindUnheldParts(model.body->design));
  std::set<std::string> parts;
  for (const UnheldParts& unheld : all) {
    for (const std::string& part : unheld.parts) {
      if (!warned.contains(part)) parts.insert(part);
    }
  }
  return parts;
}

absl::Status WarnOfUnheld(const std::set<std::string>& by_design, OpenModel* model) {
  return Warn([&](const std::string& part) { return !by_design.contains(part); }, model);
}

absl::Status WarnOfStillUnheld(OpenModel* model) {
  const std::set<std::string> warned = PartsWarnedOf(*model);
  if (warned.empty()) return absl::OkStatus();
  return Warn([&](const std::string& part) { return warned.contains(part); }, model);
}

}  // namespace mortise::composer
