// Colours parts by their material and hands them to the writers of common/cad.
#include "services/catalog/exchange/design_export.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/cad/glb_writer.h"
#include "common/cad/step/step_writer.h"
#include "common/design/evaluation.h"
#include "common/mesh/files/stl.h"
#include "common/mesh/joined_surface.h"

namespace mortise::catalog {
namespace {

// What a material looks like, by a word in its name: linear red, green, blue.
Eigen::Vector3d MaterialColor(const std::string& material) {
  struct Look {
    const char* word;
    Eigen::Vector3d color;
  };
  static const Look kLooks[] = {
      {"plywood", {0.72, 0.56, 0.36}},   {"spruce", {0.70, 0.50, 0.28}},
      {"pine", {0.70, 0.48, 0.25}},      {"fir", {0.60, 0.38, 0.19}},
      {"cedar", {0.38, 0.17, 0.08}},     {"beech", {0.58, 0.36, 0.20}},
      {"birch", {0.72, 0.54, 0.34}},     {"oak", {0.42, 0.27, 0.13}},
      {"hardboard", {0.27, 0.15, 0.08}}, {"particleboard", {0.58, 0.43, 0.26}},
      {"osb", {0.62, 0.43, 0.20}},       {"mdf", {0.48, 0.34, 0.21}},
      {"steel", {0.33, 0.34, 0.36}},     {"aluminium", {0.55, 0.56, 0.58}},
      {"zinc", {0.42, 0.43, 0.45}},      {"copper", {0.52, 0.21, 0.11}},
      {"rubber", {0.09, 0.09, 0.09}},    {"polyamide", {0.10, 0.10, 0.11}},
  };
  for (const Look& look : kLooks) {
    if (material.find(look.word) != std::string::npos) return look.color;
  }
  return {0.5, 0.5, 0.5};
}

// Parts sawn from bars are a little darker, so that neighbours of one material can be told apart.
Eigen::Vector3d PartColor(const parametric::EvaluatedPart& part) {
  if (part.color) return *part.color;
  const Eigen::Vector3d color = MaterialColor(part.material);
  return part.process == parametric::Process::kChopSaw ? Eigen::Vector3d(0.8 * color) : color;
}

std::string WriteObj(const std::vector<cad::GlbPart>& parts, const std::string& name) {
  std::string text = absl::StrCat("# ", name, ", metres, z upwards\n");
  Eigen::Index first = 1;
  for (const cad::GlbPart& part : parts) {
    absl::StrAppend(&text, "o ", part.name, "\n");
    for (const auto& vertex : part.surface.vertices.colwise()) {
      absl::StrAppendFormat(&text, "v %.9g %.9g %.9g\n", vertex.x(), vertex.y(), vertex.z());
    }
    for (const auto& corners : part.surface.triangles.colwise()) {
      absl::StrAppend(&text, "f ", first + corners[0], " ", first + corners[1], " ",
                      first + corners[2], "\n");
    }
    first += part.surface.vertices.cols();
  }
  return text;
}

mesh::SurfaceMesh SurfaceOf(const std::vector<cad::GlbPart>& parts) {
  std::vector<mesh::SurfaceView> surfaces;
  for (const cad::GlbPart& part : parts) surfaces.push_back(mesh::ViewOf(part.surface));
  return mesh::Joined(surfaces);
}

}  // namespace

absl::StatusOr<std::string> ExportStep(const parametric::EvaluatedDesign& design,
                                       const std::vector<cad::Solid>& solids,
                                       const std::string& assembly_name,
                                       const DesignIdentity& identity) {
  cad::StepAssembly assembly;
  assembly.name = assembly_name;
  assembly.identity = identity.whole;
  assembly.time_stamp = identity.time_stamp;
  assembly.groups.push_back({assembly_name, -1});
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const parametric::EvaluatedPart& part = design.parts[i];
    cad::StepPart placed;
    placed.name = solids[i].name();
    placed.product = static_cast<int>(i);
    assembly.parts.push_back(std::move(placed));
    cad::StepProduct product = {solids[i].name(), solids[i], PartColor(part)};
    product.identity = ProductIdentity(part, identity);
    assembly.products.push_back(std::move(product));
  }
  ShareNoIds(assembly.products);
  return cad::WriteStep(assembly);
}

std::vector<Eigen::Vector3d> PartColors(const parametric::EvaluatedDesign& design) {
  std::vector<Eigen::Vector3d> colors;
  for (const parametric::EvaluatedPart& part : design.parts) colors.push_back(PartColor(part));
  return colors;
}

absl::StatusOr<std::string> ExportMesh(const parametric::EvaluatedDesign& design,
                                       const std::vector<Eigen::Isometry3d>& motions,
                                       MeshFormat format, const std::string& assembly_name) {
  std::vector<cad::GlbPart> parts;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    const parametric::EvaluatedPart& part = design.parts[i];
    parts.push_back({part.name, parametric::PartSurface(part), PartColor(part)});
    if (motions.empty()) continue;
    Eigen::Matrix3Xd& vertices = parts.back().surface.vertices;
    vertices = (motions[i].linear() * vertices).colwise() + motions[i].translation();
  }
  switch (format) {
    case MeshFormat::kObj:
      return WriteObj(parts, assembly_name);
    case MeshFormat::kStl:
      return mesh::WriteStl(SurfaceOf(parts), assembly_name);
    default:
      return cad::WriteGlb(assembly_name, parts);
  }
}

}  // namespace mortise::catalog
