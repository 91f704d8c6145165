// Several surfaces as one.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// A surface that somebody else keeps.
struct SurfaceView {
  const Eigen::Matrix3Xd* vertices = nullptr;
  const Eigen::Matrix3Xi* triangles = nullptr;
};

// Returns the view of whatever has `vertices` and `triangles`, which must outlive it.
template <typename Surface>
SurfaceView ViewOf(const Surface& surface) {
  return {&surface.vertices, &surface.triangles};
}

// Returns the vertices and triangles of all surfaces, one surface after the other. What they share
// is not joined: both have vertices there.
SurfaceMesh Joined(const std::vector<SurfaceView>& surfaces);
SurfaceMesh Joined(const std::vector<SurfaceMesh>& surfaces);

}  // namespace mortise::mesh
