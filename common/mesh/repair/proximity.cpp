#include "common/mesh/repair/proximity.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::mesh {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using Triangle = Kernel::Triangle_3;
using Triangles = std::vector<Triangle>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

constexpr double kRounding = 1e-9;  // m; what touches is so far apart, or so deep, by rounding

// A surface ready to be asked. The tree refers to the triangles, so neither moves.
class Surface {
 public:
  explicit Surface(Triangles triangles_in) : triangles(std::move(triangles_in)) {
    boxes.reserve(triangles.size());
    for (const Triangle& triangle : triangles) {
      boxes.push_back(triangle.bbox());
      box += boxes.back();
    }
  }

  // Takes longer to make than many a question whose answer needs none.
  const Tree& tree() const {
    std::call_once(is_built_, [this] {
      // What points are nearest to begin with would take as long again, for few questions.
      tree_.do_not_accelerate_distance_queries();
      tree_.insert(triangles.begin(), triangles.end());
      tree_.build();
    });
    return tree_;
  }

  const Triangles triangles;
  std::vector<CGAL::Bbox_3> boxes;  // of the triangles
  CGAL::Bbox_3 box;                 // around all

 private:
  mutable std::once_flag is_built_;
  mutable Tree tree_;
};

Point ToPoint(const Eigen::Vector3d& vertex) { return {vertex.x(), vertex.y(), vertex.z()}; }

absl::Status CheckSurface(const SurfaceMesh& surface, const std::string& field) {
  if (surface.triangles.cols() == 0) return InvalidField(field, "has no triangles");
  if (!surface.vertices.allFinite()) return InvalidField(field, "has vertices that are not finite");
  const bool in_range =
      surface.triangles.minCoeff() >= 0 && surface.triangles.maxCoeff() < surface.vertices.cols();
  if (!in_range) return InvalidField(field, "has triangles with vertices that do not exist");
  return absl::OkStatus();
}

std::unique_ptr<const Surface> Prepare(const SurfaceMesh& mesh) {
  Triangles triangles;
  triangles.reserve(static_cast<std::size_t>(mesh.triangles.cols()));
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    triangles.emplace_back(ToPoint(mesh.vertices.col(mesh.triangles(0, t))),
                           ToPoint(mesh.vertices.col(mesh.triangles(1, t))),
                           ToPoint(mesh.vertices.col(mesh.triangles(2, t))));
  }
  return std::make_unique<const Surface>(std::move(triangles));
}

CGAL::Bbox_3 Grown(const CGAL::Bbox_3& box, double margin) {
  return {box.xmin() - margin, box.ymin() - margin, box.zmin() - margin,
          box.xmax() + margin, box.ymax() + margin, box.zmax() + margin};
}

Segment EdgeOf(const Triangle& triangle, int edge) {
  return {triangle.vertex(edge), triangle.vertex(edge + 1)};
}

// Triangles that do not cross are nearest at two edges, or at a corner and a face.
double SquaredDistance(const Triangle& a, const Triangle& b) {
  if (!a.is_degenerate() && !b.is_degenerate() && CGAL::do_intersect(a, b)) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      least = std::min(least, CGAL::squared_distance(EdgeOf(a, i), EdgeOf(b, j)));
    }
    if (!b.is_degenerate()) least = std::min(least, CGAL::squared_distance(a.vertex(i), b));
    if (!a.is_degenerate()) least = std::min(least, CGAL::squared_distance(b.vertex(i), a));
  }
  return least;
}

// Of boxes around what is measured, never more than the distance.
double SquaredDistance(const CGAL::Bbox_3& a, const CGAL::Bbox_3& b) {
  double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double apart = std::max({a.min(axis) - b.max(axis), b.min(axis) - a.max(axis), 0.0});
    squared += apart * apart;
  }
  return squared;
}

// The triangles whose boxes meet `where`.
std::vector<std::size_t> TrianglesIn(const CGAL::Bbox_3& where, const Surface& surface) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < surface.boxes.size(); ++i) {
    if (CGAL::do_overlap(surface.boxes[i], where)) found.push_back(i);
  }
  return found;
}

