#include "cli/client/json_input.h"

#include <google/protobuf/util/json_util.h>

#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/text_encoding.h"
#include "common/messages/json_faults.h"

namespace mortise::cli {

absl::Status ReadJson(std::string_view json, const std::string& origin,
                      google::protobuf::Message& message) {
  MORTISE_ASSIGN_OR_RETURN(json, WithoutByteOrderMark(json, origin));
  const auto read = google::protobuf::util::JsonStringToMessage(
      google::protobuf::StringPiece(json.data(), json.size()), &message);
  std::vector<FieldViolation> faults = JsonFaults(json, *message.GetDescriptor(), read);
  if (faults.empty()) return absl::OkStatus();
  for (FieldViolation& fault : faults) {
    fault.field = fault.field.empty() ? origin : absl::StrCat(origin, ": ", fault.field);
  }
  return InvalidFields(faults);
}

}  // namespace mortise::cli
