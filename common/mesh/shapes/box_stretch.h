// Says how a drawn shape fills a box of another size: along each axis in proportion, or in pieces
// between levels that are put somewhere else, so that a bore keeps its size in a board that grows.
#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

namespace mortise::mesh {

// The place to which a level of the drawn shape is put.
struct LevelPlace {
  double fraction = 0;  // of the drawn box's size, from its middle; between -1/2 and 1/2
  double place = 0;     // m, from the middle of the box it is stretched into, within that box
};

// A map that is linear between the levels of each axis and the faces of the box, and increases.
struct BoxStretch {
  Eigen::Vector3d size = Eigen::Vector3d::Ones();  // m, of the box it is stretched into
  std::array<std::vector<LevelPlace>, 3> levels;   // of each axis, both numbers increasing

  BoxStretch() = default;
  // Stretches in proportion into a box of this size, m.
  template <typename Derived>
  BoxStretch(const Eigen::MatrixBase<Derived>& box_size) : size(box_size) {}

  bool IsInProportion(int axis) const { return levels[static_cast<std::size_t>(axis)].empty(); }
  bool IsInProportion() const;

  // Returns the levels of the axis with the faces of the box before and behind them.
  std::vector<LevelPlace> Ends(int axis) const;

  // Returns where a point at this fraction of the drawn box lies, m from the middle of the box.
  // O(log levels).
  double PlaceOf(int axis, double fraction) const;

  // Returns by how much places grow with the fraction there, m; at a level, below it. O(log
  // levels).
  double SlopeAt(int axis, double fraction) const;

  // Returns the stretch of the shape turned by `turn`, whose entries are 0, 1 and -1
  // (DrawnShape::turn).
  BoxStretch Turned(const Eigen::Matrix3d& turn) const;

 private:
  // Returns the levels, or faces of the box, below and above what lies at this fraction.
  std::pair<LevelPlace, LevelPlace> Around(int axis, double fraction) const;
};

}  // namespace mortise::mesh
