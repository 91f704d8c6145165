#include "common/mesh/tetrahedra/curved_elements.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "common/mesh/element_faces.h"

namespace mortise::mesh {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Triangles = std::vector<Triangle>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
using ElementNodes = Eigen::Matrix<double, 3, 10>;

// Of a triangle's sides: how far from it nodes may be that lie on it. The mesher takes neighbours
// that turn by 0.2 mrad for one plane.
constexpr double kOnTriangle = 1e-3;
// The determinant of the Jacobian, of that with straight sides: anywhere, and where elements are
// integrated. Where two sides of an element follow one smooth face, their tangents become one line
// at the node between them, which takes the determinant there nearly to nothing; stresses do not
// suffer (docs/simulator.md).
constexpr double kLeast = 1e-3;
constexpr double kMinInside = 0.1;

Point ToPoint(const Eigen::Vector3d& place) { return {place.x(), place.y(), place.z()}; }

// How the points of one face's triangles get to the face.
class FaceShifts {
 public:
  // `triangles`: of the face.
  FaceShifts(const AssemblySurface& surface, const std::vector<int>& triangles) {
    for (const int t : triangles) {
      Patch patch;
      for (int k = 0; k < 3; ++k) patch.corners.col(k) = Vertex(surface, t, k);
      const Eigen::Vector3d area = (patch.corners.col(1) - patch.corners.col(0))
                                       .cross(patch.corners.col(2) - patch.corners.col(0));
      if (!(area.norm() > 0)) continue;
      for (int k = 0; k < 3; ++k) {
        patch.shifts.col(k) = Exact(surface, t, k) - Vertex(surface, t, k);
        patch.shifts.col(3 + k) = surface.exact->middles.col(3 * t + k) -
                                  (Exact(surface, t, k) + Exact(surface, t, (k + 1) % 3)) / 2;
      }
      is_curved_ = is_curved_ || !patch.shifts.isZero(0);
      patches_.push_back(patch);
      triangles_.emplace_back(ToPoint(patch.corners.col(0)), ToPoint(patch.corners.col(1)),
                              ToPoint(patch.corners.col(2)));
    }
    if (is_curved_) tree_.rebuild(triangles_.begin(), triangles_.end());
  }
  FaceShifts(const FaceShifts&) = delete;  // the tree refers to the triangles
  FaceShifts& operator=(const FaceShifts&) = delete;

  // Whether any of its points is moved.
  bool is_curved() const { return is_curved_; }

  // From a place on one of the triangles of a curved face to the face; nothing if it is on none.
  std::optional<Eigen::Vector3d> At(const Eigen::Vector3d& place) const {
    const auto [nearest, triangle] = tree_.closest_point_and_primitive(ToPoint(place));
    const Patch& patch = patches_[static_cast<std::size_t>(triangle - triangles_.begin())];
    const Eigen::Vector3d found(nearest.x(), nearest.y(), nearest.z());
    const Eigen::Vector3d along = patch.corners.col(1) - patch.corners.col(0);
    const Eigen::Vector3d across = patch.corners.col(2) - patch.corners.col(0);
    if (!((found - place).norm() <= kOnTriangle * (along.norm() + across.norm()))) return {};
    const Eigen::Vector3d area = along.cross(across);
    const Eigen::Vector3d from_first = found - patch.corners.col(0);
    const double l1 = from_first.cross(across).dot(area) / area.squaredNorm();
    const double l2 = along.cross(from_first).dot(area) / area.squaredNorm();
    const double l0 = 1 - l1 - l2;
    Eigen::Matrix<double, 6, 1> weights;
    weights << l0, l1, l2, 4 * l0 * l1, 4 * l1 * l2, 4 * l2 * l0;
    return patch.shifts * weights;
  }

 private:
  struct Patch {
    Eigen::Matrix3d corners;             // of the triangle
    Eigen::Matrix<double, 3, 6> shifts;  // of corners, and of middles beyond the mean of theirs
  };

