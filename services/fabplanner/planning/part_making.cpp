#include "services/fabplanner/planning/part_making.h"

#include <array>
#include <cmath>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/compared_numbers.h"
#include "common/base/errors.h"
#include "services/fabplanner/plan/dimension_text.h"
#include "services/fabplanner/plan/end_cuts.h"
#include "services/fabplanner/planning/outline_limits.h"
#include "services/fabplanner/planning/saw_limits.h"

namespace mortise::fabplanner {
namespace {

constexpr double kFarthest = 1e4;  // m; what lies further away is a slip of the keyboard
constexpr double kFacets = 0.05;   // of a circle's area, which 12 chords or more may miss
constexpr std::array<const char*, 3> kDimensions = {"long", "wide", "thick"};

absl::Status CheckNumbers(const Part& part) {
  bool usable = part.size.allFinite() && part.size.minCoeff() > 0;
  if (IsShaped(part)) {
    usable = usable && part.vertices.allFinite() && part.triangles.minCoeff() >= 0 &&
             part.triangles.maxCoeff() < part.vertices.cols();
  } else {
    usable = usable && std::isfinite(part.from) && std::isfinite(part.to) && part.to > part.from &&
             part.outline.size() >= 3;
    for (const Eigen::Vector2d& point : part.outline) usable = usable && point.allFinite();
  }
  if (usable) {
    const Eigen::AlignedBox3d box = BoundsOf(part);
    usable = box.min().minCoeff() > -kFarthest && box.max().maxCoeff() < kFarthest;
  }
  if (usable) return absl::OkStatus();
  return InvalidField(absl::StrCat("part ", part.name), "has no usable size and outline");
}

absl::Status CheckSize(const Part& part, const Item& item, Making making) {
  for (int axis = 0; axis < 3; ++axis) {
    const SizeLimits& limits = item.limits[axis];
    if (limits.maximum == 0) continue;
    // What is too long or too wide is for those to say who know all stock sizes.
    const bool cut =
        axis == 0 ? making != Making::kBought : axis == 1 && making == Making::kOutline;
    const double size = part.size[axis];
    if (size >= limits.minimum - kSizeTolerance &&
        (cut || size <= limits.maximum + kSizeTolerance)) {
      continue;
    }
    const bool fixed = limits.minimum == limits.maximum;
    const std::vector<std::string> lengths =
        ComparedMillimetres({size, limits.minimum, limits.maximum});
    return PreconditionFailed(
        "PART_NOT_IN_STOCK",
        absl::StrCat("part ", part.name, " is ", lengths[0], " mm ", kDimensions[axis], ", but ",
                     item.name, fixed ? " is " : " can be ", lengths[1],
                     fixed ? "" : absl::StrCat(" to ", lengths[2]), " mm ", kDimensions[axis]),
        part.name);
  }
  return absl::OkStatus();
}

// Whether a crosscut of round stock gives the part. How thick a tube's wall is need not be known.
bool IsRoundCut(const Part& part, const Item& item) {
  if (!item.round || !IsPrismAlong(part, part.length_axis)) return false;
  if (!IsShaped(part) || item.kind == ItemKind::kBoard) return true;
  const double full = M_PI / 4 * part.size.prod();
  return std::abs(VolumeOf(part) - full) <= kFacets * full;
}

// Whether a crosscut of the stock is all that the part takes.
bool IsStockCut(const Part& part, const Item& item) {
  if (IsShaped(part) && item.shaped) return true;
  return IsBox(part) || IsRoundCut(part, item);
}

// What is left to do by hand, and why: "its end towards +x is …: saw it by hand after the drawing".
std::string ByHand(const std::vector<MachineLimit>& limits, const std::string& what_to_do) {
  std::vector<std::string> reasons;
  for (const MachineLimit& limit : limits) {
    reasons.push_back(absl::StrCat("its ", limit.place, " ", limit.reason));
  }
  return absl::StrCat(absl::StrJoin(reasons, "; "), ": ", what_to_do);
}

std::string ShapedFromBlank(const Part& part) {
  return absl::StrCat("shape it from the blank of ", SizeText(part.size), " after the drawing");
}

void PlanCrosscut(const Part& part, const Item& item, const WorkshopRules& rules,
                  PlannedPart* planned) {
  planned->making = Making::kCrosscut;
  if (IsStockCut(part, item)) return;
  const std::optional<CutEnds> ends = item.round ? std::nullopt : EndsOf(part);
  if (ends) planned->ends = SawnEnds(part, *ends, rules, &planned->beyond_machines);
  planned->to_shape = !ends || !planned->beyond_machines.empty();
  if (!ends) {
    planned->handwork = ShapedFromBlank(part);
  } else if (planned->to_shape) {
    planned->handwork =
        ByHand(planned->beyond_machines, "saw what is left by hand after the drawing");
  }
}

void PlanOutline(const Part& part, const WorkshopRules& rules, PlannedPart* planned) {
  planned->making = Making::kOutline;
  planned->to_shape = !IsUpright(part);
  if (planned->to_shape) {
    planned->handwork = ShapedFromBlank(part);
    return;
  }
  if (IsBox(part)) return;
  planned->beyond_machines = OutlineLimits(SheetOutlineOf(part), rules.jigsaw_radius);
  if (planned->beyond_machines.empty()) return;
  planned->handwork = ByHand(planned->beyond_machines, "cut out what is left by hand");
}

PlannedPart PlanPart(const Part& part, const Item& item, const WorkshopRules& rules) {
  PlannedPart planned{part.name, Making::kBought, part.size, "", false, {}};
  if (part.process == CutProcess::kChopSaw) PlanCrosscut(part, item, rules, &planned);
  if (part.process == CutProcess::kJigsaw) PlanOutline(part, rules, &planned);
  return planned;
}

}  // namespace

absl::StatusOr<std::vector<PlannedPart>> PlanParts(const Design& design, const Items& items,
                                                   const WorkshopRules& rules) {
  if (design.parts.empty()) return InvalidField("parts", "the design has no parts");
  std::vector<PlannedPart> planned;
  for (const Part& part : design.parts) {
    if (part.item.empty()) {
      MORTISE_RETURN_IF_ERROR(CheckNumbers(part));
      planned.push_back({part.name,
                         Making::kToDrawing,
                         BoundsOf(part).sizes(),
                         "make it to the drawing",
                         true,
                         {}});
      continue;
    }
    const auto item = items.find(part.item);
    if (item == items.end()) {
      return InvalidField(absl::StrCat("part ", part.name), absl::StrCat("no item ", part.item));
    }
    MORTISE_RETURN_IF_ERROR(CheckNumbers(part));
    planned.push_back(PlanPart(part, item->second, rules));
    MORTISE_RETURN_IF_ERROR(CheckSize(part, item->second, planned.back().making));
  }
  return planned;
}

}  // namespace mortise::fabplanner
