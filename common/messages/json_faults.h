// Everything that is wrong with a message that somebody wrote as JSON; protobuf's own reader tells
// of the first fault only, and takes the last of a field that is there twice. Target
// mortise_message_faults.
#pragma once

#include <google/protobuf/util/json_util.h>

#include <string_view>
#include <vector>

#include "common/base/field_violations.h"

namespace google::protobuf {
class Descriptor;
}

namespace mortise {

// Returns the faults of `json`, proto3 JSON with either form of field names, as a message of
// `type`, of which protobuf's reader said `read`; none if it can be taken as it was read. Fields
// are named as the message has them ("parameters[1].value", limits["width"]), those that there are
// not as the text does; what is wrong with the text as a whole has an empty field. Of very many,
// the first 40.
//
// NaN and the infinities are no numbers of JSON, but texts; where they stand as bare words, the
// field is named with how to write them, and nothing behind it is looked at.
//
// Whatever `read` is, it is a fault to give a field or a key twice, also by both of its names, to
// give a key of a map the value null, and to write what is not quite JSON, such as names without
// quotes. Takes time in proportion to the
// text's length, and less than reading it did.
std::vector<FieldViolation> JsonFaults(std::string_view json,
                                       const google::protobuf::Descriptor& type,
                                       const google::protobuf::util::Status& read);

}  // namespace mortise
