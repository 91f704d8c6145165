#include "common/cad/stretch_map.h"

#include <algorithm>
#include <cmath>

namespace mortise::cad {
namespace {

constexpr double kSameSlope = 1e-9;  // relative
constexpr double kRounding = 1e-6;   // of the box, that faces may reach beyond a level

}  // namespace

StretchMap::StretchMap(const Eigen::Vector3d& drawn_size, const mesh::BoxStretch& stretch)
    : whole_{stretch.size.cwiseQuotient(drawn_size), Eigen::Vector3d::Zero()} {
  for (int axis = 0; axis < 3; ++axis) {
    if (stretch.IsInProportion(axis)) continue;
    std::vector<Knot>& knots = knots_[static_cast<std::size_t>(axis)];
    for (const mesh::LevelPlace& end : stretch.Ends(axis)) {
      knots.push_back(
          {(end.fraction + 0.5) * drawn_size[axis], end.place + stretch.size[axis] / 2});
    }
    const auto slope = [](const Knot& a, const Knot& b) {
      return (b.place - a.place) / (b.drawn - a.drawn);
    };
    for (std::size_t i = 1; i + 1 < knots.size();) {
      const double before = slope(knots[i - 1], knots[i]), after = slope(knots[i], knots[i + 1]);
      if (std::abs(before - after) <= kSameSlope * std::max(before, after)) {
        knots.erase(knots.begin() + static_cast<std::ptrdiff_t>(i));
      } else {
        ++i;
      }
    }
    if (knots.size() == 2) knots.clear();
  }
}

bool StretchMap::IsInProportion() const {
  return std::all_of(knots_.begin(), knots_.end(), [](const auto& knots) { return knots.empty(); });
}

double StretchMap::MostFactor() const {
  double most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<Knot>& knots = Knots(axis);
    if (knots.empty()) most = std::max(most, whole_.factors[axis]);
    for (std::size_t i = 1; i < knots.size(); ++i) {
      most = std::max(
          most, (knots[i].place - knots[i - 1].place) / (knots[i].drawn - knots[i - 1].drawn));
    }
  }
  return most;
}

std::size_t StretchMap::PieceOf(int axis, double drawn) const {
  const std::vector<Knot>& knots = Knots(axis);
  std::size_t piece = 0;
  while (piece + 2 < knots.size() && knots[piece + 1].drawn < drawn) ++piece;
  return piece;
}

double StretchMap::At(int axis, double drawn) const {
  const std::vector<Knot>& knots = Knots(axis);
  if (knots.empty()) return whole_.factors[axis] * drawn;
  const std::size_t piece = PieceOf(axis, drawn);
  const Knot& low = knots[piece];
  const Knot& high = knots[piece + 1];
  return low.place + (drawn - low.drawn) * (high.place - low.place) / (high.drawn - low.drawn);
}

bool StretchMap::IsIn(int axis, std::size_t piece, double low, double high) const {
  const std::vector<Knot>& knots = Knots(axis);
  const double beyond = kRounding * (knots.back().drawn - knots.front().drawn);
  return (piece == 0 || low >= knots[piece].drawn - beyond) &&
         (piece + 2 == knots.size() || high <= knots[piece + 1].drawn + beyond);
}

bool StretchMap::IsAcross(int axis, double low, double high) const {
  return !Knots(axis).empty() && !IsIn(axis, PieceOf(axis, (low + high) / 2), low, high);
}

AffineStretch StretchMap::Of(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const {
  AffineStretch map = whole_;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<Knot>& knots = Knots(axis);
    if (knots.empty()) continue;
    const std::size_t piece = PieceOf(axis, (low[axis] + high[axis]) / 2);
    Knot from = knots[piece], to = knots[piece + 1];
    if (!IsIn(axis, piece, low[axis], high[axis])) {
      from = {low[axis], At(axis, low[axis])};
      to = {high[axis], At(axis, high[axis])};
    }
    map.factors[axis] = (to.place - from.place) / (to.drawn - from.drawn);
    map.offsets[axis] = from.place - map.factors[axis] * from.drawn;
  }
  return map;
}

}  // namespace mortise::cad
