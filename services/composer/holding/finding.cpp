#include "services/composer/holding/finding.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

namespace mortise::composer {

const char* SeverityName(Severity severity) {
  constexpr const char* kNames[] = {"notice", "warning", "fault"};
  return kNames[static_cast<std::size_t>(severity)];
}

std::vector<Finding> Ordered(std::vector<Finding> findings) {
  std::vector<Finding> joined;
  std::map<std::tuple<Severity, std::string, std::string>, std::size_t> index_of;
  for (Finding& finding : findings) {
    const auto [known, is_new] =
        index_of.emplace(std::tuple(finding.severity, finding.rule, finding.text), joined.size());
    if (is_new) {
      joined.push_back(std::move(finding));
      continue;
    }
    std::vector<std::string>& parts = joined[known->second].parts;
    for (std::string& part : finding.parts) {
      if (std::find(parts.begin(), parts.end(), part) == parts.end()) {
        parts.push_back(std::move(part));
      }
    }
  }
  std::stable_sort(joined.begin(), joined.end(),
                   [](const auto& a, const auto& b) { return a.severity > b.severity; });
  return joined;
}

}  // namespace mortise::composer
