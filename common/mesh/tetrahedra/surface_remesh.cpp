#include "common/mesh/tetrahedra/surface_remesh.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/base/errors.h"

namespace mortise::mesh {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

constexpr double kPlane = 1e-3;          // rad, by which a face turns at most that counts as plane
constexpr unsigned kRounds = 5;          // of the remeshing
constexpr double kMaxPieces = 1.2e5;     // into which edges are divided at first
constexpr double kLongBorder = 4 / 3.0;  // of the wanted length: what CGAL takes without dividing

// Height over longest edge: a face with a flatter new triangle keeps its old ones.
constexpr double kMinRoundness = 1e-4;

using Edge = std::pair<int, int>;                                 // vertices, the lower first
using FaceTriangles = std::vector<std::vector<Eigen::Vector3i>>;  // those of each face

Edge EdgeOf(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

Eigen::Vector3d AreaVector(const AssemblySurface& surface, Eigen::Index t) {
  const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t));
  const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, t));
  const Eigen::Vector3d c = surface.vertices.col(surface.triangles(2, t));
  return (b - a).cross(c - a) / 2;
}

double LengthOf(const AssemblySurface& surface, const Edge& edge) {
  return (surface.vertices.col(edge.first) - surface.vertices.col(edge.second)).norm();
}

// How a face bends over the edges within it.
struct Bend {
  double area = 0;     // m²
  double turned = 0;   // rad m, how sharply it turns at each edge times the edge's length
  double largest = 0;  // rad
  double lengths = 0;  // m, of all edges together
};

std::vector<Bend> BendsOf(const AssemblySurface& surface) {
  std::vector<Bend> bends(surface.faces.size());
  std::map<Edge, std::vector<int>> beside;
  for (int t = 0; t < static_cast<int>(surface.triangles.cols()); ++t) {
    bends[static_cast<std::size_t>(surface.triangle_face[t])].area += AreaVector(surface, t).norm();
    for (int k = 0; k < 3; ++k) {
      beside[EdgeOf(surface.triangles(k, t), surface.triangles((k + 1) % 3, t))].push_back(t);
    }
  }
  for (const auto& [edge, triangles] : beside) {
    if (triangles.size() != 2) continue;
    const int face = surface.triangle_face[triangles[0]];
    if (face != surface.triangle_face[triangles[1]]) continue;
    const Eigen::Vector3d first = AreaVector(surface, triangles[0]);
    const Eigen::Vector3d second = AreaVector(surface, triangles[1]);
    const double turn = std::atan2(first.cross(second).norm(), first.dot(second));
    Bend& bend = bends[static_cast<std::size_t>(face)];
    bend.turned += turn * LengthOf(surface, edge);
    bend.largest = std::max(bend.largest, turn);
    bend.lengths += LengthOf(surface, edge);
  }
  return bends;
}

// Fails where edges of these lengths, m, divide those that are there into too many pieces.
absl::Status CheckPieces(const std::vector<Bend>& bends, const std::vector<double>& lengths) {
  double pieces = 0;
  for (std::size_t f = 0; f < bends.size(); ++f) pieces += bends[f].lengths / lengths[f];
  if (pieces <= kMaxPieces) return absl::OkStatus();
  return TooLarge("a surface whose faces are drawn anew", "120,000 edges");
}

// The edges that new triangles of each face should have, m; infinite for plane ones.
std::vector<double> LengthsOnCurved(const std::vector<Bend>& bends, double longest, double turn) {
  std::vector<double> lengths;
  for (const Bend& bend : bends) {
    lengths.push_back(bend.largest < kPlane ? std::numeric_limits<double>::infinity()
                                            : std::min(longest, turn * bend.area / bend.turned));
  }
  return lengths;
}

// The same, of plane ones alone.
std::vector<double> LengthsOnPlane(const std::vector<Bend>& bends, double length) {
  std::vector<double> lengths;
  for (const Bend& bend : bends) {
    lengths.push_back(bend.largest < kPlane ? length : std::numeric_limits<double>::infinity());
  }
  return lengths;
}

