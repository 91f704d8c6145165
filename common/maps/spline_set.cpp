#include "common/maps/spline_set.h"

#include <algorithm>

namespace mortise::maps {
namespace {

// The refinement relation along one direction, for offsets -reach … reach of half a distance:
// (1/2, 1, 1/2) by (6.5) in halves, (1/8, 1/2, 6/8, 1/2, 1/8) by (6.12) in eighths.
constexpr std::int64_t kLinearParts[] = {1, 2, 1};
constexpr std::int64_t kCubicParts[] = {1, 4, 6, 4, 1};

}  // namespace

SplineSet::SplineSet(int dimension, Basis basis) : dimension_(dimension), reach_(ReachOf(basis)) {
  for (int d = 0; d < dimension; ++d) whole_weight_ *= reach_ == 1 ? 2 : 8;
  LatticeBox centres;
  LatticePoint step{};
  step.fill(kBoxEdge);
  for (int d = 0; d < dimension; ++d) {
    centres.low[d] = -(reach_ - 1) * kBoxEdge;
    centres.high[d] = reach_ * kBoxEdge;
  }
  ForEachGridPoint(dimension, centres, step,
                   [&](const LatticePoint& centre) { AddTo(0, centre, whole_weight_, centre); });
}

int SplineSet::Find(int level, const LatticePoint& centre) const {
  const auto found = index_.find({level, centre});
  return found == index_.end() ? -1 : found->second;
}

LatticeBox SplineSet::SupportOf(const BSpline& spline) const {
  LatticeBox support;
  for (int d = 0; d < dimension_; ++d) {
    support.low[d] = spline.centre[d] - reach_ * SpacingOf(spline.level);
    support.high[d] = spline.centre[d] + reach_ * SpacingOf(spline.level);
  }
  return support;
}

LatticeBox SplineSet::RefineOver(const LatticeBox& box, int level) {
  const std::int32_t spacing = SpacingOf(level);
  LatticeBox centres, region;
  LatticePoint step{};
  step.fill(spacing);
  for (int d = 0; d < dimension_; ++d) {
    centres.low[d] = box.low[d] - (reach_ - 1) * spacing;
    centres.high[d] = box.high[d] + (reach_ - 1) * spacing;
    region.low[d] = centres.low[d] - reach_ * spacing;
    region.high[d] = centres.high[d] + reach_ * spacing;
  }
  ForEachGridPoint(dimension_, centres, step, [&](const LatticePoint& centre) {
    const int number = Find(level, centre);
    if (number >= 0 && splines_[number].active) Refine(number);
  });
  return region;
}

void SplineSet::Refine(int number) {
  splines_[number].active = false;
  --active_count_;
  const BSpline parent = splines_[number];
  const std::int32_t half = SpacingOf(parent.level + 1);
  const std::int64_t* parts = reach_ == 1 ? kLinearParts : kCubicParts;
  LatticeBox children;
  LatticePoint step{};
  step.fill(half);
  for (int d = 0; d < dimension_; ++d) {
    // What does not overlap the box is left out.
    children.low[d] = std::max(parent.centre[d] - reach_ * half, -(reach_ - 1) * half);
    children.high[d] = std::min(parent.centre[d] + reach_ * half, kBoxEdge + (reach_ - 1) * half);
  }
  ForEachGridPoint(dimension_, children, step, [&](const LatticePoint& centre) {
    std::int64_t part = 1;
    for (int d = 0; d < dimension_; ++d) {
      part *= parts[(centre[d] - parent.centre[d]) / half + reach_];
    }
    AddTo(parent.level + 1, centre, part, parent.centre);
  });
}

void SplineSet::AddTo(int level, const LatticePoint& centre, std::int64_t part,
                      const LatticePoint& parent) {
  const auto [entry, added] = index_.try_emplace({level, centre}, count());
  if (added) {
    BSpline spline;
    spline.level = level;
    spline.centre = centre;
    splines_.push_back(spline);
    ++active_count_;
  }
  BSpline& spline = splines_[entry->second];
  spline.weight += part;
  for (int d = 0; d < dimension_; ++d) spline.moment[d] += part * parent[d];
}

}  // namespace mortise::maps
