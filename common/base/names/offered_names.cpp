#include "common/base/names/offered_names.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace mortise {
namespace {

constexpr std::size_t kShown = 20;

// Edits of single letters that make one text of the other; upper and lower case are the same.
int EditDistance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    int diagonal = std::exchange(row[0], static_cast<int>(i) + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const bool same = std::tolower(static_cast<unsigned char>(a[i])) ==
                        std::tolower(static_cast<unsigned char>(b[j]));
      const int edited = std::min({row[j], row[j + 1], diagonal - (same ? 1 : 0)}) + 1;
      diagonal = std::exchange(row[j + 1], edited);
    }
  }
  return row[b.size()];
}

}  // namespace

std::optional<std::string> NearestName(const std::string& name,
                                       const std::vector<std::string>& names) {
  const int most_edits = 1 + static_cast<int>(name.size()) / 3;
  const std::string* nearest = nullptr;
  int fewest = std::numeric_limits<int>::max();
  for (const std::string& each : names) {
    // A text of another length takes as many edits at least.
    const auto longer = std::max(each.size(), name.size()) - std::min(each.size(), name.size());
    if (longer > static_cast<std::size_t>(most_edits)) continue;
    const int edits = EditDistance(each, name);
    if (edits >= fewest) continue;
    fewest = edits;
    nearest = &each;
  }
  if (nearest == nullptr || fewest > most_edits) return std::nullopt;
  return *nearest;
}

std::string NearestOffered(const std::string& name, const std::vector<std::string>& names) {
  const std::optional<std::string> nearest = NearestName(name, names);
  return nearest ? absl::StrCat("; did you mean '", *nearest, "'?") : "";
}

std::string NamesOffered(const std::string& name, const std::vector<std::string>& names) {
  if (names.empty()) return "";
  std::string nearest = NearestOffered(name, names);
  if (!nearest.empty()) return nearest;
  const std::size_t shown = std::min(names.size(), kShown);
  return absl::StrCat("; there are '", absl::StrJoin(names.begin(), names.begin() + shown, "', '"),
                      "'", shown < names.size() ? " and more" : "");
}

}  // namespace mortise
