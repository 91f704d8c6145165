// Reads messages from JSON and finds everything in them that cannot be read or is there twice;
// protobuf's own reader tells of the first only, or takes the last. Target mortise_template_codec.
#pragma once

#include <google/protobuf/message.h>

#include <string_view>
#include <vector>

#include "common/design/template_validation.h"
#include "common/files/message_checks.h"

namespace mortise::parametric {

// Puts into `message` what can be read of `text`, proto3 JSON with either form of field names. The
// findings, none if that is all, name fields as the message has them ("dimensions[1].size"); each
// is in `unread` as well, but that of fields that there are not. What can be read of nothing else
// has an empty field: text that is no JSON object. Linear in the text's length.
std::vector<FieldViolation> ReadJsonMessage(std::string_view text,
                                            google::protobuf::Message& message,
                                            UnreadFields& unread);

}  // namespace mortise::parametric
