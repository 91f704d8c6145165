// Finds which tetrahedron a point lies in, of many points. Private to this folder.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::interpolator {

struct ElementPlace {
  int element = -1;                                       // -1 where none has the point
  Eigen::Vector4d barycentric = Eigen::Vector4d::Zero();  // not negative, of sum 1
};

// The elements sorted into the cells of a grid that their boxes touch: about one an element. For a
// few points without all this there is LocatePoints (common/fem/elements/point_location.h).
class ElementGrid {
 public:
  // Refers to both, which must stay as they are. Elements may be turned over or flat; no point is
  // found in flat ones.
  ElementGrid(const Eigen::Matrix3Xd& nodes, const Eigen::Matrix4Xi& tetrahedra);

  // Returns the element that the point is deepest in, the first of several. A point beyond all of
  // them by no more than rounding is in the nearest.
  ElementPlace Find(const Eigen::Vector3d& point) const;

 private:
  Eigen::Vector3i CellOf(const Eigen::Vector3d& point) const;
  std::size_t NumberOf(const Eigen::Vector3i& cell) const;
  template <typename Visit>
  void VisitCells(int element, const Visit& visit) const;

  const Eigen::Matrix3Xd& nodes_;
  const Eigen::Matrix4Xi& tetrahedra_;
  Eigen::Vector3d lowest_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d highest_ = Eigen::Vector3d::Zero();
  double cell_ = 1;  // m, its side
  Eigen::Vector3i cells_ = Eigen::Vector3i::Ones();
  std::vector<std::size_t> begin_;  // of each cell in `elements_`, and the end
  std::vector<int> elements_;
};

}  // namespace mortise::interpolator