// Halves the outlines of faces until they are short enough for the faces beside them, with all
// triangles there.
class OutlineDivision {
 public:
  OutlineDivision(const AssemblySurface& surface, const std::vector<double>& lengths)
      : surface_(surface), lengths_(lengths) {
    for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
      triangles_.emplace_back(surface.triangles.col(t));
      faces_.push_back(surface.triangle_face[t]);
    }
    for (Eigen::Index v = 0; v < surface.vertices.cols(); ++v) {
      vertices_.emplace_back(surface.vertices.col(v));
    }
  }

  AssemblySurface Divide() {
    while (Pass()) {
    }
    AssemblySurface divided = surface_;
    divided.exact.reset();
    divided.vertices.resize(3, static_cast<Eigen::Index>(vertices_.size()));
    divided.triangles.resize(3, static_cast<Eigen::Index>(triangles_.size()));
    divided.triangle_face.resize(static_cast<Eigen::Index>(triangles_.size()));
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      divided.vertices.col(static_cast<Eigen::Index>(v)) = vertices_[v];
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      divided.triangles.col(static_cast<Eigen::Index>(t)) = triangles_[t];
      divided.triangle_face[static_cast<Eigen::Index>(t)] = faces_[t];
    }
    return divided;
  }

 private:
  // Divides each triangle at one edge of an outline at most; whether any is too long.
  bool Pass() {
    std::map<Edge, std::vector<std::size_t>> beside;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        beside[EdgeOf(triangles_[t][k], triangles_[t][(k + 1) % 3])].push_back(t);
      }
    }
    is_divided_.assign(triangles_.size(), false);
    bool any = false;
    for (const auto& [edge, around] : beside) {
      if (!IsTooLong(edge, around)) continue;
      any = true;
      const bool is_free = std::none_of(around.begin(), around.end(),
                                        [this](std::size_t t) { return is_divided_[t]; });
      if (is_free) Halve(edge, around);
    }
    return any;
  }

  bool IsTooLong(const Edge& edge, const std::vector<std::size_t>& around) const {
    double wanted = std::numeric_limits<double>::infinity();
    bool is_outline = around.size() != 2;
    for (const std::size_t t : around) {
      wanted = std::min(wanted, lengths_[static_cast<std::size_t>(faces_[t])]);
      is_outline = is_outline || faces_[t] != faces_[around[0]];
    }
    const double length = (vertices_[static_cast<std::size_t>(edge.first)] -
                           vertices_[static_cast<std::size_t>(edge.second)])
                              .norm();
    return is_outline && length > kLongBorder * wanted;
  }

  void Halve(const Edge& edge, const std::vector<std::size_t>& around) {
    const int middle = static_cast<int>(vertices_.size());
    vertices_.emplace_back((vertices_[static_cast<std::size_t>(edge.first)] +
                            vertices_[static_cast<std::size_t>(edge.second)]) /
                           2);
    for (const std::size_t t : around) {
      is_divided_[t] = true;
      Eigen::Vector3i half = triangles_[t];
      for (int k = 0; k < 3; ++k) {
        if (half[k] == edge.first) half[k] = middle;
        if (triangles_[t][k] == edge.second) triangles_[t][k] = middle;
      }
      triangles_.push_back(half);
      faces_.push_back(faces_[t]);
    }
  }

  const AssemblySurface& surface_;
  const std::vector<double>& lengths_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Eigen::Vector3i> triangles_;
  std::vector<int> faces_;
  std::vector<bool> is_divided_;  // in this pass
};

// One face by itself, drawn anew.
class FacePatch {
 public:
  // False if its triangles do not make a mesh.
  bool Take(const AssemblySurface& surface, const std::vector<Eigen::Vector3i>& triangles) {
    std::unordered_map<int, Mesh::Vertex_index> known;
    for (const Eigen::Vector3i& triangle : triangles) {
      std::array<Mesh::Vertex_index, 3> corners;
      for (int k = 0; k < 3; ++k) {
        const auto [place, is_new] = known.try_emplace(triangle[k]);
        if (is_new) {
          const Eigen::Vector3d at = surface.vertices.col(triangle[k]);
          place->second = mesh_.add_vertex(Point(at.x(), at.y(), at.z()));
          origin_[place->second] = triangle[k];
        }
        corners[static_cast<std::size_t>(k)] = place->second;
      }
      if (mesh_.add_face(corners[0], corners[1], corners[2]) == Mesh::null_face()) return false;
    }
    return true;
  }

