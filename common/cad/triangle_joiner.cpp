#include "common/cad/triangle_joiner.h"

#include <BRep_Tool.hxx>
#include <Eigen/Geometry>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <limits>

#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

constexpr double kOnSide = 1e-6;  // of a triangle's height: what is nearer to a side is on it

}  // namespace

absl::StatusOr<std::vector<int>> TriangleJoiner::Append(const TopoDS_Face& face, int index) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (mesh.IsNull()) return KernelFailure("triangulating the solid", "a face has no triangles");
  std::vector<int> nodes(static_cast<std::size_t>(mesh->NbNodes()) + 1, -1);
  for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next()) {
    const Handle(Poly_PolygonOnTriangulation) polygon =
        BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(edge.Current()), mesh, location);
    if (polygon.IsNull()) {
      return KernelFailure("triangulating the solid", "an edge has no points");
    }
    MORTISE_RETURN_IF_ERROR(
        JoinEdge(TopoDS::Edge(edge.Current()), *mesh, location, *polygon, nodes));
  }
  for (int i = 1; i <= mesh->NbNodes(); ++i) {
    int& point = nodes[static_cast<std::size_t>(i)];
    if (point < 0) point = Add(mesh->Node(i).Transformed(location.Transformation()));
  }
  const std::size_t first = triangles_.size();
  for (int i = 1; i <= mesh->NbTriangles(); ++i) {
    int a = 0, b = 0, c = 0;
    mesh->Triangle(i).Get(a, b, c);
    if (face.Orientation() == TopAbs_REVERSED) std::swap(b, c);
    const Eigen::Vector3i triangle(nodes[static_cast<std::size_t>(a)],
                                   nodes[static_cast<std::size_t>(b)],
                                   nodes[static_cast<std::size_t>(c)]);
    // At the apex of a cone, whose edge there is a single point.
    if (triangle(0) == triangle(1) || triangle(1) == triangle(2) || triangle(2) == triangle(0)) {
      continue;
    }
    triangles_.push_back(triangle);
    faces_.push_back(index);
  }
  SplitAtLoneVertices(face, first);
  return nodes;
}

void TriangleJoiner::MoveTo(mesh::AssemblySurface& surface) const {
  surface.vertices.resize(3, static_cast<Eigen::Index>(points_.size()));
  for (std::size_t i = 0; i < points_.size(); ++i) {
    surface.vertices.col(static_cast<Eigen::Index>(i)) = points_[i];
  }
  const auto count = static_cast<Eigen::Index>(triangles_.size());
  surface.triangles.resize(3, count);
  surface.triangle_face.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    surface.triangles.col(i) = triangles_[static_cast<std::size_t>(i)];
    surface.triangle_face(i) = faces_[static_cast<std::size_t>(i)];
  }
}

int TriangleJoiner::Add(const gp_Pnt& point) {
  points_.push_back({point.X(), point.Y(), point.Z()});
  return static_cast<int>(points_.size()) - 1;
}

int TriangleJoiner::PointOf(const TopoDS_Vertex& vertex) {
  const int* known = vertices_.Seek(vertex);
  if (known != nullptr) return *known;
  const int index = Add(BRep_Tool::Pnt(vertex));
  vertices_.Bind(vertex, index);
  return index;
}

// Gives the nodes of a face's triangulation that lie on the edge the points of the edge.
absl::Status TriangleJoiner::JoinEdge(const TopoDS_Edge& edge, const Poly_Triangulation& mesh,
                                      const TopLoc_Location& location,
                                      const Poly_PolygonOnTriangulation& polygon,
                                      std::vector<int>& nodes) {
  const int count = polygon.NbNodes();
  std::vector<int>& along = edges_[edges_by_shape_.Add(edge)];
  if (along.empty()) {
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    along.push_back(PointOf(TopExp::FirstVertex(forward)));
    for (int i = 2; i < count; ++i) {
      along.push_back(BRep_Tool::Degenerated(edge)
                          ? along.front()
                          : Add(mesh.Node(polygon.Node(i)).Transformed(location.Transformation())));
    }
    along.push_back(PointOf(TopExp::LastVertex(forward)));
  }
  if (static_cast<int>(along.size()) != count) {
    return KernelFailure("triangulating the solid", "an edge is divided in two ways");
  }
  for (int i = 1; i <= count; ++i) {
    nodes[static_cast<std::size_t>(polygon.Node(i))] = along[static_cast<std::size_t>(i) - 1];
  }
  return absl::OkStatus();
}

// Vertices within a face, where another part touches it in a point. The kernel leaves them out.
void TriangleJoiner::SplitAtLoneVertices(const TopoDS_Face& face, std::size_t first) {
  for (TopExp_Explorer lone(face, TopAbs_VERTEX, TopAbs_EDGE); lone.More(); lone.Next()) {
    SplitAt(PointOf(TopoDS::Vertex(lone.Current())), first);
  }
}

// Divides the nearest of the triangles from `first` on in three that meet in the point; where it
// lies on a side, that triangle and the one beyond in two each.
void TriangleJoiner::SplitAt(int point, std::size_t first) {
  const Eigen::Vector3d place = points_[static_cast<std::size_t>(point)];
  std::size_t nearest = triangles_.size();
  double least = std::numeric_limits<double>::infinity();
  Eigen::Vector3d shares = Eigen::Vector3d::Zero();
  for (std::size_t t = first; t < triangles_.size(); ++t) {
    const Eigen::Vector3d a = points_[static_cast<std::size_t>(triangles_[t](0))];
    const Eigen::Vector3d u = points_[static_cast<std::size_t>(triangles_[t](1))] - a;
    const Eigen::Vector3d v = points_[static_cast<std::size_t>(triangles_[t](2))] - a;
    const Eigen::Vector3d normal = u.cross(v);
    const Eigen::Vector3d offset = place - a;
    const double share_u = offset.cross(v).dot(normal) / normal.squaredNorm();
    const double share_v = u.cross(offset).dot(normal) / normal.squaredNorm();
    const Eigen::Vector3d own(1 - share_u - share_v, share_u, share_v);
    if (!(own.minCoeff() >= -kOnSide)) continue;
    const double height = std::abs(offset.dot(normal)) / normal.norm();
    if (height >= least) continue;
    least = height;
    nearest = t;
    shares = own;
  }
  if (nearest == triangles_.size()) return;
  const Eigen::Vector3i corners = triangles_[nearest];
  if ((corners.array() == point).any()) return;
  int opposite = 0;
  if (shares.minCoeff(&opposite) < kOnSide) {
    const int from = corners((opposite + 1) % 3), to = corners((opposite + 2) % 3);
    for (std::size_t t = first; t < triangles_.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (triangles_[t](k) != to || triangles_[t]((k + 1) % 3) != from) continue;
        SplitSide(t, k, point);
        SplitSide(nearest, (opposite + 1) % 3, point);
        return;
      }
    }
  }
  triangles_[nearest](2) = point;
  triangles_.push_back({point, corners(1), corners(2)});
  triangles_.push_back({corners(0), point, corners(2)});
  faces_.insert(faces_.end(), 2, faces_[nearest]);
}

// Divides a triangle in two by a point on the side from its corner `side` to the next.
void TriangleJoiner::SplitSide(std::size_t triangle, int side, int point) {
  Eigen::Vector3i second = triangles_[triangle];
  triangles_[triangle]((side + 1) % 3) = point;
  second(side) = point;
  triangles_.push_back(second);
  faces_.push_back(faces_[triangle]);
}

}  // namespace mortise::cad
