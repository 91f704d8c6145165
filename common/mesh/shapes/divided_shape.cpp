#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "common/mesh/shapes/missed_volume.h"
#include "common/mesh/shapes/shape_levels.h"

namespace mortise::mesh {
namespace {

// Cuts the triangles of a shape, level by level.
class ShapeCutter {
 public:
  explicit ShapeCutter(const DrawnShape& shape) : size_(shape.size) {
    for (const auto vertex : shape.fractions.colwise()) vertices_.emplace_back(vertex);
    for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
      triangles_.push_back({{shape.triangles(0, t), shape.triangles(1, t), shape.triangles(2, t)},
                            shape.triangle_face(t)});
    }
  }

  void CutAt(const ShapeLevel& level) {
    level_ = level;
    same_ = kOnPlane / size_[level.axis];
    cuts_.clear();
    const std::size_t count = triangles_.size();  // what is cut off needs no second look
    for (std::size_t t = 0; t < count; ++t) CutTriangle(t);
  }

  void PutInto(DrawnShape& shape) const {
    shape.fractions.resize(3, static_cast<Eigen::Index>(vertices_.size()));
    for (std::size_t k = 0; k < vertices_.size(); ++k) {
      shape.fractions.col(static_cast<Eigen::Index>(k)) = vertices_[k];
    }
    const auto count = static_cast<Eigen::Index>(triangles_.size());
    shape.triangles.resize(3, count);
    shape.triangle_face.resize(count);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const auto [corners, face] = triangles_[t];
      shape.triangles.col(static_cast<Eigen::Index>(t)) << corners[0], corners[1], corners[2];
      shape.triangle_face(static_cast<Eigen::Index>(t)) = face;
    }
  }

 private:
  struct Triangle {
    std::array<int, 3> corners = {};
    int face = 0;
  };

  const Eigen::Vector3d& At(int vertex) const {
    return vertices_[static_cast<std::size_t>(vertex)];
  }

  // -1, 0 or 1: a vertex below, level with or above the level.
  int Side(int vertex) const {
    const double above = At(vertex)[level_.axis] - level_.fraction;
    return std::abs(above) <= same_ ? 0 : above > 0 ? 1 : -1;
  }

  // Where an edge from one side to the other meets the level: the same for both its triangles.
  int CutOf(int from, int to) {
    const auto [low, high] = std::minmax(from, to);
    const auto [found, is_new] =
        cuts_.emplace(std::pair(low, high), static_cast<int>(vertices_.size()));
    if (is_new) {
      const Eigen::Vector3d start = At(low), along = At(high) - start;
      Eigen::Vector3d cut =
          start + (level_.fraction - start[level_.axis]) / along[level_.axis] * along;
      cut[level_.axis] = level_.fraction;
      vertices_.push_back(cut);
    }
    return found->second;
  }

  double LengthOf(int from, int to) const {
    return size_.cwiseProduct(At(to) - At(from)).squaredNorm();
  }

  void CutTriangle(std::size_t t) {
    const auto [corners, face] = triangles_[t];
    const std::array<int, 3> sides = {Side(corners[0]), Side(corners[1]), Side(corners[2])};
    if (*std::min_element(sides.begin(), sides.end()) >= 0 ||
        *std::max_element(sides.begin(), sides.end()) <= 0) {
      return;
    }
    // One corner is alone on its side, or lies on the level between the two others.
    const int sum = sides[0] + sides[1] + sides[2];
    std::size_t first = 0;
    while (sum == 0 ? sides[first] != 0 : sides[first] != -sum) ++first;
    const int a = corners[first], b = corners[(first + 1) % 3], c = corners[(first + 2) % 3];
    if (sum == 0) {
      const int on_side = CutOf(b, c);
      triangles_[t].corners = {a, b, on_side};
      triangles_.push_back({{a, on_side, c}, face});
      return;
    }
    const int on_first = CutOf(a, b), on_last = CutOf(c, a);
    triangles_[t].corners = {a, on_first, on_last};
    // The shorter diagonal leaves the less slender triangles.
    if (LengthOf(b, on_last) <= LengthOf(on_first, c)) {
      triangles_.push_back({{on_first, b, on_last}, face});
      triangles_.push_back({{b, c, on_last}, face});
    } else {
      triangles_.push_back({{on_first, b, c}, face});
      triangles_.push_back({{on_first, c, on_last}, face});
    }
  }

  const Eigen::Vector3d size_;
  std::vector<Eigen::Vector3d> vertices_;  // as fractions
  std::vector<Triangle> triangles_;
  ShapeLevel level_;
  double same_ = 0;                          // as a fraction
  std::map<std::pair<int, int>, int> cuts_;  // of edges, at the level
};

}  // namespace

DrawnShape DividedAt(const DrawnShape& shape, const std::vector<ShapeLevel>& levels) {
  if (levels.empty()) return shape;
  ShapeCutter cutter(shape);
  for (const ShapeLevel& level : levels) cutter.CutAt(level);
  DrawnShape divided = shape;
  cutter.PutInto(divided);
  divided.missed_volumes = MissedVolumes(divided);
  return divided;
}

}  // namespace mortise::mesh