// Measures triangles of two surfaces; what is further apart than `tolerance`, or than the nearest
// so far, is passed over.
class NearestTriangles {
 public:
  NearestTriangles(const Surface& a, const Surface& b, double tolerance)
      : a_(a), b_(b), passed_over_(JustBeyond(tolerance)) {}

  void Measure(std::size_t i, std::size_t j) {
    if (SquaredDistance(a_.boxes[i], b_.boxes[j]) >= passed_over_) return;
    squared_ = std::min(squared_, SquaredDistance(a_.triangles[i], b_.triangles[j]));
    if (squared_ <= kRounding * kRounding) squared_ = 0;
    passed_over_ = std::min(passed_over_, squared_);
  }

  // Infinite if nothing was measured.
  double squared() const { return squared_; }

 private:
  // The square of a little more: what is just as far apart counts, however it is rounded.
  static double JustBeyond(double tolerance) {
    const double beyond = tolerance * (1 + 1e-12) + kRounding;
    return beyond * beyond;
  }

  const Surface& a_;
  const Surface& b_;
  double passed_over_;
  double squared_ = std::numeric_limits<double>::infinity();
};

// The least distance between two surfaces, as far as it is within `tolerance`; infinity beyond.
double DistanceWithin(const Surface& a, const Surface& b, double tolerance) {
  constexpr std::size_t kMaxPairs = 100'000;  // that are looked at one by one
  const std::vector<std::size_t> of_a = TrianglesIn(Grown(b.box, tolerance), a);
  const std::vector<std::size_t> of_b = TrianglesIn(Grown(a.box, tolerance), b);
  NearestTriangles nearest(a, b, tolerance);
  const bool one_by_one = of_a.size() * of_b.size() <= kMaxPairs;
  double reach = tolerance;
  std::vector<Triangles::const_iterator> near;
  for (const std::size_t i : of_a) {
    if (one_by_one) {
      for (std::size_t j = 0; j < of_b.size() && nearest.squared() > 0; ++j) {
        nearest.Measure(i, of_b[j]);
      }
    } else {
      near.clear();
      b.tree().all_intersected_primitives(Grown(a.boxes[i], reach), std::back_inserter(near));
      for (const auto& other : near) {
        nearest.Measure(i, static_cast<std::size_t>(other - b.triangles.begin()));
      }
    }
    if (nearest.squared() == 0) return 0;
    reach = std::min(reach, std::sqrt(nearest.squared()));
  }
  const double least = std::sqrt(nearest.squared());
  return least <= tolerance ? least : std::numeric_limits<double>::infinity();
}

double SolidAngle(const Point& from, const Triangle& triangle) {
  const auto a = triangle.vertex(0) - from;
  const auto b = triangle.vertex(1) - from;
  const auto c = triangle.vertex(2) - from;
  const double la = std::sqrt(a.squared_length());
  const double lb = std::sqrt(b.squared_length());
  const double lc = std::sqrt(c.squared_length());
  return 2 * std::atan2(CGAL::scalar_product(a, CGAL::cross_product(b, c)),
                        la * lb * lc + CGAL::scalar_product(a, b) * lc +
                            CGAL::scalar_product(b, c) * la + CGAL::scalar_product(a, c) * lb);
}

// By the winding number (van Oosterom and Strackee 1983): whole for closed surfaces, and far from a
// half for any point that is not on the surface.
bool IsInside(const Point& point, const Surface& surface) {
  double sum = 0;
  for (const Triangle& triangle : surface.triangles) sum += SolidAngle(point, triangle);
  return std::abs(sum) > 2 * std::acos(-1.0);
}

bool Encloses(const Surface& outer, const Surface& inner) {
  const CGAL::Bbox_3& a = outer.box;
  const CGAL::Bbox_3& b = inner.box;
  const bool box_encloses = a.xmin() <= b.xmin() && a.ymin() <= b.ymin() && a.zmin() <= b.zmin() &&
                            a.xmax() >= b.xmax() && a.ymax() >= b.ymax() && a.zmax() >= b.zmax();
  return box_encloses && IsInside(inner.triangles.front().vertex(0), outer);
}

}  // namespace