  // False if CGAL fails, or makes flat triangles.
  bool Remesh(double length) {
    try {
      pmp::isotropic_remeshing(mesh_.faces(), length, mesh_,
                               CGAL::parameters::number_of_iterations(kRounds)
                                   .protect_constraints(true)
                                   .number_of_relaxation_steps(3));
    } catch (const std::exception&) {
      return false;
    }
    mesh_.collect_garbage();
    return LeastRoundness() >= kMinRoundness;
  }

  // Its triangles; vertices that are new are added.
  std::vector<Eigen::Vector3i> Give(std::vector<Eigen::Vector3d>& vertices) const {
    std::vector<int> index(mesh_.number_of_vertices());
    for (const Mesh::Vertex_index v : mesh_.vertices()) {
      int& of_vertex = index[static_cast<std::size_t>(v)];
      const Point& at = mesh_.point(v);
      if (mesh_.is_border(v) && origin_[v] >= 0) {
        of_vertex = origin_[v];
      } else {
        of_vertex = static_cast<int>(vertices.size());
        vertices.emplace_back(at.x(), at.y(), at.z());
      }
    }
    std::vector<Eigen::Vector3i> triangles;
    for (const Mesh::Face_index f : mesh_.faces()) {
      Eigen::Vector3i corners;
      int k = 0;
      for (const Mesh::Vertex_index v : vertices_around_face(mesh_.halfedge(f), mesh_)) {
        corners[k++] = index[static_cast<std::size_t>(v)];
      }
      triangles.push_back(corners);
    }
    return triangles;
  }

 private:
  double LeastRoundness() const {
    double least = 1;
    for (const Mesh::Face_index f : mesh_.faces()) {
      std::array<Eigen::Vector3d, 3> corners;
      std::size_t k = 0;
      for (const Mesh::Vertex_index v : vertices_around_face(mesh_.halfedge(f), mesh_)) {
        const Point& at = mesh_.point(v);
        corners[k++] = {at.x(), at.y(), at.z()};
      }
      double longest = 0;
      for (k = 0; k < 3; ++k) {
        longest = std::max(longest, (corners[(k + 1) % 3] - corners[k]).squaredNorm());
      }
      const double area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
      least = std::min(least, longest > 0 ? area / longest : 0);
    }
    return least;
  }

  Mesh mesh_;
  Mesh::Property_map<Mesh::Vertex_index, int> origin_ =
      mesh_.add_property_map<Mesh::Vertex_index, int>("v:origin", -1).first;
};

std::map<Edge, int> TrianglesAtEdges(const FaceTriangles& triangles) {
  std::map<Edge, int> around;
  for (const std::vector<Eigen::Vector3i>& of_face : triangles) {
    for (const Eigen::Vector3i& t : of_face) {
      for (int k = 0; k < 3; ++k) ++around[EdgeOf(t[k], t[(k + 1) % 3])];
    }
  }
  return around;
}

// Faces with triangles at edges at which more meet than did before, as both were drawn anew over
// the same two points of an outline, get their old ones back.
void UndoCrowded(const FaceTriangles& before, FaceTriangles& now) {
  const std::map<Edge, int> allowed = TrianglesAtEdges(before);
  while (true) {
    const std::map<Edge, int> around = TrianglesAtEdges(now);
    const auto is_crowded = [&](const Edge& edge) {
      const auto known = allowed.find(edge);
      return around.at(edge) > (known == allowed.end() ? 2 : std::max(2, known->second));
    };
    bool any = false;
    for (std::size_t f = 0; f < now.size(); ++f) {
      const bool undo = std::any_of(now[f].begin(), now[f].end(), [&](const Eigen::Vector3i& t) {
        return is_crowded(EdgeOf(t[0], t[1])) || is_crowded(EdgeOf(t[1], t[2])) ||
               is_crowded(EdgeOf(t[2], t[0]));
      });
      if (!undo || now[f] == before[f]) continue;
      now[f] = before[f];
      any = true;
    }
    if (!any) return;
  }
}

