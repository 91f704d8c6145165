#include "common/base/violation_lists.h"

#include <string>

#include "common/base/errors.h"

namespace mortise {

std::vector<FieldViolation> AllViolationsOf(const absl::Status& status) {
  if (!absl::IsInvalidArgument(status)) return {};
  std::vector<FieldViolation> violations = ViolationsOf(status);
  if (!violations.empty()) return violations;
  const std::string field = DetailOf(status).field;
  std::string message(status.message());
  if (message.starts_with(field + ": ")) message.erase(0, field.size() + 2);
  return {{field, message}};
}

absl::Status CombineViolations(const absl::Status& first, const absl::Status& second) {
  if (first.ok()) return second;
  if (second.ok() || !absl::IsInvalidArgument(first)) return first;
  if (!absl::IsInvalidArgument(second)) return second;
  std::vector<FieldViolation> all = AllViolationsOf(first);
  for (FieldViolation& violation : AllViolationsOf(second)) all.push_back(std::move(violation));
  return InvalidFields(all);
}

}  // namespace mortise