absl::StatusOr<std::vector<Proximity>> FindProximities(
    const std::vector<SurfaceMesh>& surfaces, double tolerance,
    const std::function<bool(std::size_t)>& goes_on) {
  if (!std::isfinite(tolerance) || tolerance < 0) {
    return InvalidField("tolerance", "must be a finite length that is not negative");
  }
  std::vector<std::unique_ptr<const Surface>> prepared;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(CheckSurface(surfaces[i], absl::StrCat("surfaces[", i, "]")));
    prepared.push_back(Prepare(surfaces[i]));
  }
  std::vector<Proximity> proximities;
  for (std::size_t i = 0; i < prepared.size(); ++i) {
    for (std::size_t j = i + 1; j < prepared.size(); ++j) {
      const Surface& a = *prepared[i];
      const Surface& b = *prepared[j];
      if (!CGAL::do_overlap(Grown(a.box, tolerance), b.box)) continue;
      const bool a_is_smaller = a.triangles.size() <= b.triangles.size();
      double distance = DistanceWithin(a_is_smaller ? a : b, a_is_smaller ? b : a, tolerance);
      if (!std::isfinite(distance) && (Encloses(a, b) || Encloses(b, a))) distance = 0;
      if (!std::isfinite(distance)) continue;
      proximities.push_back({static_cast<int>(i), static_cast<int>(j), distance});
    }
    if (!goes_on(i + 1)) return absl::CancelledError("nobody waits for the contacts any more");
  }
  return proximities;
}

// ---- Depth --------------------------------------------------------------------------------------

struct ProbedSurface::Prepared {
  std::unique_ptr<const Surface> surface;
  std::vector<Point> vertices;  // of its edges, each once
  std::vector<Segment> edges;   // each once
};

namespace {

constexpr std::size_t kMaxProbes = 4000;  // points whose depth is measured

std::vector<Point> VerticesOf(const SurfaceMesh& mesh) {
  std::vector<bool> is_used(static_cast<std::size_t>(mesh.vertices.cols()), false);
  for (const int vertex : mesh.triangles.reshaped()) {
    is_used[static_cast<std::size_t>(vertex)] = true;
  }
  std::vector<Point> vertices;
  for (std::size_t vertex = 0; vertex < is_used.size(); ++vertex) {
    if (!is_used[vertex]) continue;
    vertices.push_back(ToPoint(mesh.vertices.col(static_cast<Eigen::Index>(vertex))));
  }
  return vertices;
}

std::vector<Segment> EdgesOf(const SurfaceMesh& mesh) {
  std::vector<Segment> edges;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = mesh.triangles(k, t), to = mesh.triangles((k + 1) % 3, t);
      if (from < to) {
        edges.emplace_back(ToPoint(mesh.vertices.col(from)), ToPoint(mesh.vertices.col(to)));
      }
    }
  }
  return edges;
}

// By how many triangles a ray meets, in directions that no edge of a drawing has; two of three.
bool IsWithin(const Point& point, const Surface& surface) {
  const Kernel::Vector_3 directions[] = {{0.577215, 0.301030, 0.759136},
                                         {-0.415926, 0.718281, 0.557759},
                                         {0.161803, -0.882317, 0.441927}};
  int inside = 0;
  for (const Kernel::Vector_3& direction : directions) {
    const std::size_t met =
        surface.tree().number_of_intersected_primitives(Kernel::Ray_3(point, direction));
    inside += met % 2 == 1 ? 1 : 0;
  }
  return inside >= 2;
}

// Where along the segment, 0 to 1, it meets the surface, its ends among them, in order.
std::vector<double> Crossings(const Segment& edge, const Surface& surface,
                              std::vector<Triangles::const_iterator>& met) {
  met.clear();
  surface.tree().all_intersected_primitives(edge, std::back_inserter(met));
  std::vector<double> along = {0, 1};
  const auto direction = edge.to_vector();
  for (const auto& triangle : met) {
    const auto normal = CGAL::cross_product(triangle->vertex(1) - triangle->vertex(0),
                                            triangle->vertex(2) - triangle->vertex(0));
    const double slope = CGAL::scalar_product(normal, direction);
    if (slope == 0) continue;
    const double at = CGAL::scalar_product(normal, triangle->vertex(0) - edge.source()) / slope;
    if (at > 0 && at < 1) along.push_back(at);
  }
  std::sort(along.begin(), along.end());
  return along;
}

