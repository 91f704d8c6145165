#include "common/mesh/shapes/box_stretch.h"

#include <algorithm>
#include <iterator>

namespace mortise::mesh {

bool BoxStretch::IsInProportion() const {
  return IsInProportion(0) && IsInProportion(1) && IsInProportion(2);
}

std::vector<LevelPlace> BoxStretch::Ends(int axis) const {
  const std::vector<LevelPlace>& between = levels[static_cast<std::size_t>(axis)];
  std::vector<LevelPlace> ends;
  ends.reserve(between.size() + 2);
  ends.push_back({-0.5, -size[axis] / 2});
  ends.insert(ends.end(), between.begin(), between.end());
  ends.push_back({0.5, size[axis] / 2});
  return ends;
}

std::pair<LevelPlace, LevelPlace> BoxStretch::Around(int axis, double fraction) const {
  const std::vector<LevelPlace>& between = levels[static_cast<std::size_t>(axis)];
  const auto high = std::lower_bound(
      between.begin(), between.end(), fraction,
      [](const LevelPlace& level, double sought) { return level.fraction < sought; });
  return {high == between.begin() ? LevelPlace{-0.5, -size[axis] / 2} : *std::prev(high),
          high == between.end() ? LevelPlace{0.5, size[axis] / 2} : *high};
}

double BoxStretch::PlaceOf(int axis, double fraction) const {
  if (IsInProportion(axis)) return fraction * size[axis];
  const auto [below, above] = Around(axis, fraction);
  const double share = (fraction - below.fraction) / (above.fraction - below.fraction);
  return below.place + share * (above.place - below.place);
}

double BoxStretch::SlopeAt(int axis, double fraction) const {
  const auto [below, above] = Around(axis, fraction);
  return (above.place - below.place) / (above.fraction - below.fraction);
}

BoxStretch BoxStretch::Turned(const Eigen::Matrix3d& turn) const {
  BoxStretch turned(turn.cwiseAbs() * size);
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Index becomes = 0;
    turn.col(axis).cwiseAbs().maxCoeff(&becomes);
    std::vector<LevelPlace>& to = turned.levels[static_cast<std::size_t>(becomes)];
    to = levels[static_cast<std::size_t>(axis)];
    if (turn(becomes, axis) > 0) continue;
    for (LevelPlace& level : to) level = {-level.fraction, -level.place};
    std::reverse(to.begin(), to.end());
  }
  return turned;
}

}  // namespace mortise::mesh
