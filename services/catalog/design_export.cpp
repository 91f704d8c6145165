// Colours parts by their material and hands them to the writers of common/cad.
#include "services/catalog/design_export.h"

#include <vector>

#include "common/base/errors.h"
#include "common/cad/glb_writer.h"
#include "common/cad/step_writer.h"
#include "common/parametric/evaluation.h"
#include "common/parametric/part_shapes.h"

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
Eigen::Vector3d PartColor(const parametric::TemplateBundle& bundle,
                          const parametric::EvaluatedPart& part) {
  const parametric::Item* item = parametric::FindItem(bundle.items, part.item);
  const Eigen::Vector3d color = MaterialColor(item == nullptr ? "" : item->material);
  return part.process == parametric::Process::kChopSaw ? Eigen::Vector3d(0.8 * color) : color;
}

}  // namespace

absl::StatusOr<std::string> ExportStep(const parametric::EvaluatedDesign& design,
                                       const parametric::TemplateBundle& bundle,
                                       const std::string& assembly_name) {
  std::vector<cad::AssemblyPart> parts;
  const std::vector<cad::PartShape> shapes = parametric::PartShapes(design);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(cad::Solid solid, cad::Solid::FromPart(shapes[i]));
    parts.push_back({std::move(solid), PartColor(bundle, design.parts[i])});
  }
  return cad::WriteStep(assembly_name, parts);
}

absl::StatusOr<std::string> ExportGlb(const parametric::EvaluatedDesign& design,
                                      const parametric::TemplateBundle& bundle,
                                      const std::string& assembly_name) {
  std::vector<cad::GlbPart> parts;
  for (const parametric::EvaluatedPart& part : design.parts) {
    parts.push_back({part.name, parametric::PartSurface(part), PartColor(bundle, part)});
  }
  return cad::WriteGlb(assembly_name, parts);
}

}  // namespace mortise::catalog
