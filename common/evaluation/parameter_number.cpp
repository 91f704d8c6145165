#include "common/evaluation/parameter_number.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"

namespace mortise::evaluation {

absl::StatusOr<double> NumberOf(const v1::ParameterValue& given,
                                const google::protobuf::RepeatedPtrField<std::string>& choices,
                                const std::string& field) {
  if (given.choice().empty()) return given.value();
  if (choices.empty()) {
    return InvalidField(
        field + ".choice",
        absl::StrCat("'", given.name(), "' is a number, no choice, so it cannot be '",
                     given.choice(), "'"));
  }
  const auto found = std::find(choices.begin(), choices.end(), given.choice());
  if (found == choices.end()) {
    return InvalidField(field + ".choice",
                        absl::StrCat("'", given.name(), "' has no value '", given.choice(),
                                     "'; it has ", absl::StrJoin(choices, ", ")));
  }
  const auto number = static_cast<double>(found - choices.begin());
  if (given.value() == 0 || given.value() == number) return number;
  return InvalidField(field + ".choice",
                      absl::StrCat("'", given.choice(), "' is value ", number, " of '",
                                   given.name(), "', not ", given.value()));
}

}  // namespace mortise::evaluation
