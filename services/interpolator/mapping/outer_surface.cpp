#include "services/interpolator/mapping/outer_surface.h"

#include <algorithm>
#include <cstddef>

#include "common/mesh/element_faces.h"
#include "services/interpolator/mapping/barycentric.h"
#include "services/interpolator/mapping/sheet_separation.h"

namespace mortise::interpolator {
namespace {

constexpr double kFlat = 1e-7;  // rad, that triangles of a flat face may be inclined

// Which of the six directions along axes the normal of a triangle has; −1 for none.
int DirectionOf(const mesh::SurfaceMesh& surface, int triangle) {
  const Eigen::Matrix3d at = surface.vertices(Eigen::all, surface.triangles.col(triangle));
  const Eigen::Vector3d normal = (at.col(1) - at.col(0)).cross(at.col(2) - at.col(0)).normalized();
  int axis = 0;
  const double along = normal.cwiseAbs().maxCoeff(&axis);
  const double off = (normal - normal[axis] * Eigen::Vector3d::Unit(axis)).norm();
  if (!(along > 0.5) || off > kFlat) return -1;
  return 2 * axis + (normal[axis] > 0 ? 1 : 0);
}

// Returns the row of the node in the middle of the edge between two corners of an element.
int MiddleOf(int a, int b) {
  int row = 4;
  for (const auto& [from, to] : mesh::kTetrahedronEdges) {
    if ((from == a && to == b) || (from == b && to == a)) break;
    ++row;
  }
  return row;
}

}  // namespace

OuterSurface MakeOuterSurface(const Eigen::Matrix3Xd& nodes, const Eigen::Matrix3Xi& triangles,
                              const Eigen::Matrix3Xi& middles) {
  OuterSurface outer;
  outer.middles = middles;
  mesh::SurfaceMesh& surface = outer.marked.surface;
  surface.triangles.resize(3, triangles.cols());
  std::vector<int> vertex_of(static_cast<std::size_t>(nodes.cols()), -1);
  for (Eigen::Index i = 0; i < triangles.size(); ++i) {
    const int node = triangles(i % 3, i / 3);
    int& vertex = vertex_of[static_cast<std::size_t>(node)];
    if (vertex < 0) {
      vertex = static_cast<int>(outer.node.size());
      outer.node.push_back(node);
    }
    surface.triangles(i % 3, i / 3) = vertex;
  }
  surface.vertices = nodes(Eigen::all, outer.node);
  for (const int vertex : SeparateSheets(surface.vertices, surface.triangles)) {
    outer.node.push_back(outer.node[static_cast<std::size_t>(vertex)]);
  }
  surface.vertices = nodes(Eigen::all, outer.node);
  return outer;
}

OuterSurface OuterSurfaceOf(const mesh::TetrahedralMesh& mesh) {
  const std::vector<mesh::ElementFace> faces = mesh::ElementFaces(mesh).Outer();
  Eigen::Matrix3Xi triangles(3, static_cast<Eigen::Index>(faces.size())), middles;
  if (mesh.IsQuadratic()) middles.resize(3, triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const mesh::ElementFace& face = faces[static_cast<std::size_t>(t)];
    const auto& corners = mesh::kTetrahedronFaces[static_cast<std::size_t>(face.side)];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      triangles(row, t) = mesh.tetrahedra(corners[k], face.element);
      if (!mesh.IsQuadratic()) continue;
      middles(row, t) = mesh.tetrahedra(MiddleOf(corners[k], corners[(k + 1) % 3]), face.element);
    }
  }
  return MakeOuterSurface(mesh.nodes, triangles, middles);
}

std::vector<TrianglePlace> PlacesBeforeMarking(const mesh::SurfaceMesh& given,
                                               const MarkedSurface& marked, const SurfaceMap& map,
                                               std::size_t count) {
  std::vector<TrianglePlace> places(map.places.begin(),
                                    map.places.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t v = 0; v < count; ++v) {
    if (places[v].triangle < 0) continue;
    const int triangle = marked.origin[static_cast<std::size_t>(places[v].triangle)];
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = given.vertices.col(given.triangles(k, triangle));
    places[v] = {triangle, BarycentricIn(corners, map.positions.col(static_cast<Eigen::Index>(v)))};
  }
  return places;
}

