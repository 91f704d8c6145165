// Finds the nearest point of a surface. Private to this folder.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "services/interpolator/mapping/disk_map.h"

namespace mortise::interpolator {

// A point of a surface.
struct SurfacePoint {
  TrianglePlace place;
  double distance = 0;  // m, from the point asked for
};

// Triangles that are asked again and again: an axis-aligned bounding box tree (CGAL). Those without
// area are left out, as their neighbours have their points. Many threads may ask at once.
class NearestSurface {
 public:
  // At least one triangle has an area. Otherwise Find returns the first triangle's first corner.
  NearestSurface(const Eigen::Matrix3Xd& nodes, const Eigen::Matrix3Xi& triangles);
  ~NearestSurface();

  SurfacePoint Find(const Eigen::Vector3d& point) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace mortise::interpolator
