#include "services/composer/service/unheld_warnings.h"

#include <algorithm>
#include <functional>
#include <vector>

#include "common/base/errors.h"
#include "services/composer/holding/unheld_parts.h"
#include "services/composer/service/bundle_contents.h"

namespace mortise::composer {
namespace {

std::set<std::string> PartsWarnedOf(const OpenModel& model) {
  std::set<std::string> parts;
  for (const v1::ModelWarning& warning : model.warnings) {
    parts.insert(warning.elements().begin(), warning.elements().end());
  }
  return parts;
}

absl::Status Warn(const std::function<bool(const std::string&)>& is_of_interest,
                  const Drawing& drawing, OpenModel* model) {
  MORTISE_ASSIGN_OR_RETURN(const BundleContents contents, ContentsOf(drawing.bundle));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<UnheldParts> all,
                           FindUnheldParts(model->body->design, contents.items, DesignsIn(*model)));
  std::erase_if(model->warnings, IsOfUnheld);
  for (const UnheldParts& unheld : all) {
    if (std::none_of(unheld.parts.begin(), unheld.parts.end(), is_of_interest)) continue;
    v1::ModelWarning& added = model->warnings.emplace_back();
    const auto owner = model->owners.find(unheld.parts.front());
    if (owner != model->owners.end()) added.set_component(owner->second);
    added.set_element(unheld.parts.front());
    added.mutable_elements()->Assign(unheld.parts.begin(), unheld.parts.end());
    added.set_text(unheld.text);
  }
  return absl::OkStatus();
}

std::set<std::string> AllPartsOf(const std::vector<UnheldParts>& all) {
  std::set<std::string> parts;
  for (const UnheldParts& unheld : all) parts.insert(unheld.parts.begin(), unheld.parts.end());
  return parts;
}

}  // namespace

bool IsOfUnheld(const v1::ModelWarning& warning) { return !warning.elements().empty(); }

absl::StatusOr<std::set<std::string>> UnheldByDesign(const OpenModel& model,
                                                     const Drawing& drawing) {
  MORTISE_ASSIGN_OR_RETURN(const BundleContents contents, ContentsOf(drawing.bundle));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<UnheldParts> all,
                           FindUnheldParts(model.body->design, contents.items, DesignsIn(model)));
  std::set<std::string> parts = AllPartsOf(all);
  for (const std::string& part : PartsWarnedOf(model)) parts.erase(part);
  return parts;
}

absl::StatusOr<std::set<std::string>> UnheldByDesign(
    const Design& whole, const std::vector<CollectionConnection>& connections,
    const Drawing& drawing) {
  MORTISE_ASSIGN_OR_RETURN(const BundleContents contents, ContentsOf(drawing.bundle));
  return AllPartsOf(FindUnheldParts(whole.assembly->assembly(), connections, contents.items));
}

absl::Status WarnOfUnheld(const std::set<std::string>& by_design, const Drawing& drawing,
                          OpenModel* model) {
  return Warn([&](const std::string& part) { return !by_design.contains(part); }, drawing, model);
}

bool IsFastened(const Connected& connected) {
  return std::any_of(connected.connections.begin(), connected.connections.end(),
                     [](const MadeConnection& made) { return !made.parts.empty(); });
}

absl::Status WarnOfUnheldNow(const Connected& connected, const UnheldBefore& before,
                             const Drawing& drawing, OpenModel* model) {
  std::set<std::string> of_interest = PartsWarnedOf(*model);
  const bool is_fastened = IsFastened(connected);
  const auto& parts = connected.model.assembly->assembly().parts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Provenance& from = connected.parts[i];
    const bool is_new =
        (from.from == Provenance::From::kComponent && !before.component.contains(from.name)) ||
        (from.from == Provenance::From::kBody && !is_fastened && !before.body.contains(from.name));
    if (is_new) of_interest.insert(parts[i].name);
  }
  return Warn([&](const std::string& part) { return of_interest.contains(part); }, drawing, model);
}

}  // namespace mortise::composer
