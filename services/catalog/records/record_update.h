// What Update methods do with a field mask, whatever kind of record they change.
#pragma once

#include <google/protobuf/util/field_mask_util.h>

#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"

namespace mortise::catalog {

// Fails with INVALID_ARGUMENT, "update_mask", for each field that a Message does not have, and for
// those that the service alone sets.
template <typename Message>
absl::Status CheckUpdateMask(const google::protobuf::FieldMask& mask) {
  using google::protobuf::util::FieldMaskUtil;
  static const std::set<std::string> kOfTheService = {"name", "revision", "update_time",
                                                      "create_time", "creator"};
  std::vector<FieldViolation> violations;
  for (const std::string& path : mask.paths()) {
    if (!FieldMaskUtil::IsValidPath<Message>(path)) {
      violations.push_back({"update_mask", absl::StrCat("there is no field '", path, "'")});
    } else if (kOfTheService.count(path.substr(0, path.find('.'))) != 0) {
      violations.push_back({"update_mask", absl::StrCat("'", path, "' cannot be changed")});
    }
  }
  return violations.empty() ? absl::OkStatus() : InvalidFields(violations);
}

// Returns the present message with the fields of the mask taken from `changes`; all but the name
// where the mask is empty.
template <typename Message>
Message Updated(Message present, const Message& changes, const google::protobuf::FieldMask& mask) {
  using google::protobuf::util::FieldMaskUtil;
  if (mask.paths().empty()) {
    Message replaced = changes;
    replaced.set_name(present.name());
    return replaced;
  }
  FieldMaskUtil::MergeOptions options;
  options.set_replace_repeated_fields(true);
  options.set_replace_message_fields(true);
  FieldMaskUtil::MergeMessageTo(changes, mask, options, &present);
  return present;
}

}  // namespace mortise::catalog
