#include "common/templates/features/edge_samples.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRep_Tool.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"
#include "common/mesh/distinct_names.h"
#include "common/mesh/edge_sampling.h"

namespace mortise::cad {
namespace {

constexpr int kWayPieces = 8;  // of a path on a curved edge, so that it follows it

std::string JoinSorted(const std::set<std::string>& names) { return absl::StrJoin(names, " & "); }

// What names of faces are made of. Names by origin stay where faces meet others than before, so
// those told apart only name what has no name of its own by them.
enum Naming { kByOrigin = 0, kToldApart = 1 };
constexpr Naming kNamings[] = {kByOrigin, kToldApart};

// An edge, by one naming.
struct NamedEdge {
  TopoDS_Edge edge;  // with the face of lower name on its left
  std::string first_name;
  int from = -1, to = -1;  // vertices, along the curve; the same of a closed edge
};

struct NamedVertex {
  struct Around {
    std::set<std::string> faces, edges;  // first names
  };
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::array<Around, 2> around;  // by each naming
  int ends = 0;                  // of edges
};

class Sampler {
 public:
  Sampler(const Solid& solid, const std::vector<std::vector<std::string>>& face_names,
          double spacing)
      : shape_(solid.kernel().shape), spacing_(spacing) {
    const std::vector<TopoDS_Face>& faces = solid.kernel().faces;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const std::set<std::string> names(face_names[i].begin(), face_names[i].end());
      face_names_[kByOrigin][faces_.Add(faces[i])] = absl::StrJoin(names, " = ");
    }
  }

  absl::StatusOr<mesh::ControlVariables> Sample() {
    TellFacesApart();
    CollectVertices();
    CollectEdges();
    NameVertices();
    for (const auto& [name, edge] : NameEdges()) {
      MORTISE_RETURN_IF_ERROR(SampleEdge(name, *edge.edge, edge.naming));
    }
    return std::move(variables_);
  }

 private:
  // An edge with the naming that its name is of.
  struct ChosenEdge {
    const NamedEdge* edge = nullptr;
    Naming naming = kByOrigin;
  };

  // Adds what they lie beside to the names of faces that have the same.
  void TellFacesApart() {
    TopTools_IndexedDataMapOfShapeListOfShape beside;
    TopExp::MapShapesAndUniqueAncestors(shape_, TopAbs_EDGE, TopAbs_FACE, beside);
    const std::map<int, std::string>& by_origin = face_names_[kByOrigin];
    std::vector<std::vector<int>> neighbours(by_origin.size());
    for (int i = 1; i <= beside.Extent(); ++i) {
      if (beside(i).Extent() != 2) continue;
      const int first = faces_.FindIndex(beside(i).First());
      const int second = faces_.FindIndex(beside(i).Last());
      neighbours[static_cast<std::size_t>(first) - 1].push_back(second - 1);
      neighbours[static_cast<std::size_t>(second) - 1].push_back(first - 1);
    }
    std::vector<std::string> names;
    for (int f = 1; f <= faces_.Extent(); ++f) names.push_back(by_origin.at(f));
    names = mesh::DistinctNames(std::move(names), neighbours);
    for (int f = 1; f <= faces_.Extent(); ++f) {
      face_names_[kToldApart][f] = names[static_cast<std::size_t>(f) - 1];
    }
  }

  void CollectVertices() {
    TopExp::MapShapes(shape_, TopAbs_VERTEX, vertex_shapes_);
    vertices_.resize(static_cast<std::size_t>(vertex_shapes_.Extent()) + 1);
    for (int v = 1; v <= vertex_shapes_.Extent(); ++v) {
      const gp_Pnt place = BRep_Tool::Pnt(TopoDS::Vertex(vertex_shapes_(v)));
      vertices_[static_cast<std::size_t>(v)].position << place.X(), place.Y(), place.Z();
    }
    for (int f = 1; f <= faces_.Extent(); ++f) {
      for (TopExp_Explorer at(faces_(f), TopAbs_VERTEX); at.More(); at.Next()) {
        NamedVertex& vertex =
            vertices_[static_cast<std::size_t>(vertex_shapes_.FindIndex(at.Current()))];
        for (const Naming naming : kNamings) {
          vertex.around[naming].faces.insert(face_names_[naming].at(f));
        }
      }
    }
  }

