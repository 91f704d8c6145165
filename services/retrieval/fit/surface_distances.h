// How far points lie from a surface.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "common/mesh/surface_mesh.h"

namespace mortise::retrieval {

// Exact distances from triangles, whichever way they face, by CGAL's tree of boxes. Immutable.
class SurfaceDistances {
 public:
  // The surface has a triangle, indices in range and finite vertices.
  explicit SurfaceDistances(const mesh::SurfaceMesh& surface);
  ~SurfaceDistances();

  // Returns the distance of each point, 3 × n, m.
  Eigen::VectorXd From(const Eigen::Matrix3Xd& points) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

// What is told of many distances.
struct DistanceSummary {
  double root_mean_square = 0;  // m
  double percentile_95 = 0;     // m: 95 of 100 points are no further
};

// Returns 0 for both of no distances.
DistanceSummary Summarize(Eigen::VectorXd distances);

}  // namespace mortise::retrieval
