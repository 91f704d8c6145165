#include "services/fabplanner/planning/saw_limits.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "services/fabplanner/planning/part_making.h"

namespace mortise::fabplanner {
namespace {

constexpr double kSameAngle = 1e-9;  // rad; a limit is meant to be reached

// The rule that the end passes, if it does; the mitre's before the bevel's.
std::optional<MachineLimit> LimitOf(const EndSlope& end, const WorkshopRules& rules) {
  const double mitre = std::abs(MitreOf(end)), bevel = std::abs(BevelOf(end));
  MachineLimit limit;
  if (mitre > rules.mitre_limit + kSameAngle) {
    limit.kind = MachineLimit::Kind::kMitre;
    limit.value = mitre;
    limit.limit = rules.mitre_limit;
    limit.reason =
        absl::StrCat("is a mitre of ", DegreesText(mitre), ", but the chop saw's table turns by ",
                     DegreesText(rules.mitre_limit), " at most");
    return limit;
  }
  if (bevel > rules.bevel_limit + kSameAngle) {
    limit.kind = MachineLimit::Kind::kBevel;
    limit.value = bevel;
    limit.limit = rules.bevel_limit;
    limit.reason =
        absl::StrCat("is a bevel of ", DegreesText(bevel), ", but the chop saw's blade tilts by ",
                     DegreesText(rules.bevel_limit), " at most");
    return limit;
  }
  if (end.across != 0 && end.through != 0 && !rules.compound_cuts) {
    limit.kind = MachineLimit::Kind::kCompound;
    limit.value = bevel;
    limit.reason = absl::StrCat("is a mitre of ", DegreesText(mitre), " with a bevel of ",
                                DegreesText(bevel), ", but the chop saw makes no compound cuts");
    return limit;
  }
  return std::nullopt;
}

CutEnds TurnedByQuarter(const CutEnds& ends) {
  const auto turned = [](const EndSlope& end) -> EndSlope { return {end.through, 0 - end.across}; };
  return {turned(ends.front), turned(ends.rear)};
}

// The ends as the board lies best for them.
CutEnds Laid(const Part& part, const CutEnds& ends, const WorkshopRules& rules) {
  if (std::abs(part.size.y() - part.size.z()) > kSizeTolerance) return ends;
  const CutEnds turned = TurnedByQuarter(ends);
  const auto bevels = [](const CutEnds& laid) {
    return (laid.front.through != 0 ? 1 : 0) + (laid.rear.through != 0 ? 1 : 0);
  };
  const auto passes = [&](const CutEnds& laid) {
    return (LimitOf(laid.front, rules) ? 1 : 0) + (LimitOf(laid.rear, rules) ? 1 : 0);
  };
  const auto trouble = [&](const CutEnds& laid) { return std::pair(passes(laid), bevels(laid)); };
  return trouble(turned) < trouble(ends) ? turned : ends;
}

}  // namespace

CutEnds SawnEnds(const Part& part, const CutEnds& ends, const WorkshopRules& rules,
                 std::vector<MachineLimit>* limits) {
  CutEnds laid = Laid(part, ends, rules);
  const auto check = [&](EndSlope* end, const char* sign) {
    std::optional<MachineLimit> limit = LimitOf(*end, rules);
    if (!limit) return;
    limit->place = absl::StrCat("end towards ", sign, std::string(1, "xyz"[part.length_axis]));
    limits->push_back(*std::move(limit));
    *end = {};
  };
  check(&laid.front, "-");
  check(&laid.rear, "+");
  return laid;
}

}  // namespace mortise::fabplanner
