// Points of a surface with their normals, of which the one is found that is nearest to a place and
// faces the same way.
#pragma once

#include <Eigen/Core>
#include <memory>

namespace mortise::retrieval {

// Nearest by |x - y|² + (normal_length · |m - n|)², the distance of six dimensions: the two faces
// of a thin board stay apart, as one that faces the other way is 2 normal_length further.
// Immutable, and safe to ask from several threads. Built in O(n log n), asked in O(log n) or so: a
// kd-tree of CGAL's.
class OrientedPoints {
 public:
  // `points` and unit `normals`, 3 × n each, n ≥ 1, finite; `normal_length` ≥ 0, m.
  OrientedPoints(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& normals,
                 double normal_length);
  ~OrientedPoints();
  OrientedPoints(OrientedPoints&&) noexcept;
  OrientedPoints& operator=(OrientedPoints&&) noexcept;

  struct Nearest {
    Eigen::Index index = 0;
    double squared = 0;  // of the distance above, m²
  };
  Nearest Find(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

  // Returns the nearer of those for the normal and for its opposite: for what may face either way.
  Nearest FindEitherWay(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
  double normal_length_;
};

}  // namespace mortise::retrieval
