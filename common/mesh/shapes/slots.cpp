#include "common/mesh/shapes/slots.h"

#include <cmath>
#include <cstddef>
#include <optional>

namespace mortise::mesh {
namespace {

constexpr double kSame = 1e-7;  // m

// Whether a face is the half of a bore that reaches furthest at the lower or upper end of `along`.
bool IsHalf(const RoundFace& face, int along, bool upper) {
  if (!face.is_hollow || face.is_whole || face.axis == along) return false;
  const auto& ends = face.reaches[static_cast<std::size_t>(along)];
  const auto& sides = face.reaches[static_cast<std::size_t>(3 - face.axis - along)];
  return ends[upper ? 1 : 0] && !ends[upper ? 0 : 1] && sides[0] && sides[1];
}

// How far the second lies beyond the first along an axis, if they are halves of one slot.
std::optional<double> ApartInSlot(const RoundFace& lower, const RoundFace& upper, int along) {
  if (lower.axis != upper.axis || !IsHalf(lower, along, false) || !IsHalf(upper, along, true)) {
    return std::nullopt;
  }
  Eigen::Vector3d apart = upper.middle - lower.middle;
  const double distance = apart[along];
  apart[along] = 0;
  const bool is_alike = std::abs(upper.radius - lower.radius) <= kSame &&
                        std::abs(upper.length - lower.length) <= kSame &&
                        apart.cwiseAbs().maxCoeff() <= kSame;
  if (!is_alike || distance <= kSame) return std::nullopt;
  return distance;
}

Slot Between(const RoundFace& lower, const RoundFace& upper, int along) {
  Slot slot;
  slot.axis = lower.axis;
  slot.along = along;
  slot.middle = (lower.middle + upper.middle) / 2;
  slot.size.setConstant(2 * lower.radius);
  slot.size[slot.axis] = lower.length;
  slot.size[along] += upper.middle[along] - lower.middle[along];
  return slot;
}

}  // namespace

std::vector<Slot> SlotsOf(const std::vector<RoundFace>& faces) {
  std::vector<Slot> slots;
  for (const RoundFace& lower : faces) {
    for (int along = 0; along < 3; ++along) {
      const RoundFace* nearest = nullptr;
      double least = 0;
      for (const RoundFace& upper : faces) {
        const std::optional<double> distance = ApartInSlot(lower, upper, along);
        if (!distance || (nearest != nullptr && *distance >= least)) continue;
        nearest = &upper;
        least = *distance;
      }
      if (nearest != nullptr) slots.push_back(Between(lower, *nearest, along));
    }
  }
  return slots;
}

}  // namespace mortise::mesh
