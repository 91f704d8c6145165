// The flags that give what a command makes external ids and labels: said once for all commands.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/client/command_flags.h"

namespace mortise::cli {

// What the flags were given, as it was typed.
struct TagOptions {
  std::vector<std::string> external_ids = {};  // --external-id TEXT, again for more
  std::vector<std::string> labels = {};        // --label KEY=VALUE, again for more

  bool empty() const { return external_ids.empty() && labels.empty(); }
};

// Declares both flags of a command that makes something.
void AddTagOptions(CommandFlags& flags, TagOptions& options);

// "KEY=VALUE" each, as a map; values may be empty. INVALID_ARGUMENT naming `flag`: another form, a
// key that is there twice.
absl::StatusOr<std::map<std::string, std::string>> ParseLabels(
    const std::vector<std::string>& texts, const std::string& flag = "--label");

// Puts the tags into a request that makes something. INVALID_ARGUMENT as ParseLabels.
template <typename Request>
absl::Status AddTags(const TagOptions& options, Request* request) {
  absl::StatusOr<std::map<std::string, std::string>> labels = ParseLabels(options.labels);
  if (!labels.ok()) return labels.status();
  request->mutable_external_ids()->Assign(options.external_ids.begin(), options.external_ids.end());
  request->mutable_labels()->insert(labels->begin(), labels->end());
  return absl::OkStatus();
}

}  // namespace mortise::cli
