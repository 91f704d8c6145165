#include "common/fem/elements/analysis_case.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::simulator {
namespace {

constexpr char kNotFinite[] = "must be finite";

std::string FaceText(const mesh::TetrahedralMesh& mesh, const mesh::NamedFace& face) {
  const bool known = face.part >= 0 && face.part < static_cast<int>(mesh.part_names.size());
  return absl::StrCat("face '", face.name, "' of part '",
                      known ? mesh.part_names[face.part] : absl::StrCat(face.part), "'");
}

absl::Status CheckPlace(const mesh::TetrahedralMesh& mesh, const Support& support,
                        const std::string& field) {
  if (!support.face.name.empty()) return CheckFace(mesh, support.face, false, field + ".face");
  if (support.nodes.empty()) return InvalidField(field + ".face", "name a face, or nodes");
  if (support.symmetric) return InvalidField(field + ".symmetric", "needs a face, not nodes");
  for (const int node : support.nodes) {
    if (node >= 0 && node < mesh.nodes.cols()) continue;
    return InvalidField(field + ".nodes", absl::StrCat("there is no node ", node));
  }
  return absl::OkStatus();
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

absl::Status CheckFace(const mesh::TetrahedralMesh& mesh, const mesh::NamedFace& face,
                       bool free_only, const std::string& field) {
  if (!TrianglesOn(mesh, face, free_only).empty()) return absl::OkStatus();
  if (free_only && !TrianglesOn(mesh, face, false).empty()) {
    return InvalidField(field, absl::StrCat(FaceText(mesh, face),
                                            " is covered by other parts and cannot be loaded"));
  }
  return InvalidField(field, absl::StrCat("there is no ", FaceText(mesh, face)));
}

absl::Status CheckModel(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                        const std::vector<Support>& supports) {
  if (materials.size() != mesh.part_names.size()) {
    return InvalidField("materials", absl::StrCat("there are ", materials.size(), " materials for ",
                                                  mesh.part_names.size(), " parts"));
  }
  for (std::size_t p = 0; p < materials.size(); ++p) {
    MORTISE_RETURN_IF_ERROR(CheckMaterial(materials[p], absl::StrCat("materials[", p, "]")));
  }
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const std::string field = absl::StrCat("supports[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckPlace(mesh, supports[i], field));
    if (!supports[i].displacement.allFinite()) {
      return InvalidField(field + ".displacement", "must be finite");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckLoads(const mesh::TetrahedralMesh& mesh, const LoadCase& loads) {
  for (std::size_t i = 0; i < loads.forces.size(); ++i) {
    const std::string field = absl::StrCat("forces[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckFace(mesh, loads.forces[i].face, true, field + ".face"));
    if (!loads.forces[i].force.allFinite()) return InvalidField(field + ".force", kNotFinite);
  }
  for (std::size_t i = 0; i < loads.pressures.size(); ++i) {
    const std::string field = absl::StrCat("pressures[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckFace(mesh, loads.pressures[i].face, true, field + ".face"));
    if (!std::isfinite(loads.pressures[i].pressure)) {
      return InvalidField(field + ".pressure", kNotFinite);
    }
  }
  for (std::size_t i = 0; i < loads.tractions.size(); ++i) {
    const std::string field = absl::StrCat("tractions[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckFace(mesh, loads.tractions[i].face, true, field + ".face"));
    if (!loads.tractions[i].traction) return InvalidField(field + ".traction", "is missing");
  }
  for (std::size_t i = 0; i < loads.point_forces.size(); ++i) {
    const std::string field = absl::StrCat("point_forces[", i, "]");
    if (!loads.point_forces[i].position.allFinite()) {
      return InvalidField(field + ".position", kNotFinite);
    }
    if (!loads.point_forces[i].force.allFinite()) return InvalidField(field + ".force", kNotFinite);
  }
  for (std::size_t i = 0; i < loads.nodal_forces.size(); ++i) {
    const std::string field = absl::StrCat("nodal_forces[", i, "]");
    if (loads.nodal_forces[i].node < 0 || loads.nodal_forces[i].node >= mesh.nodes.cols()) {
      return InvalidField(field + ".node", "there is no such node");
    }
    if (!loads.nodal_forces[i].force.allFinite()) return InvalidField(field + ".force", kNotFinite);
  }
  if (!loads.gravity.allFinite()) return InvalidField("gravity", kNotFinite);
  if (loads.rotation &&
      !(loads.rotation->point.allFinite() && loads.rotation->angular_velocity.allFinite())) {
    return InvalidField("rotation", kNotFinite);
  }
  if (loads.temperature.size() != 0 && loads.temperature.size() != mesh.nodes.cols()) {
    return InvalidField("temperature",
                        absl::StrCat("there are ", loads.temperature.size(), " temperatures for ",
                                     mesh.nodes.cols(), " nodes"));
  }
  if (!loads.temperature.allFinite()) return InvalidField("temperature", kNotFinite);
  return absl::OkStatus();
}

}  // namespace mortise::simulator
