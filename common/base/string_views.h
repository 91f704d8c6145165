// Between the standard's string views and those of Abseil as Debian builds it, where they differ.
#pragma once

#include <string_view>

#include "absl/strings/string_view.h"

namespace mortise {

inline absl::string_view AbslView(std::string_view text) { return {text.data(), text.size()}; }

inline std::string_view StandardView(absl::string_view text) { return {text.data(), text.size()}; }

}  // namespace mortise
