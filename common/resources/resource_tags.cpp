#include "common/resources/resource_tags.h"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace mortise::resources {
namespace {

bool HasControlCharacter(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const unsigned char byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  });
}

bool IsLabelKey(std::string_view key) {
  if (key.empty() || key.size() > kMaxLabelKeyBytes) return false;
  const auto may_stand_within = [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == '.' ||
           c == '/';
  };
  return absl::ascii_isalnum(static_cast<unsigned char>(key.front())) &&
         absl::ascii_isalnum(static_cast<unsigned char>(key.back())) &&
         std::all_of(key.begin(), key.end(), may_stand_within);
}

// What is wrong with one external id; empty if nothing is.
std::string FaultOfExternalId(const std::string& id) {
  if (id.empty()) return "is empty";
  if (id.size() > kMaxExternalIdBytes) {
    return absl::StrCat("has more than ", kMaxExternalIdBytes, " bytes");
  }
  if (HasControlCharacter(id)) return "has a control character";
  return "";
}

void CheckLabel(const std::string& key, const std::string& value,
                std::vector<FieldViolation>& violations) {
  // A key may be of any length and hold anything: what is told of it is short and printable.
  const std::string shown = absl::CHexEscape(key.substr(0, kMaxLabelKeyBytes));
  if (!IsLabelKey(key)) {
    violations.push_back(
        {"labels", absl::StrCat("the key '", shown, "' must be 1 to ", kMaxLabelKeyBytes,
                                " letters, digits, '-', '_', '.' and '/', and begin and end with a "
                                "letter or digit")});
    return;
  }
  if (value.size() > kMaxLabelValueBytes) {
    violations.push_back({"labels", absl::StrCat("the value of '", shown, "' has more than ",
                                                 kMaxLabelValueBytes, " bytes")});
  } else if (HasControlCharacter(value)) {
    violations.push_back(
        {"labels", absl::StrCat("the value of '", shown, "' has a control character")});
  }
}

}  // namespace

std::vector<FieldViolation> CheckTags(const ExternalIds& external_ids, const Labels& labels) {
  std::vector<FieldViolation> violations;
  if (external_ids.size() > kMaxExternalIds) {
    violations.push_back({"external_ids", absl::StrCat("has more than ", kMaxExternalIds)});
  } else {
    std::set<std::string> seen;
    for (int i = 0; i < external_ids.size(); ++i) {
      std::string fault = FaultOfExternalId(external_ids[i]);
      if (fault.empty() && !seen.insert(external_ids[i]).second) fault = "is there twice";
      if (!fault.empty()) violations.push_back({absl::StrCat("external_ids[", i, "]"), fault});
    }
  }
  if (labels.size() > kMaxLabels) {
    violations.push_back({"labels", absl::StrCat("has more than ", kMaxLabels)});
    return violations;
  }
  // A map of protobuf has no order; what is wrong is told in that of the keys.
  for (const auto& [key, value] :
       std::map<std::string, std::string>(labels.begin(), labels.end())) {
    CheckLabel(key, value, violations);
  }
  return violations;
}

absl::Status ValidateTags(const ExternalIds& external_ids, const Labels& labels) {
  const std::vector<FieldViolation> violations = CheckTags(external_ids, labels);
  return violations.empty() ? absl::OkStatus() : InvalidFields(violations);
}

bool HaveSameTags(const ExternalIds& external_ids, const Labels& labels,
                  const ExternalIds& other_external_ids, const Labels& other_labels) {
  const auto has_label = [&](const auto& label) {
    const auto found = other_labels.find(label.first);
    return found != other_labels.end() && found->second == label.second;
  };
  return std::equal(external_ids.begin(), external_ids.end(), other_external_ids.begin(),
                    other_external_ids.end()) &&
         labels.size() == other_labels.size() &&
         std::all_of(labels.begin(), labels.end(), has_label);
}

absl::Status CheckTagMask(const google::protobuf::FieldMask& mask) {
  std::vector<FieldViolation> violations;
  for (const std::string& path : mask.paths()) {
    if (path == "external_ids" || path == "labels") continue;
    violations.push_back(
        {"update_mask", absl::StrCat("'", absl::CHexEscape(path.substr(0, 100)),
                                     "' cannot be changed; only 'external_ids' and 'labels' can")});
  }
  return violations.empty() ? absl::OkStatus() : InvalidFields(violations);
}

}  // namespace mortise::resources
