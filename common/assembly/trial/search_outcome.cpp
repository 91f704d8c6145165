#include "common/assembly/trial/search_outcome.h"

#include <algorithm>

namespace mortise::parametric {

bool NamesPartsOf(const SearchOutcome& outcome, std::size_t parts) {
  const auto is_part = [parts](int part) {
    return part >= 0 && static_cast<std::size_t>(part) < parts;
  };
  const auto are_parts = [&](const auto& pairs) {
    return std::all_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
      return is_part(pair.first) && is_part(pair.second);
    });
  };
  const auto& [lone, conflicts] = outcome.repair_plan;
  return are_parts(outcome.touching) && are_parts(outcome.pattern_losses) &&
         std::all_of(lone.begin(), lone.end(), is_part) && are_parts(conflicts.kept_apart) &&
         are_parts(conflicts.kept_touching) && are_parts(conflicts.fitted) &&
         std::all_of(conflicts.shares_kept.begin(), conflicts.shares_kept.end(),
                     [&](const auto& kept) { return is_part(kept.first.first); });
}

}  // namespace mortise::parametric
