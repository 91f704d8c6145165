#include "common/mesh/shapes/flat_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/mesh/halfedge_mesh.h"

namespace mortise::mesh {
namespace {

using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;

// Grows flat faces from triangle to triangle of a closed surface.
class FlatGroups {
 public:
  FlatGroups(const SurfaceMesh& surface, const CutSurface& connected,
             const Eigen::VectorXi& triangle_face, double in_plane)
      : surface_(surface),
        connected_(connected),
        triangle_face_(triangle_face),
        in_plane_(in_plane),
        group_(static_cast<std::size_t>(surface.triangles.cols()), -1) {
    // The largest first: their planes are the most exact.
    std::vector<double> areas;
    for (int t = 0; t < surface.triangles.cols(); ++t) areas.push_back(AreaVector(t).norm());
    std::vector<int> order(areas.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return areas[static_cast<std::size_t>(a)] > areas[static_cast<std::size_t>(b)];
    });
    for (const int t : order) {
      if (GroupOf(t) < 0) Grow(t);
    }
    FindLoops();
  }

  std::vector<FlatFace> Take() && { return std::move(faces_); }

 private:
  static std::size_t IndexOf(HalfedgeHandle side) { return static_cast<std::size_t>(side.idx()); }
  const HalfedgeMesh& mesh() const { return connected_.mesh(); }
  int GroupOf(int triangle) const { return group_[static_cast<std::size_t>(triangle)]; }
  int TriangleBeyond(HalfedgeHandle side) const {
    return mesh().face_handle(mesh().opposite_halfedge_handle(side)).idx();
  }
  bool IsRim(HalfedgeHandle side) const {
    return GroupOf(TriangleBeyond(side)) != GroupOf(mesh().face_handle(side).idx());
  }

  Eigen::Vector3d AreaVector(int t) const {
    const Eigen::Vector3d a = surface_.vertices.col(surface_.triangles(0, t));
    return (surface_.vertices.col(surface_.triangles(1, t)) - a)
        .cross(surface_.vertices.col(surface_.triangles(2, t)) - a);
  }

  bool LiesIn(const FlatFace& plane, int t) const {
    for (const int corner : surface_.triangles.col(t)) {
      const double above = plane.normal.dot(surface_.vertices.col(corner) - plane.point);
      if (std::abs(above) > in_plane_) return false;
    }
    // Folded back onto the plane it is another face; a sliver faces anywhere.
    const Eigen::Vector3d area = AreaVector(t);
    return area.dot(plane.normal) > 0 || area.norm() < in_plane_ * in_plane_;
  }

  void Grow(int seed) {
    const int group = static_cast<int>(faces_.size());
    faces_.push_back({.point = surface_.vertices.col(surface_.triangles(0, seed)),
                      .normal = AreaVector(seed).normalized(),
                      .face = triangle_face_(seed),
                      .loops = {}});
    std::vector<int> front{seed};
    group_[static_cast<std::size_t>(seed)] = group;
    while (!front.empty()) {
      HalfedgeHandle side = mesh().halfedge_handle(FaceHandle(front.back()));
      front.pop_back();
      for (int k = 0; k < 3; ++k, side = mesh().next_halfedge_handle(side)) {
        const int other = TriangleBeyond(side);
        if (GroupOf(other) >= 0 || triangle_face_(other) != triangle_face_(seed) ||
            !LiesIn(faces_.back(), other)) {
          continue;
        }
        group_[static_cast<std::size_t>(other)] = group;
        front.push_back(other);
      }
    }
  }

  void FindLoops() {
    std::vector<bool> seen(mesh().n_halfedges(), false);
    for (const FaceHandle triangle : mesh().all_faces()) {
      HalfedgeHandle start = mesh().halfedge_handle(triangle);
      for (int k = 0; k < 3; ++k, start = mesh().next_halfedge_handle(start)) {
        if (seen[IndexOf(start)] || !IsRim(start)) continue;
        std::vector<int> loop;
        for (HalfedgeHandle side = start; !seen[IndexOf(side)];) {
          seen[IndexOf(side)] = true;
          loop.push_back(connected_.CornerOf(side));
          side = mesh().next_halfedge_handle(side);
          while (!IsRim(side)) side = mesh().cw_rotated_halfedge_handle(side);
        }
        faces_[static_cast<std::size_t>(GroupOf(triangle.idx()))].loops.push_back(std::move(loop));
      }
    }
  }

  const SurfaceMesh& surface_;
  const CutSurface& connected_;
  const Eigen::VectorXi& triangle_face_;
  double in_plane_;
  std::vector<int> group_;  // of each triangle
  std::vector<FlatFace> faces_;
};

absl::Status CheckEdges(const SurfaceMesh& surface, const CutSurface& connected, double shortest) {
  for (const SurfaceEdge& edge : connected.edges()) {
    const Eigen::Vector3d start = surface.vertices.col(edge.low);
    const char* fault = nullptr;
    if ((surface.vertices.col(edge.high) - start).norm() <= shortest) {
      fault = "has an edge too short for the kernel at";
    } else if (std::max(edge.forward, edge.backward) > 1) {
      fault = "has an edge that two triangles run along in the same direction, at";
    } else if (!edge.IsJoined()) {
      fault = "is open at";
    }
    if (fault == nullptr) continue;
    return InvalidField("shape", absl::StrFormat("%s (%.6g, %.6g, %.6g) mm", fault, 1e3 * start.x(),
                                                 1e3 * start.y(), 1e3 * start.z()));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<FlatFace>> FindFlatFaces(const SurfaceMesh& surface,
                                                    const Eigen::VectorXi& triangle_face,
                                                    double in_plane) {
  const CutSurface connected(surface.vertices, surface.triangles);
  MORTISE_RETURN_IF_ERROR(CheckEdges(surface, connected, in_plane));
  return FlatGroups(surface, connected, triangle_face, in_plane).Take();
}

}  // namespace mortise::mesh
