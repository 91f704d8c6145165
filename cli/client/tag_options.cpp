#include "cli/client/tag_options.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::cli {

void AddTagOptions(CommandFlags& flags, TagOptions& options) {
  // Each flag takes one text: whatever follows it is another argument.
  flags
      .Add("--external-id", options.external_ids,
           "What another system knows it by, such as 100-4711/A; again for more", "external_ids")
      ->allow_extra_args(false);
  flags
      .Add("--label", options.labels,
           "KEY=VALUE to find it by, such as customer=acme; again for more")
      ->allow_extra_args(false);
  flags.AlsoGives("--label", "labels");  // by key, not by number
}

absl::StatusOr<std::map<std::string, std::string>> ParseLabels(
    const std::vector<std::string>& texts, const std::string& flag) {
  std::map<std::string, std::string> labels;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      return InvalidField(flag, absl::StrCat("'", text, "' is not of the form KEY=VALUE"));
    }
    const std::string key = text.substr(0, equals);
    if (!labels.emplace(key, text.substr(equals + 1)).second) {
      return InvalidField(flag, absl::StrCat("'", key, "' is there twice"));
    }
  }
  return labels;
}

}  // namespace mortise::cli
