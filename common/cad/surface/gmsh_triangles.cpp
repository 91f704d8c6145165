#include "common/cad/surface/gmsh_triangles.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Geometry>
#include <Poly_Triangulation.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <Standard_Failure.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "common/base/errors.h"
#include "common/cad/occt_vectors.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/surface/assembly_surface.h"
#include "common/cad/surface/gmsh_mesh.h"

namespace mortise::cad {
namespace {

constexpr double kOnFace = 1e-6;                    // m: how well a place on a face is sought
constexpr double kMaxMiss = 2 * kDrawingTolerance;  // of what a fuse moved onto another face
constexpr double kAtAPole = 1e-6;                   // of one derivative to the other

absl::Status GmshFailure(const std::string& how) { return KernelFailure("drawing triangles", how); }

// Where on a face corners of triangles lie.
class FacePlaces {
 public:
  FacePlaces(const TopoDS_Face& face, const GmshMesh& mesh)
      : mesh_(mesh), surface_(face, Standard_False), analysis_(BRep_Tool::Surface(face)) {}

  const BRepAdaptor_Surface& surface() const { return surface_; }

  // Of a triangle's corners, near each other: a seam is at both ends of its face, and a pole
  // anywhere along it.
  std::array<gp_XY, 3> Of(const Eigen::Vector3i& corners) {
    std::array<gp_XY, 3> places;
    for (std::size_t k = 0; k < 3; ++k) places[k] = PlaceOf(corners(static_cast<int>(k)));
    const auto is_inside = [&](std::size_t k) {
      return mesh_.points[static_cast<std::size_t>(corners(static_cast<int>(k)))]
          .on_face.has_value();
    };
    std::size_t anchor = 0;
    while (anchor < 2 && !is_inside(anchor)) ++anchor;
    for (std::size_t k = 0; k < 3; ++k) {
      if (surface_.IsUPeriodic()) {
        places[k].SetX(Near(places[k].X(), places[anchor].X(), surface_.UPeriod()));
      }
      if (surface_.IsVPeriodic()) {
        places[k].SetY(Near(places[k].Y(), places[anchor].Y(), surface_.VPeriod()));
      }
    }
    for (std::size_t k = 0; k < 3; ++k) LeavePole(places, k);
    return places;
  }

 private:
  static double Near(double value, double anchor, double period) {
    return value - period * std::round((value - anchor) / period);
  }

  gp_XY PlaceOf(int point) {
    const GmshPoint& known = mesh_.points[static_cast<std::size_t>(point)];
    if (known.on_face) return *known.on_face;
    const auto [found, is_new] = on_edges_.try_emplace(point);
    if (is_new) found->second = analysis_.ValueOfUV(ToPoint(known.place), kOnFace).XY();
    return found->second;
  }

  // Where one derivative vanishes, its parameter is that of the other corners.
  void LeavePole(std::array<gp_XY, 3>& places, std::size_t k) const {
    gp_Pnt point;
    gp_Vec along_u, along_v;
    surface_.D1(places[k].X(), places[k].Y(), point, along_u, along_v);
    const gp_XY others = (places[(k + 1) % 3] + places[(k + 2) % 3]) / 2;
    if (along_u.Magnitude() <= kAtAPole * along_v.Magnitude()) places[k].SetX(others.X());
    if (along_v.Magnitude() <= kAtAPole * along_u.Magnitude()) places[k].SetY(others.Y());
  }

  const GmshMesh& mesh_;
  const BRepAdaptor_Surface surface_;
  ShapeAnalysis_Surface analysis_;
  std::map<int, gp_XY> on_edges_;  // of points that are not inside the face
};

// The triangles of one face, turned as its surface is.
class FaceTriangulation {
 public:
  FaceTriangulation(const TopoDS_Face& face, const GmshMesh& mesh)
      : face_(face), mesh_(mesh), places_(face, mesh) {}

  // `nodes` becomes the point of each node, from 1. INTERNAL where the triangles are not on the
  // face.
  absl::Status Set(std::vector<Eigen::Vector3i> triangles, std::vector<int>& nodes) {
    if (triangles.empty()) return GmshFailure("Gmsh left out a face");
    std::vector<std::array<gp_XY, 3>> places;
    double turned = 0;
    for (const Eigen::Vector3i& corners : triangles) {
      places.push_back(places_.Of(corners));
      for (std::size_t k = 0; k < 3; ++k) {
        const gp_Pnt drawn = places_.surface().Value(places.back()[k].X(), places.back()[k].Y());
        const Eigen::Vector3d miss = ToEigen(drawn.XYZ()) - PlaceOf(corners(static_cast<int>(k)));
        if (!(miss.norm() <= kMaxMiss)) return GmshFailure("Gmsh's triangles are not on a face");
      }
      turned += Facing(corners, places.back());
    }
    if (turned < 0) {
      for (std::size_t t = 0; t < triangles.size(); ++t) {
        std::swap(triangles[t](1), triangles[t](2));
        std::swap(places[t][1], places[t][2]);
      }
    }
    Keep(triangles, places, nodes);
    return absl::OkStatus();
  }