  static Eigen::Vector3d Vertex(const AssemblySurface& surface, int t, int k) {
    return surface.vertices.col(surface.triangles(k, t));
  }
  static Eigen::Vector3d Exact(const AssemblySurface& surface, int t, int k) {
    return surface.exact->vertices.col(surface.triangles(k, t));
  }

  std::vector<Patch> patches_;
  bool is_curved_ = false;
  Triangles triangles_;
  Tree tree_;  // where anything is moved
};

// By how much each node moves that is on a face where anything moves.
using Shifts = std::vector<std::optional<Eigen::Vector3d>>;

Shifts ShiftsOnFaces(const AssemblySurface& surface, const TetrahedralMesh& mesh) {
  std::vector<std::vector<int>> of_face(surface.faces.size());
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    of_face[static_cast<std::size_t>(surface.triangle_face(t))].push_back(static_cast<int>(t));
  }
  Shifts shifts(static_cast<std::size_t>(mesh.nodes.cols()));
  std::vector<std::vector<Eigen::Index>> sides(surface.faces.size());  // of elements, on each face
  for (Eigen::Index f = 0; f < mesh.face_triangles.cols(); ++f) {
    sides[static_cast<std::size_t>(mesh.face_triangle_face(f))].push_back(f);
  }
  for (std::size_t face = 0; face < of_face.size(); ++face) {
    const FaceShifts known(surface, of_face[face]);
    if (!known.is_curved()) continue;
    for (const Eigen::Index f : sides[face]) {
      for (const int node : mesh.face_triangles.col(f)) {
        auto& shift = shifts[static_cast<std::size_t>(node)];
        if (!shift) shift = known.At(mesh.nodes.col(node));
      }
    }
  }
  return shifts;
}

using Derivatives = Eigen::Matrix<double, 10, 3>;

// Derivatives of the ten shape functions along the last three barycentric coordinates.
Derivatives DerivativesAt(const Eigen::Vector4d& at) {
  Eigen::Matrix<double, 10, 4> along = Eigen::Matrix<double, 10, 4>::Zero();
  for (int k = 0; k < 4; ++k) along(k, k) = 4 * at(k) - 1;
  for (int k = 0; k < 6; ++k) {
    const auto [i, j] = kTetrahedronEdges[static_cast<std::size_t>(k)];
    along(4 + k, i) = 4 * at(j);
    along(4 + k, j) = 4 * at(i);
  }
  return along.rightCols<3>().colwise() - along.col(0);
}

// At the twenty points that the determinant of the Jacobian, a cubic polynomial, is told by.
std::vector<Derivatives> DerivativesThroughout() {
  std::vector<Derivatives> all;
  for (int i = 0; i <= 3; ++i) {
    for (int j = 0; i + j <= 3; ++j) {
      for (int k = 0; i + j + k <= 3; ++k) {
        all.push_back(DerivativesAt(Eigen::Vector4d(3 - i - j - k, i, j, k) / 3));
      }
    }
  }
  return all;
}

// Where elements are integrated: the four points of the rule of degree 2.
std::vector<Derivatives> DerivativesInside() {
  std::vector<Derivatives> all;
  const double near = (5 + 3 * std::sqrt(5)) / 20, far = (5 - std::sqrt(5)) / 20;
  for (int k = 0; k < 4; ++k) {
    Eigen::Vector4d at = Eigen::Vector4d::Constant(far);
    at(k) = near;
    all.push_back(DerivativesAt(at));
  }
  return all;
}

// Moves nodes, and takes back what elements cannot follow.
class Curving {
 public:
  Curving(const TetrahedralMesh& mesh, Shifts shifts) : mesh_(mesh), shifts_(std::move(shifts)) {
    middle_of_.assign(static_cast<std::size_t>(mesh.nodes.cols()), {-1, -1});
    for (const auto& nodes : mesh.tetrahedra.colwise()) {
      for (int k = 0; k < 6; ++k) {
        const auto& edge = kTetrahedronEdges[static_cast<std::size_t>(k)];
        middle_of_[static_cast<std::size_t>(nodes(4 + k))] = {nodes(edge[0]), nodes(edge[1])};
      }
    }
    moved_ = Moved();
  }

