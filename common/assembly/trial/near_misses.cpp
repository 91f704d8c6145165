#include "common/assembly/trial/near_misses.h"

#include <algorithm>
#include <cmath>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/assembly/trial/drawn_contacts.h"

namespace mortise::parametric {
namespace {

// m. Parts that miss each other by no more may be meant to touch: the largest tolerance that a
// drawing may have closes such a gap.
constexpr double kNearMiss = 0.9e-3;
constexpr double kAboveGap = 1.1;   // times the gap is a tolerance that closes it
constexpr double kStep = 1e-7;      // m; tolerances are given to this
constexpr double kRounding = 1e-3;  // of a step
constexpr std::size_t kMaxMissesTold = 3;

}  // namespace

std::string TellOfNearMisses(const Assembly& assembly, const std::vector<Element>& elements,
                             double tolerance, const std::vector<int>& loose) {
  const absl::StatusOr<std::vector<NearMiss>> misses =
      FindNearMisses(assembly, tolerance, kNearMiss);
  if (!misses.ok()) return "";
  const std::vector<int> element_of = ElementsOfParts(assembly, elements);
  const auto is_loose = [&](int part) {
    const int element = element_of[static_cast<std::size_t>(part)];
    return std::find(loose.begin(), loose.end(), element) != loose.end();
  };
  std::string told;
  std::size_t count = 0;
  double widest = 0;
  for (const NearMiss& miss : *misses) {
    if (!is_loose(miss.first) && !is_loose(miss.second)) continue;
    if (++count > kMaxMissesTold) break;
    const auto name = [&](int part) {
      return absl::StrCat("'", assembly.parts[static_cast<std::size_t>(part)].name, "'");
    };
    const bool is_first = is_loose(miss.first);
    absl::StrAppend(&told, count == 1 ? "; " : ", ", name(is_first ? miss.first : miss.second),
                    " misses ", name(is_first ? miss.second : miss.first), " by ",
                    absl::StrFormat("%.3g mm", 1e3 * miss.gap));
    widest = std::max(widest, miss.gap);
  }
  if (told.empty()) return "";
  // What a drawing misses by less than its tolerance is one plane.
  const double enough = std::ceil(widest * kAboveGap / kStep - kRounding) * kStep;
  return absl::StrCat(told, ", which is more than what counts as touching (",
                      absl::StrFormat("%.3g mm", 1e3 * tolerance),
                      "): close the gap in the drawing, or import it with 'tolerance' ",
                      absl::StrFormat("%.4g m", enough), " in its annotations");
}

}  // namespace mortise::parametric
