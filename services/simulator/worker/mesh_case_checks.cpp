#include "services/simulator/worker/mesh_case_checks.h"

#include <algorithm>

namespace mortise::simulator {
namespace {

bool HasControlCharacters(const std::string& text) {
  return std::any_of(text.begin(), text.end(),
                     [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

}  // namespace

std::string At(const std::string& field, const char* list, int i) {
  return absl::StrCat(field, ".", list, "[", i, "]");
}

absl::Status CheckCount(int count, int most, const std::string& field) {
  if (count <= most) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("has ", count, " entries; ", most, " are allowed"));
}

absl::Status CheckLabel(const std::string& text, const std::string& field) {
  if (text.size() > kMaxLabelLength) {
    return InvalidField(field, absl::StrCat("is longer than ", kMaxLabelLength, " bytes"));
  }
  if (HasControlCharacters(text)) return InvalidField(field, "has control characters");
  return absl::OkStatus();
}

absl::Status CheckGroups(const Texts& groups, bool may_be_all, const std::string& field) {
  MORTISE_RETURN_IF_ERROR(CheckCount(groups.size(), kMaxConditions, field + ".groups"));
  if (groups.empty() && !may_be_all) {
    return InvalidField(field + ".groups", "must name at least one group of the mesh");
  }
  for (int i = 0; i < groups.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(CheckLabel(groups[i], At(field, "groups", i)));
  }
  return absl::OkStatus();
}

absl::Status CheckGiven(bool is_given, const std::string& field) {
  return is_given ? absl::OkStatus() : InvalidField(field, "is missing");
}

}  // namespace mortise::simulator
