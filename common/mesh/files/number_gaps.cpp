#include "common/mesh/files/number_gaps.h"

#include <algorithm>
#include <map>

#include "absl/strings/str_cat.h"

namespace mortise::mesh {

std::string NumberGaps(std::vector<std::int64_t> numbers) {
  std::sort(numbers.begin(), numbers.end());
  std::map<std::uint64_t, std::uint64_t> times;  // that each step is taken
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    // As unsigned numbers, of which the difference of any two is one.
    ++times[static_cast<std::uint64_t>(numbers[i]) - static_cast<std::uint64_t>(numbers[i - 1])];
  }
  const auto step = std::max_element(
      times.begin(), times.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (times.size() < 2 || step->first == 0) return "";
  std::uint64_t missing = 0;
  for (const auto& [size, count] : times) {
    if (size > 0) missing += count * ((size - 1) / step->first);
  }
  if (missing == 0) return "";
  return absl::StrCat("run from ", numbers.front(), " to ", numbers.back(), " by ", step->first,
                      ", and ", missing, missing == 1 ? " is missing" : " are missing");
}

}  // namespace mortise::mesh
