#include "tests/unit/common/mesh/box_assembly.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "common/mesh/surface_check.h"

namespace mortise::mesh {
namespace {

// All planes of all boxes form a grid; cells belong to boxes; walls lie between cells of different
// owners.
class BoxGrid {
 public:
  explicit BoxGrid(const std::vector<TestBox>& boxes) : boxes_(boxes) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const TestBox& box : boxes) {
        planes_[axis].push_back(box.low[axis]);
        planes_[axis].push_back(box.high[axis]);
      }
      std::sort(planes_[axis].begin(), planes_[axis].end());
      const auto same = [](double a, double b) { return std::abs(a - b) < 1e-9; };
      planes_[axis].erase(std::unique(planes_[axis].begin(), planes_[axis].end(), same),
                          planes_[axis].end());
    }
  }

  AssemblySurface Build() {
    for (int axis = 0; axis < 3; ++axis) AddWalls(axis);
    AssemblySurface surface;
    surface.vertices.resize(3, vertices_.size());
    for (std::size_t v = 0; v < vertices_.size(); ++v) surface.vertices.col(v) = vertices_[v];
    surface.triangles.resize(3, triangles_.size());
    surface.triangle_face.resize(triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      surface.triangles.col(t) = triangles_[t];
      surface.triangle_face[t] = owners_[t];
    }
    surface.faces = faces_;
    surface.part_interior.resize(3, boxes_.size());
    for (std::size_t p = 0; p < boxes_.size(); ++p) {
      surface.part_interior.col(p) = 0.5 * (boxes_[p].low + boxes_[p].high);
      surface.part_names.push_back(boxes_[p].name);
    }
    return surface;
  }

 private:
  int Owner(const Eigen::Vector3i& cell) const {
    Eigen::Vector3d centre;
    for (int axis = 0; axis < 3; ++axis) {
      if (cell[axis] < 0 || cell[axis] + 1 >= static_cast<int>(planes_[axis].size())) return -1;
      centre[axis] = 0.5 * (planes_[axis][cell[axis]] + planes_[axis][cell[axis] + 1]);
    }
    for (int p = 0; p < static_cast<int>(boxes_.size()); ++p) {
      if ((centre.array() > boxes_[p].low.array()).all() &&
          (centre.array() < boxes_[p].high.array()).all()) {
        return p;
      }
    }
    return -1;
  }

  int Vertex(const Eigen::Vector3i& node) {
    const auto [found, added] =
        vertex_.try_emplace({node[0], node[1], node[2]}, static_cast<int>(vertices_.size()));
    if (added) {
      vertices_.emplace_back(planes_[0][node[0]], planes_[1][node[1]], planes_[2][node[2]]);
    }
    return found->second;
  }

  int Face(int axis, int plane, int front, int back) {
    static constexpr std::array<const char*, 3> kLow{"x_min", "y_min", "z_min"};
    static constexpr std::array<const char*, 3> kHigh{"x_max", "y_max", "z_max"};
    const auto [found, added] =
        face_.try_emplace({axis, plane, front, back}, static_cast<int>(faces_.size()));
    if (added) {
      AssemblyFace face{front, back, {}};
      if (back >= 0) face.origins.push_back({back, kHigh[axis]});
      if (front >= 0) face.origins.push_back({front, kLow[axis]});
      faces_.push_back(face);
    }
    return found->second;
  }

  void AddWalls(int axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int i = 0; i < static_cast<int>(planes_[axis].size()); ++i) {
      for (int j = 0; j + 1 < static_cast<int>(planes_[u].size()); ++j) {
        for (int k = 0; k + 1 < static_cast<int>(planes_[v].size()); ++k) {
          Eigen::Vector3i before, after;
          before[axis] = i - 1;
          after[axis] = i;
          before[u] = after[u] = j;
          before[v] = after[v] = k;
          const int back = Owner(before), front = Owner(after);
          if (back == front) continue;
          const int face = Face(axis, i, front, back);
          std::array<int, 4> corner{};
          const std::array<std::array<int, 2>, 4> steps{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
          for (int c = 0; c < 4; ++c) {
            Eigen::Vector3i node;
            node[axis] = i;
            node[u] = j + steps[c][0];
            node[v] = k + steps[c][1];
            corner[c] = Vertex(node);
          }
          triangles_.emplace_back(corner[0], corner[1], corner[2]);
          triangles_.emplace_back(corner[0], corner[2], corner[3]);
          owners_.insert(owners_.end(), 2, face);
        }
      }
    }
  }

  const std::vector<TestBox>& boxes_;
  std::array<std::vector<double>, 3> planes_;
  std::map<std::tuple<int, int, int>, int> vertex_;
  std::map<std::tuple<int, int, int, int>, int> face_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Eigen::Vector3i> triangles_;
  std::vector<int> owners_;
  std::vector<AssemblyFace> faces_;
};

}  // namespace

AssemblySurface AssembleBoxes(const std::vector<TestBox>& boxes) { return BoxGrid(boxes).Build(); }

AssemblySurface TestTable(double length, double width, double height, double leg,
                          double apron_height, double top) {
  const double inset = 0.05, under = height - top, board = 0.022;
  std::vector<TestBox> boxes{{"top", {0, 0, under}, {length, width, height}}};
  const double x0 = inset, x1 = length - inset - leg, y0 = inset, y1 = width - inset - leg;
  int index = 0;
  for (const double x : {x0, x1}) {
    for (const double y : {y0, y1}) {
      boxes.push_back({"leg" + std::to_string(index++), {x, y, 0}, {x + leg, y + leg, under}});
    }
  }
  const double z = under - apron_height, off = 0.5 * (leg - board);
  boxes.push_back({"apron0", {x0 + leg, y0 + off, z}, {x1, y0 + off + board, under}});
  boxes.push_back({"apron1", {x0 + leg, y1 + off, z}, {x1, y1 + off + board, under}});
  boxes.push_back({"apron2", {x0 + off, y0 + leg, z}, {x0 + off + board, y1, under}});
  boxes.push_back({"apron3", {x1 + off, y0 + leg, z}, {x1 + off + board, y1, under}});
  return AssembleBoxes(boxes);
}

SurfaceMesh BoxSurface(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return PartSurface(AssembleBoxes({{"box", low, high}}), 0);
}

}  // namespace mortise::mesh
