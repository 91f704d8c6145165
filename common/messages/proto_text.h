// Reads protobuf text that people wrote.
#pragma once

#include <google/protobuf/message.h>

#include <cstddef>
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace mortise::parametric {

inline constexpr std::size_t kMaxTextBytes = std::size_t{4} << 20;

// Parses `text` into `message`. INVALID_ARGUMENT with every fault at its place, "`origin`: line 3,
// column 7"; RESOURCE_EXHAUSTED past 4 MiB.
absl::Status ParseProtoText(std::string_view text, const std::string& origin,
                            google::protobuf::Message& message);

}  // namespace mortise::parametric
