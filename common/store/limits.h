// What names and payloads a store accepts.
#pragma once

#include <string_view>

#include "absl/status/status.h"

namespace mortise::store {

// Fails with INVALID_ARGUMENT naming `field` unless `name` is valid UTF-8 of at most 1024 bytes
// without control characters.
absl::Status CheckName(std::string_view field, std::string_view name);

// The same, and not empty.
absl::Status CheckRequiredName(std::string_view field, std::string_view name);

// Fails with RESOURCE_EXHAUSTED naming `field` past 64 MiB.
absl::Status CheckPayload(std::string_view field, std::string_view payload);

// Fails with INVALID_ARGUMENT naming `field` unless 1 <= limit <= 10000 (events: at most 100000).
absl::Status CheckLimit(std::string_view field, int limit, int most = 10000);

}  // namespace mortise::store
