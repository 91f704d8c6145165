// Points of a query that are compared with designs.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::retrieval {

// Points spread evenly over a surface by area, in its own frame and unit. Where a point belongs is
// told by its `smoothed` place and its normal, which are means over the surface around it as far as
// there is noise: with them the two faces of a board are told apart although the noise is larger
// than its thickness. How far it is off is told by its place as it is.
struct QueryPoints {
  Eigen::Matrix3Xd places;    // 3 × n
  Eigen::Matrix3Xd smoothed;  // 3 × n
  Eigen::Matrix3Xd normals;   // 3 × n, of length 1
  std::vector<bool> sided;    // n: whether the normal points outwards, rather than either way
  double diagonal = 0;        // of the surface
  double noise = 0;           // standard deviation, estimated

  Eigen::Index size() const { return places.cols(); }
};

// `count` of them; a seed gives the same points always. INVALID_ARGUMENT, "query", as Weld.
absl::StatusOr<QueryPoints> MakeQueryPoints(const mesh::SurfaceMesh& surface, Eigen::Index count,
                                            std::uint64_t seed);

// About `count` of the points, evenly.
QueryPoints EvenPart(const QueryPoints& points, Eigen::Index count);

}  // namespace mortise::retrieval
