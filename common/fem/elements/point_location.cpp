#include "common/fem/elements/point_location.h"

#include <Eigen/LU>

#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {
namespace {

// How far outside of an element's corners a point still counts as in it.
constexpr double kOutside = -0.05;

}  // namespace

std::vector<LocatedPoint> LocatePoints(const mesh::TetrahedralMesh& mesh,
                                       const std::vector<Eigen::Vector3d>& points) {
  std::vector<LocatedPoint> found(points.size());
  std::vector<double> depth(points.size(), kOutside);
  for (Eigen::Index e = 0; !points.empty() && e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = positions.col(k + 1) - positions.col(0);
    const Eigen::Matrix3d inverse = edges.inverse();
    for (std::size_t i = 0; i < points.size(); ++i) {
      Eigen::Vector4d l;
      l.tail<3>() = inverse * (points[i] - positions.col(0));
      l[0] = 1 - l.tail<3>().sum();
      if (!(l.minCoeff() > depth[i])) continue;
      depth[i] = l.minCoeff();
      found[i] = {e, l};
    }
  }
  return found;
}

}  // namespace mortise::simulator
