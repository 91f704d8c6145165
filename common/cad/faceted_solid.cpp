#include "common/cad/faceted_solid.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRep_Builder.hxx>
#include <Eigen/Geometry>
#include <Standard_Failure.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pln.hxx>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

constexpr double kInPlane = 1e-7;  // m, the kernel's own tolerance

// The directed edge from corner `corner` of `triangle` to the next.
struct Side {
  int triangle = 0;
  int corner = 0;
};

struct Plane {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
  double Above(const Eigen::Vector3d& place) const { return normal.dot(place - point); }
};

// Divides the triangles into connected flat groups.
class FlatGroups {
 public:
  FlatGroups(const mesh::SurfaceMesh& surface, const Eigen::VectorXi& triangle_face)
      : surface_(surface), face_(triangle_face) {
    for (int t = 0; t < surface.triangles.cols(); ++t) {
      for (int k = 0; k < 3; ++k) sides_[{Corner({t, k}), Corner(Next({t, k}))}] = {t, k};
    }
    group_.assign(static_cast<std::size_t>(surface.triangles.cols()), -1);
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
  }

  const std::vector<Plane>& planes() const { return planes_; }
  const std::vector<int>& seeds() const { return seeds_; }

  // The corners of every loop round each group, its own triangles on the left.
  std::vector<std::vector<std::vector<int>>> Loops() const {
    std::vector<std::vector<std::vector<int>>> loops(planes_.size());
    std::vector<bool> seen(3 * group_.size(), false);
    for (int t = 0; t < static_cast<int>(group_.size()); ++t) {
      for (int k = 0; k < 3; ++k) {
        Side side{t, k};
        if (seen[IndexOf(side)] || !IsRim(side)) continue;
        std::vector<int> loop;
        while (!seen[IndexOf(side)]) {
          seen[IndexOf(side)] = true;
          loop.push_back(Corner(side));
          side = Next(side);
          while (!IsRim(side)) side = Next(Opposite(side));
        }
        loops[static_cast<std::size_t>(GroupOf(t))].push_back(std::move(loop));
      }
    }
    return loops;
  }

 private:
  static std::size_t IndexOf(const Side& side) {
    return static_cast<std::size_t>(3 * side.triangle + side.corner);
  }
  static Side Next(const Side& side) { return {side.triangle, (side.corner + 1) % 3}; }
  int Corner(const Side& side) const { return surface_.triangles(side.corner, side.triangle); }
  int GroupOf(int triangle) const { return group_[static_cast<std::size_t>(triangle)]; }
  Side Opposite(const Side& side) const { return sides_.at({Corner(Next(side)), Corner(side)}); }
  bool IsRim(const Side& side) const {
    return GroupOf(Opposite(side).triangle) != GroupOf(side.triangle);
  }

  Eigen::Vector3d AreaVector(int t) const {
    const Eigen::Vector3d a = surface_.vertices.col(surface_.triangles(0, t));
    return (surface_.vertices.col(surface_.triangles(1, t)) - a)
        .cross(surface_.vertices.col(surface_.triangles(2, t)) - a);
  }

  bool LiesIn(const Plane& plane, int t) const {
    for (int k = 0; k < 3; ++k) {
      if (std::abs(plane.Above(surface_.vertices.col(Corner({t, k})))) > kInPlane) return false;
    }
    // Folded back onto the plane it is another face; a sliver faces anywhere.
    const Eigen::Vector3d area = AreaVector(t);
    return area.dot(plane.normal) > 0 || area.norm() < kInPlane * kInPlane;
  }

  void Grow(int seed) {
    const Plane plane{surface_.vertices.col(surface_.triangles(0, seed)),
                      AreaVector(seed).normalized()};
    const int group = static_cast<int>(planes_.size());
    planes_.push_back(plane);
    seeds_.push_back(seed);
    std::vector<int> front{seed};
    group_[static_cast<std::size_t>(seed)] = group;
    while (!front.empty()) {
      const int t = front.back();
      front.pop_back();
      for (int k = 0; k < 3; ++k) {
        const int other = Opposite({t, k}).triangle;
        if (GroupOf(other) >= 0 || face_(other) != face_(seed) || !LiesIn(plane, other)) continue;
        group_[static_cast<std::size_t>(other)] = group;
        front.push_back(other);
      }
    }
  }

  const mesh::SurfaceMesh& surface_;
  const Eigen::VectorXi& face_;
  std::map<std::pair<int, int>, Side> sides_;  // by the corners they run between
  std::vector<int> group_;                     // of each triangle
  std::vector<Plane> planes_;                  // of each group
  std::vector<int> seeds_;                     // a triangle of each group
};

// Makes faces of loops of corners, which share edges and vertices.
class FaceMaker {
 public:
  explicit FaceMaker(const Eigen::Matrix3Xd& places) : places_(places) {
    for (const auto& place : places.colwise()) {
      vertices_.push_back(
          BRepBuilderAPI_MakeVertex(gp_Pnt(place.x(), place.y(), place.z())).Vertex());
    }
  }

