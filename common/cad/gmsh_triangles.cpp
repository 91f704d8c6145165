#include "common/cad/gmsh_triangles.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Geometry>
#include <Poly_Triangulation.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/process.h"
#include "common/base/temporary_folder.h"
#include "common/cad/assembly_surface.h"
#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

constexpr char kProgram[] = "gmsh";
constexpr auto kMostTime = std::chrono::seconds(60);
constexpr double kLengthsApart = 1.1;                // ratio of lengths that are one to Gmsh
constexpr double kOnFace = 1e-6;                     // m: how well a place on a face is sought
constexpr double kMostMiss = 2 * kDrawingTolerance;  // of what a fuse moved onto another face
constexpr double kAtAPole = 1e-6;                    // of one derivative to the other

absl::Status GmshFailure(const std::string& how) { return KernelFailure("drawing triangles", how); }

absl::StatusOr<std::string> FindGmsh() {
  const std::filesystem::path program = FindProgram(kProgram);
  if (!program.empty()) return program.string();
  return PreconditionFailed(
      kNoGmsh,
      absl::StrCat("the mesh of what is round needs Gmsh, which is not there: install Debian's "
                   "package '",
                   kProgram, "' where the worker runs"),
      "mesh");
}

// ---- What Gmsh is told --------------------------------------------------------------------------

TopoDS_Compound Together(const std::vector<TopoDS_Face>& faces) {
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces) builder.Add(compound, face);
  return compound;
}

// Gmsh's script: the lengths as fields, each on some faces and the curves around them. Gmsh numbers
// the faces from 1 in the order of the file.
std::string ScriptOf(const std::vector<double>& lengths) {
  std::map<int, std::vector<std::size_t>> groups;  // of about the same length, faces from 1
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const int group = static_cast<int>(std::floor(std::log(lengths[i]) / std::log(kLengthsApart)));
    groups[group].push_back(i + 1);
  }
  std::string script = absl::StrFormat(
      "Geometry.OCCAutoFix = 0;\n"
      "Merge \"faces.brep\";\n"
      "Mesh.MeshSizeFromPoints = 0;\n"
      "Mesh.MeshSizeExtendFromBoundary = 1;\n"
      "Mesh.MeshSizeMax = %.9g;\n"
      "Mesh.SaveParametric = 1;\n"
      "Mesh.MshFileVersion = 2.2;\n",
      *std::max_element(lengths.begin(), lengths.end()));
  std::vector<int> fields;
  for (const auto& [group, members] : groups) {
    const int length = 2 * static_cast<int>(fields.size()) + 1;
    const int field = length + 1;
    const std::string surfaces = absl::StrJoin(members, ",");
    absl::StrAppendFormat(&script,
                          "Field[%d] = MathEval; Field[%d].F = \"%.9g\";\n"
                          "Field[%d] = Restrict; Field[%d].IField = %d;\n"
                          "Field[%d].SurfacesList = {%s};\n"
                          "curves() = Abs(Boundary{ Surface{%s}; });\n"
                          "Field[%d].CurvesList = {curves()};\n",
                          length, length, std::pow(kLengthsApart, group), field, field, length,
                          field, surfaces, surfaces, field);
    fields.push_back(field);
  }
  const int least = 2 * static_cast<int>(fields.size()) + 1;
  absl::StrAppendFormat(&script,
                        "Field[%d] = Min; Field[%d].FieldsList = {%s};\n"
                        "Background Field = %d;\n",
                        least, least, absl::StrJoin(fields, ","), least);
  return script;
}

// What Gmsh writes of the faces.
absl::StatusOr<std::string> RunGmsh(const std::string& program,
                                    const std::vector<TopoDS_Face>& faces,
                                    const std::vector<double>& lengths) {
  const TemporaryFolder folder("gmsh");
  const std::filesystem::path script = folder.path() / "faces.geo", mesh = folder.path() / "mesh",
                              log = folder.path() / "log";
  MORTISE_RETURN_IF_ERROR(WriteFile(script, ScriptOf(lengths)));
  if (!BRepTools::Write(Together(faces), (folder.path() / "faces.brep").c_str(), Standard_False,
                        Standard_False, TopTools_FormatVersion_CURRENT)) {
    return GmshFailure("the faces cannot be written");
  }
  MORTISE_ASSIGN_OR_RETURN(const auto end,
                           RunProcess({program, "-", script.string(), "-2", "-nt", "1", "-v", "1",
                                       "-format", "msh2", "-o", mesh.string()},
                                      log, kMostTime));
  if (!end) return GmshFailure("Gmsh came to no end");
  absl::StatusOr<std::string> written = ReadFile(mesh);
  if (end->signalled || end->code != 0 || !written.ok()) {
    std::string words = ReadFile(log).value_or("");
    absl::RemoveExtraAsciiWhitespace(&words);
    return GmshFailure(absl::StrCat("Gmsh ended with ", end->ToString(), ": ", words));
  }
  return written;
}

// ---- What Gmsh says -----------------------------------------------------------------------------

