// Changes of external ids and labels as a person types them.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/client/resource_access.h"

namespace mortise::cli {

struct TagChanges {
  std::vector<std::string> labels = {};        // KEY=VALUE to set one, KEY- to take one away
  std::vector<std::string> external_ids = {};  // to add
  std::vector<std::string> removed_external_ids = {};  // to take away

  bool empty() const {
    return labels.empty() && external_ids.empty() && removed_external_ids.empty();
  }
};

// `tags` after the changes. What is there already, or is not there to be taken away, stays as it
// is. INVALID_ARGUMENT naming "change" or "--external-id": another form, a label or an external id
// that is changed twice.
absl::StatusOr<Tags> WithChanges(Tags tags, const TagChanges& changes);

}  // namespace mortise::cli
