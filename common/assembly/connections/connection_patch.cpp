#include "common/assembly/connections/connection_patch.h"

#include <algorithm>
#include <array>

#include "common/assembly/model/pattern.h"

namespace mortise::parametric {
namespace {

// Where two boxes meet along each axis: what they share, or the gap if they share nothing.
BoundingBox Between(const BoundingBox& a, const BoundingBox& b) {
  const Eigen::Vector3d low = a.minimum.cwiseMax(b.minimum);
  const Eigen::Vector3d high = a.maximum.cwiseMin(b.maximum);
  return {low.cwiseMin(high), low.cwiseMax(high)};
}

double AreaAlong(const BoundingBox& piece, int normal) {
  const Eigen::Vector3d size = piece.size();
  return size[(normal + 1) % 3] * size[(normal + 2) % 3];
}

int ThinnestAxis(const BoundingBox& piece) {
  int normal = 0;
  piece.size().minCoeff(&normal);
  return normal;
}

bool MeetOverAnArea(const BoundingBox& a, const BoundingBox& b, double tolerance, double least) {
  Eigen::Vector3d shared = a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum);
  std::sort(shared.begin(), shared.end());
  return shared[0] >= -tolerance && shared[1] > least;
}

}  // namespace

const char* PatchKindName(PatchKind kind) {
  switch (kind) {
    case PatchKind::kContact:
      return "contact";
    case PatchKind::kGap:
      return "gap";
    case PatchKind::kWhole:
      return "whole";
  }
  return "";
}

std::vector<BoundingBox> PartsIn(const Element& element, const BoundingBox& box) {
  if (!element.pattern) return {box};
  const PatternLayout layout = LayOut(*element.pattern, box);
  std::vector<BoundingBox> parts;
  parts.reserve(static_cast<std::size_t>(layout.part_count()));
  for (int i = 0; i < layout.part_count(); ++i) {
    const Eigen::Vector3d center = layout.CenterOf(i);
    parts.push_back({center - layout.part_size / 2, center + layout.part_size / 2});
  }
  return parts;
}

ConnectionPatch FindPatch(const Element& first, const BoundingBox& first_box, const Element& second,
                          const BoundingBox& second_box, double tolerance, double least) {
  ConnectionPatch patch;
  std::array<double, 3> areas = {0, 0, 0};
  const std::vector<BoundingBox> second_parts = PartsIn(second, second_box);
  for (const BoundingBox& a : PartsIn(first, first_box)) {
    for (const BoundingBox& b : second_parts) {
      if (!MeetOverAnArea(a, b, tolerance, least)) continue;
      const BoundingBox piece = Between(a, b);
      const int normal = ThinnestAxis(piece);
      areas[static_cast<std::size_t>(normal)] += AreaAlong(piece, normal);
      if (patch.pieces.empty()) patch.region = piece;
      patch.region.minimum = patch.region.minimum.cwiseMin(piece.minimum);
      patch.region.maximum = patch.region.maximum.cwiseMax(piece.maximum);
      patch.pieces.push_back(piece);
    }
  }
  if (patch.pieces.empty()) return GapBetween(first_box, second_box);
  const auto largest = std::max_element(areas.begin(), areas.end());
  patch.normal = static_cast<Axis>(largest - areas.begin());
  for (const double area : areas) patch.area += area;
  return patch;
}

ConnectionPatch GapBetween(const BoundingBox& first, const BoundingBox& second) {
  ConnectionPatch patch;
  patch.kind = PatchKind::kGap;
  patch.region = Between(first, second);
  patch.normal = static_cast<Axis>(ThinnestAxis(patch.region));
  return patch;
}

ConnectionPatch WholeOf(const BoundingBox& box) {
  ConnectionPatch patch;
  patch.kind = PatchKind::kWhole;
  patch.region = box;
  patch.normal = static_cast<Axis>(ThinnestAxis(box));
  return patch;
}

}  // namespace mortise::parametric