// A point of Gmsh's mesh. One inside a face knows where.
struct GmshPoint {
  Eigen::Vector3d place;
  std::optional<gp_XY> on_face;
};

struct GmshMesh {
  std::vector<GmshPoint> points;
  std::vector<std::vector<Eigen::Vector3i>> triangles;  // of each face, corners by index of points
};

// Reads MSH 2.2 in text, with points that say where on what they lie.
class GmshMeshReader {
 public:
  GmshMeshReader(const std::string& text, std::size_t faces) : lines_(absl::StrSplit(text, '\n')) {
    mesh_.triangles.resize(faces);
  }

  absl::StatusOr<GmshMesh> Read() {
    for (next_ = 0; next_ < lines_.size();) {
      const absl::string_view line = lines_[next_++];
      const bool is_read = line == "$ParametricNodes" ? ReadSection(&GmshMeshReader::ReadPoint)
                           : line == "$Elements"      ? ReadSection(&GmshMeshReader::ReadElement)
                                                      : true;
      if (!is_read) return GmshFailure(absl::StrCat("Gmsh's mesh breaks off in line ", next_));
    }
    return std::move(mesh_);
  }

 private:
  using Words = std::vector<absl::string_view>;

  bool ReadSection(bool (GmshMeshReader::*read)(const Words&)) {
    int count = 0;
    if (next_ >= lines_.size() || !absl::SimpleAtoi(lines_[next_++], &count)) return false;
    for (int i = 0; i < count; ++i) {
      if (next_ >= lines_.size()) return false;
      const Words words = absl::StrSplit(lines_[next_++], ' ', absl::SkipEmpty());
      if (!(this->*read)(words)) return false;
    }
    return true;
  }

  // Number, x, y, z, dimension and number of what it lies on, places there.
  bool ReadPoint(const Words& words) {
    int number = 0, dimension = 0;
    GmshPoint point;
    if (words.size() < 6 || !absl::SimpleAtoi(words[0], &number) ||
        !absl::SimpleAtoi(words[4], &dimension)) {
      return false;
    }
    for (int i = 0; i < 3; ++i) {
      if (!absl::SimpleAtod(words[static_cast<std::size_t>(1 + i)], &point.place(i))) return false;
    }
    if (dimension == 2) {
      double u = 0, v = 0;
      if (words.size() < 8 || !absl::SimpleAtod(words[6], &u) || !absl::SimpleAtod(words[7], &v)) {
        return false;
      }
      point.on_face = gp_XY(u, v);
    }
    index_[number] = static_cast<int>(mesh_.points.size());
    mesh_.points.push_back(point);
    return true;
  }

  // Number, kind, number of tags, tags (the second is the face), corners.
  bool ReadElement(const Words& words) {
    constexpr int kTriangle = 2;
    int kind = 0, tags = 0, face = 0;
    if (words.size() < 5 || !absl::SimpleAtoi(words[1], &kind)) return false;
    if (kind != kTriangle) return true;
    if (!absl::SimpleAtoi(words[2], &tags) || !absl::SimpleAtoi(words[4], &face) || face < 1 ||
        face > static_cast<int>(mesh_.triangles.size()) || tags < 2 ||
        words.size() != static_cast<std::size_t>(6 + tags)) {
      return false;
    }
    Eigen::Vector3i corners;
    for (int i = 0; i < 3; ++i) {
      int number = 0;
      if (!absl::SimpleAtoi(words[static_cast<std::size_t>(3 + tags + i)], &number)) return false;
      const auto found = index_.find(number);
      if (found == index_.end()) return false;
      corners(i) = found->second;
    }
    mesh_.triangles[static_cast<std::size_t>(face - 1)].push_back(corners);
    return true;
  }

  const std::vector<absl::string_view> lines_;
  std::size_t next_ = 0;
  std::map<int, int> index_;  // of points, by Gmsh's number
  GmshMesh mesh_;
};

// ---- Back to the faces --------------------------------------------------------------------------

gp_Pnt ToPoint(const Eigen::Vector3d& place) { return {place.x(), place.y(), place.z()}; }

Eigen::Vector3d ToEigen(const gp_XYZ& v) { return {v.X(), v.Y(), v.Z()}; }

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
        if (!(miss.norm() <= kMostMiss)) return GmshFailure("Gmsh's triangles are not on a face");
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

absl::StatusOr<GmshTriangles> Triangulate(const std::string& program,
                                          const std::vector<TopoDS_Face>& faces,
                                          const std::vector<double>& lengths) {
  MORTISE_ASSIGN_OR_RETURN(const std::string written, RunGmsh(program, faces, lengths));
  MORTISE_ASSIGN_OR_RETURN(const GmshMesh mesh, GmshMeshReader(written, faces.size()).Read());
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
  MORTISE_ASSIGN_OR_RETURN(const std::string program, FindGmsh());
  try {
    return Triangulate(program, faces, lengths);
  } catch (const Standard_Failure& failure) {
    return KernelFailure("drawing triangles", failure.GetMessageString());
  }
}

}  // namespace mortise::cad
