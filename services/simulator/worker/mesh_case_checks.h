// Checks that all sections of a mesh's case have in common. Failures are INVALID_ARGUMENT and name
// the field.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::simulator {

inline constexpr int kMaxConditions = 1000;
inline constexpr std::size_t kMaxLabelLength = 200;  // bytes

using Texts = google::protobuf::RepeatedPtrField<std::string>;

// Returns "case.supports[3]".
std::string At(const std::string& field, const char* list, int i);

absl::Status CheckCount(int count, int most, const std::string& field);
absl::Status CheckLabel(const std::string& text, const std::string& field);
absl::Status CheckGroups(const Texts& groups, bool may_be_all, const std::string& field);
absl::Status CheckGiven(bool is_given, const std::string& field);

// Checks a list of conditions that act on groups, and what each must have: `is_given` tells whether
// it has the field called `name`.
template <typename Conditions, typename IsGiven>
absl::Status CheckConditions(const Conditions& conditions, const std::string& field,
                             const char* list, const char* name, const IsGiven& is_given,
                             bool may_be_all = false) {
  MORTISE_RETURN_IF_ERROR(
      CheckCount(conditions.size(), kMaxConditions, absl::StrCat(field, ".", list)));
  for (int i = 0; i < conditions.size(); ++i) {
    const std::string place = At(field, list, i);
    MORTISE_RETURN_IF_ERROR(CheckGroups(conditions[i].groups(), may_be_all, place));
    MORTISE_RETURN_IF_ERROR(CheckGiven(is_given(conditions[i]), absl::StrCat(place, ".", name)));
  }
  return absl::OkStatus();
}

}  // namespace mortise::simulator
