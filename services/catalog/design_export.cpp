// Colours parts by their material and hands them to the writers of common/cad.
#include "services/catalog/design_export.h"

#include "common/cad/glb_writer.h"
#include "common/cad/step_writer.h"
#include "common/parametric/evaluation.h"

namespace mortise::catalog {
namespace {

// What a material looks like, by a word in its name: linear red, green, blue.
Eigen::Vector3d MaterialColor(const std::string& material) {
  struct Look {
    const char* word;
    Eigen::Vector3d color;
  };
  static const Look kLooks[] = {
      {"spruce", {0.70, 0.50, 0.28}}, {"beech", {0.58, 0.36, 0.20}},
      {"oak", {0.42, 0.27, 0.13}},    {"plywood", {0.72, 0.56, 0.36}},
      {"steel", {0.33, 0.34, 0.36}},  {"aluminium", {0.55, 0.56, 0.58}},
  };
  for (const Look& look : kLooks) {
    if (material.find(look.word) != std::string::npos) return look.color;
  }
  return {0.5, 0.5, 0.5};
}

// Parts sawn from bars are a little darker, so that neighbours of one material can be told apart.
Eigen::Vector3d PartColor(const parametric::EvaluatedPart& part) {
  const Eigen::Vector3d color = MaterialColor(part.material);
  return part.process == parametric::Process::kChopSaw ? Eigen::Vector3d(0.8 * color) : color;
}

}  // namespace

absl::StatusOr<std::string> ExportStep(const parametric::EvaluatedDesign& design,
                                       const std::vector<cad::Solid>& solids,
                                       const std::string& assembly_name) {
  std::vector<cad::AssemblyPart> parts;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    parts.push_back({solids[i], PartColor(design.parts[i])});
  }
  return cad::WriteStep(assembly_name, parts);
}

std::vector<Eigen::Vector3d> PartColors(const parametric::EvaluatedDesign& design) {
  std::vector<Eigen::Vector3d> colors;
  for (const parametric::EvaluatedPart& part : design.parts) colors.push_back(PartColor(part));
  return colors;
}

absl::StatusOr<std::string> ExportGlb(const parametric::EvaluatedDesign& design,
                                      const std::string& assembly_name) {
  std::vector<cad::GlbPart> parts;
  for (const parametric::EvaluatedPart& part : design.parts) {
    parts.push_back({part.name, parametric::PartSurface(part), PartColor(part)});
  }
  return cad::WriteGlb(assembly_name, parts);
}

}  // namespace mortise::catalog
