#include "common/parametric/field_checks.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/identifiers.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxText = 1000;  // bytes

}  // namespace

void CheckResourceName(const std::string& name, const std::string& collection,
                       std::vector<Finding>& findings) {
  if (!ParseResourceName(name, collection, "name").ok()) {
    findings.push_back({"name", absl::StrCat("must be '", collection,
                                             "/' and 1 to 63 lower-case letters, digits and "
                                             "hyphens")});
  }
}

void CheckText(const std::string& field, const std::string& text, std::vector<Finding>& findings) {
  if (text.size() > kMaxText) {
    findings.push_back({field, absl::StrCat("is longer than ", kMaxText, " bytes")});
  }
}

// People click on links: only what leads to a page is one.
void CheckLink(const std::string& field, const std::string& link, std::vector<Finding>& findings) {
  CheckText(field, link, findings);
  if (link.empty() || link.starts_with("https://") || link.starts_with("http://")) return;
  findings.push_back({field, "must begin with https:// or http://"});
}

void CheckPositive(const std::string& field, double value, std::vector<Finding>& findings) {
  if (!(value > 0) || !std::isfinite(value)) {
    findings.push_back({field, "must be a finite number greater than 0"});
  }
}

void CheckNotNegative(const std::string& field, double value, std::vector<Finding>& findings) {
  if (!(value >= 0) || !std::isfinite(value)) {
    findings.push_back({field, "must be a finite number, at least 0"});
  }
}

bool IsMeasureName(const std::string& name) {
  if (name.empty() || name.size() > 63 || name[0] < 'a' || name[0] > 'z') return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

}  // namespace mortise::parametric
