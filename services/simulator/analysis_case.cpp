#include "services/simulator/analysis_case.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::simulator {
namespace {

std::string FaceText(const mesh::TetrahedralMesh& mesh, const mesh::NamedFace& face) {
  const bool known = face.part >= 0 && face.part < static_cast<int>(mesh.part_names.size());
  return absl::StrCat("face '", face.name, "' of part '",
                      known ? mesh.part_names[face.part] : absl::StrCat(face.part), "'");
}

absl::Status CheckFace(const mesh::TetrahedralMesh& mesh, const mesh::NamedFace& face,
                       bool free_only, const std::string& field) {
  if (!TrianglesOn(mesh, face, free_only).empty()) return absl::OkStatus();
  if (free_only && !TrianglesOn(mesh, face, false).empty()) {
    return InvalidField(field, absl::StrCat(FaceText(mesh, face),
                                            " is covered by other parts and cannot be loaded"));
  }
  return InvalidField(field, absl::StrCat("there is no ", FaceText(mesh, face)));
}

}  // namespace

std::vector<int> TrianglesOn(const mesh::TetrahedralMesh& mesh, const mesh::NamedFace& face,
                             bool free_only) {
  std::vector<bool> wanted(mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const mesh::AssemblyFace& candidate = mesh.faces[f];
    const bool free = candidate.front_part < 0 || candidate.back_part < 0;
    wanted[f] = (free || !free_only) &&
                std::find(candidate.origins.begin(), candidate.origins.end(), face) !=
                    candidate.origins.end();
  }
  std::vector<int> triangles;
  for (int t = 0; t < mesh.face_triangle_face.size(); ++t) {
    if (wanted[mesh.face_triangle_face[t]]) triangles.push_back(t);
  }
  return triangles;
}

absl::Status CheckCase(const AnalysisCase& analysis, const mesh::TetrahedralMesh& mesh) {
  if (analysis.materials.size() != mesh.part_names.size()) {
    return InvalidField("materials",
                        absl::StrCat("there are ", analysis.materials.size(), " materials for ",
                                     mesh.part_names.size(), " parts"));
  }
  for (std::size_t p = 0; p < analysis.materials.size(); ++p) {
    MORTISE_RETURN_IF_ERROR(
        CheckMaterial(analysis.materials[p], absl::StrCat("materials[", p, "]")));
  }
  for (std::size_t i = 0; i < analysis.supports.size(); ++i) {
    const Support& support = analysis.supports[i];
    const std::string field = absl::StrCat("supports[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckFace(mesh, support.face, false, field + ".face"));
    if (!support.displacement.allFinite()) {
      return InvalidField(field + ".displacement", "must be finite");
    }
  }
  for (std::size_t i = 0; i < analysis.forces.size(); ++i) {
    const std::string field = absl::StrCat("forces[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckFace(mesh, analysis.forces[i].face, true, field + ".face"));
    if (!analysis.forces[i].force.allFinite()) {
      return InvalidField(field + ".force", "must be finite");
    }
  }
  for (std::size_t i = 0; i < analysis.pressures.size(); ++i) {
    const std::string field = absl::StrCat("pressures[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckFace(mesh, analysis.pressures[i].face, true, field + ".face"));
    if (!std::isfinite(analysis.pressures[i].pressure)) {
      return InvalidField(field + ".pressure", "must be finite");
    }
  }
  if (!analysis.gravity.allFinite()) return InvalidField("gravity", "must be finite");
  return absl::OkStatus();
}

}  // namespace mortise::simulator