 private:
  const Eigen::Vector3d& PlaceOf(int point) const {
    return mesh_.points[static_cast<std::size_t>(point)].place;
  }

  // Twice the area of a triangle, negative if it is turned against the surface.
  double Facing(const Eigen::Vector3i& corners, const std::array<gp_XY, 3>& places) const {
    const gp_XY middle = (places[0] + places[1] + places[2]) / 3;
    gp_Pnt point;
    gp_Vec along_u, along_v;
    places_.surface().D1(middle.X(), middle.Y(), point, along_u, along_v);
    const Eigen::Vector3d normal = ToEigen(along_u.Crossed(along_v).XYZ()).normalized();
    const Eigen::Vector3d first = PlaceOf(corners(0));
    return (PlaceOf(corners(1)) - first).cross(PlaceOf(corners(2)) - first).dot(normal);
  }

  // Each triangle has nodes of its own, as a seam or pole has another place in each.
  void Keep(const std::vector<Eigen::Vector3i>& triangles,
            const std::vector<std::array<gp_XY, 3>>& places, std::vector<int>& nodes) const {
    const int count = static_cast<int>(triangles.size());
    const Handle(Poly_Triangulation) kept = new Poly_Triangulation(3 * count, count, Standard_True);
    const gp_Trsf to_face = face_.Location().Transformation().Inverted();
    nodes.assign(1, -1);
    for (int t = 0; t < count; ++t) {
      for (int k = 0; k < 3; ++k) {
        const int point = triangles[static_cast<std::size_t>(t)](k);
        kept->SetNode(3 * t + k + 1, ToPoint(PlaceOf(point)).Transformed(to_face));
        kept->SetUVNode(3 * t + k + 1,
                        places[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)]);
        nodes.push_back(point);
      }
      kept->SetTriangle(t + 1, Poly_Triangle(3 * t + 1, 3 * t + 2, 3 * t + 3));
    }
    BRep_Builder().UpdateFace(face_, kept);
  }

  const TopoDS_Face& face_;
  const GmshMesh& mesh_;
  FacePlaces places_;
};

// All points that triangles use, and the triangles of all faces as these point.
GmshTriangles Joined(const std::vector<TopoDS_Face>& faces, const GmshMesh& mesh,
                     std::vector<std::vector<int>> nodes) {
  std::vector<int> vertex(mesh.points.size(), -1);
  GmshTriangles joined;
  Eigen::Index count = 0;
  for (const std::vector<int>& of_face : nodes) {
    count += static_cast<Eigen::Index>(of_face.size() - 1) / 3;
  }
  joined.vertices.resize(3, static_cast<Eigen::Index>(mesh.points.size()));
  joined.triangles.resize(3, count);
  joined.triangle_face.resize(count);
  int used = 0;
  Eigen::Index triangle = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t i = 1; i < nodes[f].size(); ++i) {
      int& known = vertex[static_cast<std::size_t>(nodes[f][i])];
      if (known < 0) {
        joined.vertices.col(used) = mesh.points[static_cast<std::size_t>(nodes[f][i])].place;
        known = used++;
      }
      nodes[f][i] = known;
    }
    const bool is_reversed = faces[f].Orientation() == TopAbs_REVERSED;
    for (std::size_t i = 1; i < nodes[f].size(); i += 3, ++triangle) {
      joined.triangles.col(triangle) << nodes[f][i], nodes[f][i + (is_reversed ? 2 : 1)],
          nodes[f][i + (is_reversed ? 1 : 2)];
      joined.triangle_face(triangle) = static_cast<int>(f);
    }
  }
  joined.vertices.conservativeResize(3, used);
  joined.nodes = std::move(nodes);
  return joined;
}

absl::StatusOr<GmshTriangles> Triangulate(const std::vector<TopoDS_Face>& faces,
                                          const std::vector<double>& lengths) {
  MORTISE_ASSIGN_OR_RETURN(const GmshMesh mesh, MeshWithGmsh(faces, lengths));
  std::vector<std::vector<int>> nodes(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    FaceTriangulation triangulation(faces[f], mesh);
    MORTISE_RETURN_IF_ERROR(triangulation.Set(mesh.triangles[f], nodes[f]));
  }
  return Joined(faces, mesh, std::move(nodes));
}

}  // namespace

absl::StatusOr<GmshTriangles> TriangulateWithGmsh(const std::vector<TopoDS_Face>& faces,
                                                  const std::vector<double>& lengths) {
  try {
    return Triangulate(faces, lengths);
  } catch (const Standard_Failure& failure) {
    return KernelFailure("drawing triangles", failure.GetMessageString());
  }
}

}  // namespace mortise::cad
