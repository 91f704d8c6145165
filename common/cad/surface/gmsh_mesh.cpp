#include "common/cad/surface/gmsh_mesh.h"

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
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
#include "common/cad/solid_kernel.h"
#include "common/cad/surface/assembly_surface.h"

namespace mortise::cad {
namespace {

constexpr char kProgram[] = "gmsh";
constexpr double kLengthsApart = 1.1;  // ratio of lengths that are one to Gmsh

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

TopoDS_Compound CompoundOf(const std::vector<TopoDS_Face>& faces) {
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
                                    const std::vector<double>& lengths,
                                    std::chrono::milliseconds limit) {
  const TemporaryFolder folder("gmsh");
  const std::filesystem::path script = folder.path() / "faces.geo", mesh = folder.path() / "mesh",
                              log = folder.path() / "log";
  MORTISE_RETURN_IF_ERROR(WriteFile(script, ScriptOf(lengths)));
  if (!BRepTools::Write(CompoundOf(faces), (folder.path() / "faces.brep").c_str(), Standard_False,
                        Standard_False, TopTools_FormatVersion_CURRENT)) {
    return GmshFailure("the faces cannot be written");
  }
  // Settings that somebody keeps at home must not change meshes.
  const std::string home = absl::StrCat("GMSH_HOME=", folder.path().string());
  MORTISE_ASSIGN_OR_RETURN(const auto end,
                           RunProcess({program, "-", script.string(), "-2", "-nt", "1", "-v", "1",
                                       "-format", "msh2", "-o", mesh.string()},
                                      log, limit, {home}));
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

}  // namespace

absl::StatusOr<GmshMesh> MeshWithGmsh(const std::vector<TopoDS_Face>& faces,
                                      const std::vector<double>& lengths,
                                      std::chrono::milliseconds limit) {
  MORTISE_ASSIGN_OR_RETURN(const std::string program, FindGmsh());
  MORTISE_ASSIGN_OR_RETURN(const std::string written, RunGmsh(program, faces, lengths, limit));
  return GmshMeshReader(written, faces.size()).Read();
}

}  // namespace mortise::cad