// No point of `part` is deeper in a solid within `whole` than this: leaving the box, it leaves the
// solid.
double MostDepth(const CGAL::Bbox_3& part, const CGAL::Bbox_3& whole) {
  double most = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double low = whole.min(axis), high = whole.max(axis);
    const double from = std::max(part.min(axis), low), to = std::min(part.max(axis), high);
    if (from > to) return 0;
    const double deepest = std::clamp((low + high) / 2, from, to);
    most = std::min({most, deepest - low, high - deepest});
  }
  return most;
}

// Measures how deep points lie in a solid; what is no deeper than the deepest so far, or than
// `least`, m, is passed over.
class DeepestPoint {
 public:
  DeepestPoint(const Surface& solid, double least)
      : solid_(solid), deepest_(std::max(least, kRounding)), least_(deepest_) {}

  // Whether some point of what is in the box may be deeper than all before.
  bool MayBeDeeper(const CGAL::Bbox_3& part) const {
    return MostDepth(part, solid_.box) > deepest_ && probes_ < kMaxProbes;
  }

  void Measure(const Point& point) {
    if (!MayBeDeeper(point.bbox())) return;
    ++probes_;
    // Most points of what only touches lie near a face: that there is one is soon found, and which
    // is nearest is not asked.
    if (solid_.tree().do_intersect(Kernel::Sphere_3(point, deepest_ * deepest_))) return;
    const double depth = std::sqrt(solid_.tree().squared_distance(point));
    if (depth > deepest_ && IsWithin(point, solid_)) deepest_ = depth;
  }

  // Lets as many points more be measured.
  void ProbeAgain() { probes_ = 0; }

  // 0 if nothing was deeper than `least`.
  double depth() const { return deepest_ > least_ ? deepest_ : 0; }

 private:
  const Surface& solid_;
  double deepest_;  // m
  const double least_;
  std::size_t probes_ = 0;
};

// How deep vertices and edges reach into `solid`; 0 if no deeper than `least`, m.
double DepthOf(const std::vector<Point>& vertices, const std::vector<Segment>& edges,
               const Surface& solid, double least) {
  DeepestPoint deepest(solid, least);
  for (const Point& vertex : vertices) deepest.Measure(vertex);
  // Edges may cross what no vertex reaches, however many vertices there are.
  deepest.ProbeAgain();
  std::vector<Triangles::const_iterator> met;
  for (const Segment& edge : edges) {
    if (!deepest.MayBeDeeper(edge.bbox())) continue;
    const std::vector<double> along = Crossings(edge, solid, met);
    for (std::size_t i = 1; i < along.size(); ++i) {
      deepest.Measure(edge.source() + 0.5 * (along[i - 1] + along[i]) * edge.to_vector());
    }
  }
  return deepest.depth();
}

}  // namespace

ProbedSurface::ProbedSurface(const SurfaceMesh& surface)
    : prepared_(std::make_shared<const Prepared>(
          Prepared{Prepare(surface), VerticesOf(surface), EdgesOf(surface)})) {}

double ProbedSurface::Distance(const ProbedSurface& a, const ProbedSurface& b, double limit) {
  const Surface& first = *a.prepared_->surface;
  const Surface& second = *b.prepared_->surface;
  if (!CGAL::do_overlap(Grown(first.box, limit), second.box)) {
    return std::numeric_limits<double>::infinity();
  }
  const double distance = first.triangles.size() <= second.triangles.size()
                              ? DistanceWithin(first, second, limit)
                              : DistanceWithin(second, first, limit);
  return distance > 0 && (Encloses(first, second) || Encloses(second, first)) ? 0 : distance;
}

double ProbedSurface::Separation(const ProbedSurface& a, const ProbedSurface& b, double limit,
                                 double least) {
  const double distance = Distance(a, b, limit);
  if (distance > 0) return distance;
  const auto depth = [least](const Prepared& part, const Prepared& solid) {
    return DepthOf(part.vertices, part.edges, *solid.surface, least);
  };
  return -std::max(depth(*a.prepared_, *b.prepared_), depth(*b.prepared_, *a.prepared_));
}

}  // namespace mortise::mesh