// The surface of these triangles, with those of the vertices that they use.
AssemblySurface Assembled(const AssemblySurface& surface,
                          const std::vector<Eigen::Vector3d>& vertices,
                          const FaceTriangles& triangles) {
  AssemblySurface drawn = surface;
  drawn.exact.reset();
  Eigen::Index count = 0;
  for (const auto& of_face : triangles) count += static_cast<Eigen::Index>(of_face.size());
  drawn.triangles.resize(3, count);
  drawn.triangle_face.resize(count);
  drawn.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  std::vector<int> index(vertices.size(), -1);
  int used = 0;
  Eigen::Index next = 0;
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    for (const Eigen::Vector3i& triangle : triangles[f]) {
      for (int k = 0; k < 3; ++k) {
        const auto vertex = static_cast<std::size_t>(triangle[k]);
        if (index[vertex] < 0) {
          drawn.vertices.col(used) = vertices[vertex];
          index[vertex] = used++;
        }
        drawn.triangles(k, next) = index[vertex];
      }
      drawn.triangle_face[next++] = static_cast<int>(f);
    }
  }
  drawn.vertices.conservativeResize(Eigen::NoChange, used);
  return drawn;
}

// Faces get triangles with edges of `lengths`, m, where these are finite.
AssemblySurface DrawnAnew(const AssemblySurface& surface, const std::vector<double>& lengths) {
  const AssemblySurface divided = OutlineDivision(surface, lengths).Divide();
  FaceTriangles before(surface.faces.size());
  for (Eigen::Index t = 0; t < divided.triangles.cols(); ++t) {
    before[static_cast<std::size_t>(divided.triangle_face[t])].emplace_back(
        divided.triangles.col(t));
  }
  std::vector<Eigen::Vector3d> vertices;
  for (Eigen::Index v = 0; v < divided.vertices.cols(); ++v) {
    vertices.emplace_back(divided.vertices.col(v));
  }
  FaceTriangles now = before;
  for (std::size_t f = 0; f < now.size(); ++f) {
    FacePatch patch;
    if (std::isfinite(lengths[f]) && patch.Take(divided, before[f]) && patch.Remesh(lengths[f])) {
      now[f] = patch.Give(vertices);
    }
  }
  UndoCrowded(before, now);
  return Assembled(divided, vertices, now);
}

}  // namespace

absl::StatusOr<AssemblySurface> WithRoundTriangles(const AssemblySurface& surface, double longest,
                                                   double turn) {
  const std::vector<Bend> bends = BendsOf(surface);
  const std::vector<double> lengths = LengthsOnCurved(bends, longest, turn);
  MORTISE_RETURN_IF_ERROR(CheckPieces(bends, lengths));
  return DrawnAnew(surface, lengths);
}

absl::StatusOr<AssemblySurface> WithEvenTriangles(const AssemblySurface& surface, double length) {
  const std::vector<Bend> bends = BendsOf(surface);
  const std::vector<double> lengths = LengthsOnPlane(bends, length);
  MORTISE_RETURN_IF_ERROR(CheckPieces(bends, lengths));
  return DrawnAnew(surface, lengths);
}

FaceKinds KindsOfFaces(const AssemblySurface& surface) {
  const std::vector<Bend> bends = BendsOf(surface);
  FaceKinds kinds;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Bend& bend = bends[static_cast<std::size_t>(surface.triangle_face[t])];
    if (bend.largest < kPlane) {
      kinds.plane_area += AreaVector(surface, t).norm();
    } else {
      ++kinds.curved_triangles;
    }
  }
  return kinds;
}

}  // namespace mortise::mesh
