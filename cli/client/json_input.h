// Messages that people write as JSON, in files and on the command line.
#pragma once

#include <google/protobuf/message.h>

#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace mortise::cli {

// Reads `json` into `message`. INVALID_ARGUMENT with everything that is wrong, at fields of
// `origin` ("case.json: loads[0].force"), or the text as a whole at `origin`.
absl::Status ReadJson(std::string_view json, const std::string& origin,
                      google::protobuf::Message& message);

}  // namespace mortise::cli
