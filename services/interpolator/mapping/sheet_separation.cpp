#include "services/interpolator/mapping/sheet_separation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace mortise::interpolator {
namespace {

// A side of a triangle, by the lower and higher of its ends.
struct Side {
  int low = -1, high = -1;
  int corner = -1;  // three times its triangle, and which of its corners it leaves
  bool is_forward = false;
  double angle = 0;  // around the edge, of an edge of many triangles
};

std::vector<Side> SortedSides(const Eigen::Matrix3Xi& triangles) {
  std::vector<Side> sides;
  sides.reserve(static_cast<std::size_t>(triangles.size()));
  for (int t = 0; t < static_cast<int>(triangles.cols()); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = triangles(k, t), to = triangles((k + 1) % 3, t);
      sides.push_back({std::min(from, to), std::max(from, to), 3 * t + k, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });
  return sides;
}

// Corners of triangles that are one vertex of a sheet.
class Corners {
 public:
  explicit Corners(int count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  int Find(int corner) {
    int& parent = parent_[static_cast<std::size_t>(corner)];
    return parent == corner ? corner : parent = Find(parent);
  }

  // Joins the ends of two sides that run along an edge in opposite directions.
  void Join(const Side& a, const Side& b) {
    JoinCorners(a.corner, Next(b.corner));
    JoinCorners(Next(a.corner), b.corner);
  }

 private:
  static int Next(int corner) { return corner / 3 * 3 + (corner + 1) % 3; }

  void JoinCorners(int a, int b) {
    const int first = Find(a), second = Find(b);
    parent_[static_cast<std::size_t>(std::max(first, second))] = std::min(first, second);
  }

  std::vector<int> parent_;
};

// Joins the sides of one edge in pairs with the solid between them.
void JoinAround(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                std::vector<Side> sides, Corners& corners) {
  const Eigen::Vector3d start = vertices.col(sides.front().low);
  const Eigen::Vector3d axis = (vertices.col(sides.front().high) - start).normalized();
  const Eigen::Vector3d first = axis.unitOrthogonal(), second = axis.cross(first);
  for (Side& side : sides) {
    const Eigen::Vector3d off =
        vertices.col(triangles((side.corner + 2) % 3, side.corner / 3)) - start;
    side.angle = std::atan2(off.dot(second), off.dot(first));
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.angle, a.is_forward, a.corner) < std::tie(b.angle, b.is_forward, b.corner);
  });
  // Seen along the edge, a triangle that runs along it has the solid before it, clockwise: up to
  // the last one before that runs against it.
  const std::size_t count = sides.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Side& before = sides[(i + count - 1) % count];
    if (sides[i].is_forward && !before.is_forward) corners.Join(sides[i], before);
  }
}

}  // namespace

std::vector<int> SeparateSheets(const Eigen::Matrix3Xd& vertices, Eigen::Matrix3Xi& triangles) {
  const std::vector<Side> sides = SortedSides(triangles);
  Corners corners(static_cast<int>(triangles.size()));
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(first, sides.end(), [&](const Side& side) {
      return side.low != first->low || side.high != first->high;
    });
    const bool is_plain = last - first == 2 && first->is_forward != (first + 1)->is_forward;
    if (is_plain) corners.Join(*first, *(first + 1));
    if (last - first > 2) JoinAround(vertices, triangles, {first, last}, corners);
    first = last;
  }
  std::vector<int> owner(static_cast<std::size_t>(vertices.cols()), -1);  // the first sheet
  std::map<int, int> copy_of;                                             // of other sheets
  std::vector<int> copies;
  for (int corner = 0; corner < static_cast<int>(triangles.size()); ++corner) {
    int& vertex = triangles(corner % 3, corner / 3);
    const int sheet = corners.Find(corner);
    int& first = owner[static_cast<std::size_t>(vertex)];
    if (first < 0) first = sheet;
    if (first == sheet) continue;
    const auto [entry, is_new] = copy_of.try_emplace(
        sheet, static_cast<int>(vertices.cols()) + static_cast<int>(copies.size()));
    if (is_new) copies.push_back(vertex);
    vertex = entry->second;
  }
  return copies;
}

}  // namespace mortise::interpolator