void FollowCurvedSides(const Eigen::Matrix3Xd& nodes, const OuterSurface& source, SurfaceMap& map) {
  if (source.middles.cols() == 0) return;
  for (std::size_t v = 0; v < map.places.size(); ++v) {
    const int triangle = map.places[v].triangle;
    if (triangle < 0) continue;
    const Eigen::Vector3d& share = map.places[v].barycentric;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const int corner =
          source.node[static_cast<std::size_t>(source.marked.surface.triangles(k, triangle))];
      position += share[k] * (2 * share[k] - 1) * nodes.col(corner) +
                  4 * share[k] * share[(k + 1) % 3] * nodes.col(source.middles(k, triangle));
    }
    map.positions.col(static_cast<Eigen::Index>(v)) = position;
  }
}

Eigen::Array3Xi SlidesOnFlatFaces(const OuterSurface& source, const OuterSurface& target,
                                  const MarkedSurface& marked,
                                  const std::vector<TrianglePlace>& places) {
  constexpr int kUnknown = -2;
  const mesh::SurfaceMesh& surface = target.marked.surface;
  std::vector<int> direction(places.size(),
                             kUnknown);  // of all triangles around; −1 if they differ
  for (int t = 0; t < static_cast<int>(surface.triangles.cols()); ++t) {
    const int of_triangle = DirectionOf(surface, t);
    for (const int vertex : surface.triangles.col(t)) {
      int& of_vertex = direction[static_cast<std::size_t>(vertex)];
      of_vertex = of_vertex == kUnknown || of_vertex == of_triangle ? of_triangle : -1;
    }
  }
  const auto keep = [&](int vertex) {
    if (vertex < static_cast<int>(direction.size()))
      direction[static_cast<std::size_t>(vertex)] = -1;
  };
  for (const ControlPoint& point : marked.points) keep(point.vertex);
  for (const ControlPath& path : marked.paths) {
    for (const int vertex : path.vertices) keep(vertex);
  }
  Eigen::Array3Xi slides = Eigen::Array3Xi::Zero(3, static_cast<Eigen::Index>(places.size()));
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (direction[v] < 0 || places[v].triangle < 0) continue;
    if (DirectionOf(source.marked.surface, places[v].triangle) != direction[v]) continue;
    slides.col(static_cast<Eigen::Index>(v)) = 1;
    slides(direction[v] / 2, static_cast<Eigen::Index>(v)) = 0;
  }
  return slides;
}

void JoinSheets(const OuterSurface& target, Eigen::Matrix3Xd& positions) {
  const int last =
      target.node.empty() ? -1 : *std::max_element(target.node.begin(), target.node.end());
  std::vector<int> count(static_cast<std::size_t>(last + 1), 0);
  Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, last + 1);
  for (std::size_t v = 0; v < target.node.size(); ++v) {
    sum.col(target.node[v]) += positions.col(static_cast<Eigen::Index>(v));
    ++count[static_cast<std::size_t>(target.node[v])];
  }
  for (std::size_t v = 0; v < target.node.size(); ++v) {
    const int sheets = count[static_cast<std::size_t>(target.node[v])];
    if (sheets > 1) positions.col(static_cast<Eigen::Index>(v)) = sum.col(target.node[v]) / sheets;
  }
}

std::vector<NodePlace> PlacesInNodes(const OuterSurface& outer,
                                     const std::vector<TrianglePlace>& places) {
  std::vector<NodePlace> in_nodes(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].triangle < 0) continue;
    const Eigen::Vector3i corners = outer.marked.surface.triangles.col(places[i].triangle);
    for (int k = 0; k < 3; ++k) {
      in_nodes[i].nodes[k] = outer.node[static_cast<std::size_t>(corners[k])];
    }
    in_nodes[i].shares = places[i].barycentric;
  }
  return in_nodes;
}

}  // namespace mortise::interpolator
