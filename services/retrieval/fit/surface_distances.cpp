#include "services/retrieval/fit/surface_distances.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace mortise::retrieval {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Boxes = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Triangles TrianglesOf(const mesh::SurfaceMesh& surface) {
  const auto point = [&](int vertex) {
    return Kernel::Point_3(surface.vertices(0, vertex), surface.vertices(1, vertex),
                           surface.vertices(2, vertex));
  };
  Triangles triangles;
  triangles.reserve(static_cast<std::size_t>(surface.triangles.cols()));
  for (const auto& corners : surface.triangles.colwise()) {
    const Kernel::Triangle_3 triangle(point(corners[0]), point(corners[1]), point(corners[2]));
    // A triangle without area has no nearest point in CGAL, and its edges are others' as well.
    if (!triangle.is_degenerate()) triangles.push_back(triangle);
  }
  return triangles;
}

}  // namespace

// The boxes refer to the triangles, so neither moves.
struct SurfaceDistances::Tree {
  explicit Tree(Triangles of)
      : triangles(std::move(of)), boxes(triangles.begin(), triangles.end()) {
    boxes.accelerate_distance_queries();
  }
  const Triangles triangles;
  Boxes boxes;
};

SurfaceDistances::SurfaceDistances(const mesh::SurfaceMesh& surface)
    : tree_(std::make_unique<const Tree>(TrianglesOf(surface))) {}

SurfaceDistances::~SurfaceDistances() = default;

Eigen::VectorXd SurfaceDistances::From(const Eigen::Matrix3Xd& points) const {
  Eigen::VectorXd distances = Eigen::VectorXd::Zero(points.cols());
  if (tree_->triangles.empty()) return distances;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Kernel::Point_3 point(points(0, i), points(1, i), points(2, i));
    distances[i] = std::sqrt(tree_->boxes.squared_distance(point));
  }
  return distances;
}

DistanceSummary Summarize(Eigen::VectorXd distances) {
  if (distances.size() == 0) return {};
  DistanceSummary summary;
  summary.root_mean_square = std::sqrt(distances.squaredNorm() / double(distances.size()));
  const auto last = static_cast<Eigen::Index>(std::ceil(0.95 * double(distances.size()))) - 1;
  std::nth_element(distances.begin(), distances.begin() + last, distances.end());
  summary.percentile_95 = distances[last];
  return summary;
}

}  // namespace mortise::retrieval