  TopoDS_Face FaceOf(const Plane& plane, std::vector<std::vector<int>> loops) {
    // The outer loop runs round the largest area.
    std::stable_sort(loops.begin(), loops.end(), [&](const auto& a, const auto& b) {
      return AreaOf(a, plane) > AreaOf(b, plane);
    });
    const gp_Pln kernel(gp_Pnt(plane.point.x(), plane.point.y(), plane.point.z()),
                        gp_Dir(plane.normal.x(), plane.normal.y(), plane.normal.z()));
    BRepBuilderAPI_MakeFace face(kernel, WireOf(loops.front()), Standard_True);
    for (std::size_t i = 1; i < loops.size(); ++i) face.Add(WireOf(loops[i]));
    return face.Face();
  }

 private:
  double AreaOf(const std::vector<int>& loop, const Plane& plane) const {
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Eigen::Vector3d from = places_.col(loop[i]) - plane.point;
      area += from.cross(places_.col(loop[(i + 1) % loop.size()]) - plane.point);
    }
    return area.dot(plane.normal);
  }

  TopoDS_Edge EdgeOf(int from, int to) {
    const auto [low, high] = std::minmax(from, to);
    TopoDS_Edge& edge = edges_[{low, high}];
    if (edge.IsNull()) {
      edge = BRepBuilderAPI_MakeEdge(vertices_[static_cast<std::size_t>(low)],
                                     vertices_[static_cast<std::size_t>(high)])
                 .Edge();
    }
    return from < to ? edge : TopoDS::Edge(edge.Reversed());
  }

  TopoDS_Wire WireOf(const std::vector<int>& loop) {
    BRep_Builder builder;
    TopoDS_Wire wire;
    builder.MakeWire(wire);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      builder.Add(wire, EdgeOf(loop[i], loop[(i + 1) % loop.size()]));
    }
    wire.Closed(Standard_True);
    return wire;
  }

  const Eigen::Matrix3Xd& places_;
  std::vector<TopoDS_Vertex> vertices_;
  std::map<std::pair<int, int>, TopoDS_Edge> edges_;
};

Solid Make(const mesh::SurfaceMesh& surface, const Eigen::VectorXi& triangle_face,
           const std::vector<std::string>& face_names, const std::string& name) {
  const FlatGroups groups(surface, triangle_face);
  const std::vector<std::vector<std::vector<int>>> loops = groups.Loops();
  FaceMaker maker(surface.vertices);
  auto kernel = std::make_shared<Solid::Kernel>();
  kernel->name = name;
  BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const TopoDS_Face face = maker.FaceOf(groups.planes()[i], loops[i]);
    builder.Add(shell, face);
    kernel->faces.push_back(face);
    kernel->face_names.push_back(
        face_names[static_cast<std::size_t>(triangle_face(groups.seeds()[i]))]);
  }
  shell.Closed(Standard_True);
  TopoDS_Solid solid;
  builder.MakeSolid(solid);
  builder.Add(solid, shell);
  kernel->shape = solid;
  return Solid(std::move(kernel));
}

std::string InMillimetres(const Eigen::Vector3d& place) {
  return absl::StrFormat("(%.6g, %.6g, %.6g) mm", 1e3 * place.x(), 1e3 * place.y(),
                         1e3 * place.z());
}

// Every edge runs once either way, and is long enough for the kernel to tell its ends apart.
absl::Status CheckEdges(const mesh::SurfaceMesh& surface) {
  std::set<std::pair<int, int>> edges;
  for (const auto& corners : surface.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const int from = corners(k), to = corners((k + 1) % 3);
      const Eigen::Vector3d start = surface.vertices.col(from);
      if ((surface.vertices.col(to) - start).norm() <= kInPlane) {
        return InvalidField("shape", absl::StrCat("has an edge too short for the kernel at ",
                                                  InMillimetres(start)));
      }
      if (!edges.emplace(from, to).second) {
        return InvalidField("shape", absl::StrCat("has an edge that two triangles run along in the "
                                                  "same direction, at ",
                                                  InMillimetres(start)));
      }
    }
  }
  for (const auto& [from, to] : edges) {
    if (edges.contains({to, from})) continue;
    return InvalidField("shape",
                        absl::StrCat("is open at ", InMillimetres(surface.vertices.col(from))));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Solid> FacetedSolid(const mesh::SurfaceMesh& surface,
                                   const Eigen::VectorXi& triangle_face,
                                   const std::vector<std::string>& face_names,
                                   const std::string& name) {
  MORTISE_RETURN_IF_ERROR(CheckEdges(surface));
  try {
    return Make(surface, triangle_face, face_names, name);
  } catch (const Standard_Failure& failure) {
    return InvalidField("shape", absl::StrCat("cannot be made: ", failure.GetMessageString()));
  }
}

}  // namespace mortise::cad
