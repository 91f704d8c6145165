// Requests as the parameters of a URL, for what is read by GET.
#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"

namespace google::protobuf {
class Descriptor;
}

namespace mortise::gateway {

// Returns the JSON of a message of `type` whose fields `parameters` give: each is named by its
// path, as failures name fields ("name", "parameters[0].value", "labels[customer]",
// "filter.creator"), in either form of field names, and has a number, a truth value, the name of an
// enum's value or a text. Lists begin at [0] and have no gaps. Instead of all of these, `message`
// may hold the whole as JSON, which is then returned as it is.
//
// Whether the values are of their fields' types is for Transcoder::ToBinary to say.
// INVALID_ARGUMENT naming the parameter: no such field, a path that does not lead to a value, an
// index beyond the list, `message` beside others.
absl::StatusOr<std::string> JsonOfQuery(const google::protobuf::Descriptor& type,
                                        const std::map<std::string, std::string>& parameters);

}  // namespace mortise::gateway