  // Takes the edges between two faces, which seams are not.
  void CollectEdges() {
    TopTools_IndexedDataMapOfShapeListOfShape beside;
    TopExp::MapShapesAndUniqueAncestors(shape_, TopAbs_EDGE, TopAbs_FACE, beside);
    for (int i = 1; i <= beside.Extent(); ++i) {
      const TopoDS_Edge& edge = TopoDS::Edge(beside.FindKey(i));
      if (BRep_Tool::Degenerated(edge) || beside(i).Extent() != 2) continue;
      if (vertex_shapes_.FindIndex(TopExp::FirstVertex(edge)) == 0 ||
          vertex_shapes_.FindIndex(TopExp::LastVertex(edge)) == 0) {
        continue;
      }
      edges_.push_back({EdgeBy(kByOrigin, edge, beside(i)), EdgeBy(kToldApart, edge, beside(i))});
      for (const int end : {edges_.back()[kByOrigin].from, edges_.back()[kByOrigin].to}) {
        NamedVertex& vertex = vertices_[static_cast<std::size_t>(end)];
        for (const Naming naming : kNamings) {
          vertex.around[naming].edges.insert(edges_.back()[naming].first_name);
        }
        ++vertex.ends;
      }
    }
  }

  NamedEdge EdgeBy(Naming naming, const TopoDS_Edge& edge, const TopTools_ListOfShape& beside) {
    std::vector<std::pair<std::string, TopoDS_Shape>> faces;
    for (const TopoDS_Shape& face : beside) {
      faces.emplace_back(face_names_[naming].at(faces_.FindIndex(face)), face);
    }
    std::sort(faces.begin(), faces.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    NamedEdge named;
    named.edge = AlongFace(edge, TopoDS::Face(faces[0].second));
    named.first_name = absl::StrCat(faces[0].first, " & ", faces[1].first);
    named.from = vertex_shapes_.FindIndex(TopExp::FirstVertex(named.edge, Standard_True));
    named.to = vertex_shapes_.FindIndex(TopExp::LastVertex(named.edge, Standard_True));
    return named;
  }

  // Returns the edge as it bounds the face.
  static TopoDS_Edge AlongFace(const TopoDS_Edge& edge, const TopoDS_Face& face) {
    for (TopExp_Explorer at(face, TopAbs_EDGE); at.More(); at.Next()) {
      if (at.Current().IsSame(edge)) return TopoDS::Edge(at.Current());
    }
    return edge;
  }

  std::string FirstNameOf(int vertex, Naming naming) const {
    return JoinSorted(vertices_[static_cast<std::size_t>(vertex)].around[naming].faces);
  }

  // A vertex at which one closed edge begins and ends, or none, is of a seam.
  bool IsOfSeam(int vertex) const {
    const NamedVertex& of = vertices_[static_cast<std::size_t>(vertex)];
    const NamedVertex::Around& around = of.around[kToldApart];
    return around.faces.size() < 2 || of.ends < 2 || (of.ends == 2 && around.edges.size() == 1);
  }

  void NameVertices() {
    for (const Naming naming : kNamings) {
      std::map<std::string, std::vector<int>> by_name;
      for (int v = 1; v <= vertex_shapes_.Extent(); ++v) {
        if (IsOfSeam(v) || point_of_vertex_.contains(v)) continue;
        const NamedVertex::Around& around = vertices_[static_cast<std::size_t>(v)].around[naming];
        by_name[absl::StrCat(FirstNameOf(v, naming), " of ", JoinSorted(around.edges))].push_back(
            v);
      }
      for (const auto& [name, of_name] : by_name) {
        if (of_name.size() > 1) continue;
        point_of_vertex_[of_name[0]] =
            AddPoint(name, vertices_[static_cast<std::size_t>(of_name[0])].position);
      }
    }
  }

  std::map<std::string, ChosenEdge> NameEdges() const {
    std::map<std::string, ChosenEdge> named;
    std::vector<bool> is_named(edges_.size(), false);
    for (const Naming naming : kNamings) {
      std::map<std::string, std::vector<std::size_t>> by_name;
      for (std::size_t e = 0; e < edges_.size(); ++e) {
        if (!is_named[e]) by_name[NameOf(edges_[e][naming], naming)].push_back(e);
      }
      for (const auto& [name, edges] : by_name) {
        if (edges.size() > 1) continue;
        is_named[edges[0]] = true;
        named.emplace(name, ChosenEdge{&edges_[edges[0]][naming], naming});
      }
    }
    return named;
  }

  std::string NameOf(const NamedEdge& edge, Naming naming) const {
    if (edge.from == edge.to) return absl::StrCat(edge.first_name, " around");
    std::vector<std::string> ends = {FirstNameOf(edge.from, naming), FirstNameOf(edge.to, naming)};
    std::sort(ends.begin(), ends.end());
    return absl::StrCat(edge.first_name, " between ", ends[0], " and ", ends[1]);
  }

  int AddPoint(std::string name, const Eigen::Vector3d& position) {
    variables_.points.push_back({std::move(name), position});
    return static_cast<int>(variables_.points.size()) - 1;
  }

  int PointOf(int vertex) const {
    const auto point = point_of_vertex_.find(vertex);
    return point == point_of_vertex_.end() ? -1 : point->second;
  }

  absl::Status SampleEdge(const std::string& name, const NamedEdge& edge, Naming naming) {
    const BRepAdaptor_Curve curve(edge.edge);
    mesh::NamedEdge sampled;
    sampled.name = name;
    sampled.length = GCPnts_AbscissaPoint::Length(curve);
    sampled.is_closed = edge.from == edge.to;
    const bool ends_low =
        !sampled.is_closed && FirstNameOf(edge.to, naming) < FirstNameOf(edge.from, naming);
    if (!sampled.is_closed) {
      sampled.from = PointOf(ends_low ? edge.to : edge.from);
      sampled.to = PointOf(ends_low ? edge.from : edge.to);
    }
    const bool is_backward = (edge.edge.Orientation() == TopAbs_REVERSED) != ends_low;
    const int pieces = curve.GetType() == GeomAbs_Line ? 1 : kWayPieces;
    sampled.way = [&curve, is_backward, pieces, length = sampled.length](double from, double to) {
      Eigen::Matrix3Xd way(3, pieces + 1);
      for (int k = 0; k <= pieces; ++k) {
        const double share = from + (to - from) * k / pieces;
        const double along = (is_backward ? 1 - share : share) * length;
        const gp_Pnt place =
            curve.Value(GCPnts_AbscissaPoint(curve, along, curve.FirstParameter()).Parameter());
        way.col(k) << place.X(), place.Y(), place.Z();
      }
      return way;
    };
    return mesh::SampleEdge(sampled, spacing_, variables_);
  }

  TopoDS_Shape shape_;
  double spacing_;
  TopTools_IndexedMapOfShape faces_, vertex_shapes_;
  std::array<std::map<int, std::string>, 2> face_names_;  // by each naming: by index in `faces_`
  std::vector<NamedVertex> vertices_;                     // by index in `vertex_shapes_`
  std::vector<std::array<NamedEdge, 2>> edges_;           // by each naming
  std::map<int, int> point_of_vertex_;
  mesh::ControlVariables variables_;
};

}  // namespace

absl::StatusOr<mesh::ControlVariables> FindControlVariables(
    const Solid& solid, const std::vector<std::vector<std::string>>& face_names, double spacing) {
  if (!std::isfinite(spacing) || spacing <= 0) {
    return InvalidField("spacing", absl::StrCat("is ", spacing, " m, not positive"));
  }
  try {
    return Sampler(solid, face_names, spacing).Sample();
  } catch (const Standard_Failure& failure) {
    return KernelFailure("sampling the edges of a solid",
                         failure.GetMessageString() ? failure.GetMessageString() : "");
  }
}

absl::StatusOr<mesh::ControlVariables> FindControlVariables(const RegeneratedModel& model,
                                                            double spacing) {
  std::vector<std::vector<std::string>> names;
  for (const std::vector<FaceName>& origins : model.origins) {
    std::vector<std::string>& of_face = names.emplace_back();
    for (const FaceName& name : origins) of_face.push_back(ToString(name));
  }
  return FindControlVariables(model.solid, names, spacing);
}

}  // namespace mortise::cad
