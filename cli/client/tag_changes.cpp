#include "cli/client/tag_changes.h"

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::cli {

absl::StatusOr<Tags> WithChanges(Tags tags, const TagChanges& changes) {
  std::set<std::string> changed;
  for (const std::string& text : changes.labels) {
    const std::size_t equals = text.find('=');
    const bool removes = equals == std::string::npos && text.size() > 1 && text.ends_with('-');
    if (!removes && (equals == std::string::npos || equals == 0)) {
      return InvalidField("change", absl::StrCat("'", text, "' is neither KEY=VALUE nor KEY-"));
    }
    const std::string key = removes ? text.substr(0, text.size() - 1) : text.substr(0, equals);
    if (!changed.insert(key).second) {
      return InvalidField("change", absl::StrCat("'", key, "' is there twice"));
    }
    if (removes) {
      tags.labels.erase(key);
    } else {
      tags.labels[key] = text.substr(equals + 1);
    }
  }
  std::vector<std::string>& ids = tags.external_ids;
  for (const std::string& id : changes.external_ids) {
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  }
  for (const std::string& id : changes.removed_external_ids) {
    const auto& added = changes.external_ids;
    if (std::find(added.begin(), added.end(), id) != added.end()) {
      return InvalidField("--external-id",
                          absl::StrCat("'", id, "' is to be added and to be taken away"));
    }
    std::erase(ids, id);
  }
  return tags;
}

}  // namespace mortise::cli
