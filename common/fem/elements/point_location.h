// Finds where points lie in a mesh.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// An element and a point's barycentric coordinates there.
struct LocatedPoint {
  Eigen::Index element = -1;  // -1 where no element has the point
  Eigen::Vector4d barycentric = Eigen::Vector4d::Zero();
};

// Returns the element that each point is deepest in; one that lies outside of the body by more than
// a twentieth of an element has none: curved sides bulge. O(elements × points).
std::vector<LocatedPoint> LocatePoints(const mesh::TetrahedralMesh& mesh,
                                       const std::vector<Eigen::Vector3d>& points);

}  // namespace mortise::simulator
