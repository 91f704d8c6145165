#include "services/retrieval/descriptors/light_field_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace mortise::retrieval {
namespace {

using std::numbers::phi;

struct Orbit {
  Eigen::Vector3d direction;  // of the first view
  int views = 4;              // 2 where half a turn leads to the opposite vertex
  double weight = 1;
};

std::vector<Orbit> Orbits() {
  return {{{1, 1, 1}, 4, std::sqrt(0.1)},
          {{0, 1 / phi, phi}, 4, std::sqrt(0.05)},
          {{phi, 0, 1 / phi}, 4, std::sqrt(0.05)},
          {{1 / phi, phi, 0}, 2, std::sqrt(0.05)},
          {{-1 / phi, phi, 0}, 2, std::sqrt(0.05)}};
}

// How far, as a sine, the axes of space are from being seen parallel to the rows of the picture
// turned by an angle.
double LeastSlope(const View& view, double angle) {
  const Eigen::Vector3d across = std::cos(angle) * view.up + std::sin(angle) * view.right;
  double least = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double length = std::hypot(view.right[axis], view.up[axis]);
    least = std::min(least, std::abs(across[axis]) / length);
  }
  return least;
}

View FirstView(const Orbit& orbit) {
  constexpr int kAngles = 180;
  View view;
  view.right = Eigen::Vector3d::UnitZ().cross(orbit.direction).normalized();
  view.up = orbit.direction.cross(view.right).normalized();
  view.weight = orbit.weight;
  for (int step = 0; step < kAngles; ++step) {
    const double angle = std::numbers::pi * step / kAngles;
    if (LeastSlope(view, angle) > LeastSlope(view, view.slant)) view.slant = angle;
  }
  return view;
}

Eigen::Vector3d QuarterTurn(const Eigen::Vector3d& vector) {
  return {-vector.y(), vector.x(), vector.z()};
}

}  // namespace

std::vector<View> LightFieldViews() {
  std::vector<View> views;
  for (const Orbit& orbit : Orbits()) {
    View view = FirstView(orbit);
    for (int turn = 0; turn < orbit.views; ++turn) {
      views.push_back(view);
      view.right = QuarterTurn(view.right);
      view.up = QuarterTurn(view.up);
    }
  }
  return views;
}

std::vector<EarlierView> ViewsBeforeQuarterTurn() {
  std::vector<EarlierView> earlier;
  for (const Orbit& orbit : Orbits()) {
    const int first = static_cast<int>(earlier.size());
    for (int turn = 0; turn < orbit.views; ++turn) {
      const bool opposite = orbit.views == 2 && turn == 0;
      earlier.push_back({first + (turn + orbit.views - 1) % orbit.views, opposite});
    }
  }
  return earlier;
}

}  // namespace mortise::retrieval
