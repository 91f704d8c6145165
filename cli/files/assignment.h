// "NAME=VALUE" as flags have it.
#pragma once

#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::cli {

// Returns both halves, neither empty. INVALID_ARGUMENT naming `option`.
inline absl::StatusOr<std::pair<std::string, std::string>> SplitAssignment(
    const std::string& text, const std::string& option) {
  const std::size_t split = text.find('=');
  if (split == std::string::npos || split == 0 || split + 1 == text.size()) {
    return InvalidField(option, absl::StrCat("'", text, "' is not of the form NAME=VALUE"));
  }
  return std::pair(text.substr(0, split), text.substr(split + 1));
}

}  // namespace mortise::cli