  // Where the nodes get to. Sides of bad elements stay straight; where that is not enough, so do
  // their corners stay.
  Eigen::Matrix3Xd Nodes() {
    for (const bool with_corners : {false, true}) {
      std::vector<Eigen::Index> bad = BadOf(AllElements());
      while (Straighten(bad, with_corners)) {
        const Eigen::Matrix3Xd before = std::exchange(moved_, Moved());
        bad = BadOf(ElementsMovedSince(before));
      }
    }
    return moved_;
  }

 private:
  Eigen::Matrix3Xd Moved() const {
    Eigen::Matrix3Xd moved = mesh_.nodes;
    for (std::size_t node = 0; node < shifts_.size(); ++node) {
      if (shifts_[node]) moved.col(static_cast<Eigen::Index>(node)) += *shifts_[node];
    }
    for (std::size_t node = 0; node < shifts_.size(); ++node) {
      const auto& [a, b] = middle_of_[node];
      if (a < 0 || shifts_[node]) continue;
      moved.col(static_cast<Eigen::Index>(node)) = (moved.col(a) + moved.col(b)) / 2;
    }
    return moved;
  }

  std::vector<Eigen::Index> AllElements() const {
    std::vector<Eigen::Index> all(static_cast<std::size_t>(mesh_.tetrahedra.cols()));
    std::iota(all.begin(), all.end(), 0);
    return all;
  }

  std::vector<Eigen::Index> ElementsMovedSince(const Eigen::Matrix3Xd& before) const {
    std::vector<Eigen::Index> elements;
    for (Eigen::Index e = 0; e < mesh_.tetrahedra.cols(); ++e) {
      const auto nodes = mesh_.tetrahedra.col(e);
      if (std::any_of(nodes.begin(), nodes.end(),
                      [&](int node) { return moved_.col(node) != before.col(node); })) {
        elements.push_back(e);
      }
    }
    return elements;
  }

  std::vector<Eigen::Index> BadOf(const std::vector<Eigen::Index>& elements) const {
    std::vector<Eigen::Index> bad;
    std::copy_if(elements.begin(), elements.end(), std::back_inserter(bad),
                 [this](Eigen::Index e) { return !IsSound(e); });
    return bad;
  }

  // False if nothing of them moves any more.
  bool Straighten(const std::vector<Eigen::Index>& elements, bool with_corners) {
    bool is_changed = false;
    for (const Eigen::Index e : elements) {
      for (int k = with_corners ? 0 : 4; k < 10; ++k) {
        auto& shift = shifts_[static_cast<std::size_t>(mesh_.tetrahedra(k, e))];
        is_changed = is_changed || shift.has_value();
        shift.reset();
      }
    }
    return is_changed;
  }

  bool IsSound(Eigen::Index e) const {
    static const auto throughout = DerivativesThroughout();
    static const auto inside = DerivativesInside();
    ElementNodes straight, curved;
    for (int k = 0; k < 10; ++k) {
      straight.col(k) = mesh_.nodes.col(mesh_.tetrahedra(k, e));
      curved.col(k) = moved_.col(mesh_.tetrahedra(k, e));
    }
    if (curved == straight) return true;
    const double usual = (straight * throughout[0]).determinant();
    const auto keeps = [&](double share, const std::vector<Derivatives>& places) {
      return std::all_of(places.begin(), places.end(), [&](const Derivatives& along) {
        return (curved * along).determinant() >= share * usual;
      });
    };
    return keeps(kLeast, throughout) && keeps(kMinInside, inside);
  }

  const TetrahedralMesh& mesh_;
  Shifts shifts_;
  std::vector<std::array<int, 2>> middle_of_;  // its corners; -1 for what is no middle
  Eigen::Matrix3Xd moved_;
};

}  // namespace

TetrahedralMesh WithCurvedElements(const AssemblySurface& surface, TetrahedralMesh mesh) {
  if (!surface.exact || !mesh.IsQuadratic()) return mesh;
  mesh.nodes = Curving(mesh, ShiftsOnFaces(surface, mesh)).Nodes();
  return mesh;
}

}  // namespace mortise::mesh
