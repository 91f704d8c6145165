#include "services/simulator/template_model.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/assembly_surface.h"
#include "common/parametric/part_shapes.h"

namespace mortise::simulator {
namespace {

absl::StatusOr<Material> MaterialOf(const parametric::TemplateBundle& bundle,
                                    const parametric::EvaluatedPart& part, std::size_t index) {
  const std::string field = absl::StrCat("parts[", index, "].item");
  const parametric::Item* item = parametric::FindItem(bundle.items, part.item);
  if (item == nullptr) return InvalidField(field, absl::StrCat("there is no ", part.item));
  const parametric::Material* material = parametric::FindMaterial(bundle.materials, item->material);
  if (material == nullptr) return InvalidField(field, absl::StrCat("there is no ", item->material));
  return Material{material->name, material->density, material->youngs_modulus,
                  material->poissons_ratio, material->strength};
}

absl::Status AddCondition(const parametric::EvaluatedDesign& design, std::size_t index,
                          AnalysisCase& analysis) {
  const parametric::EvaluatedBoundaryCondition& condition = design.boundary_conditions[index];
  const mesh::NamedFace face{parametric::FindPart(design, condition.part), condition.face};
  if (face.part < 0) {
    return InvalidField(absl::StrCat("boundary_conditions[", index, "].part"),
                        absl::StrCat("there is no part '", condition.part, "'"));
  }
  switch (condition.kind) {
    case parametric::BoundaryConditionKind::kFixed:
      analysis.supports.push_back({face});
      break;
    case parametric::BoundaryConditionKind::kForce:
      analysis.forces.push_back({face, condition.force});
      break;
    case parametric::BoundaryConditionKind::kPressure:
      analysis.pressures.push_back({face, condition.pressure});
      break;
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<DesignModel> MakeDesignModel(const parametric::TemplateBundle& bundle,
                                            const parametric::EvaluatedDesign& design) {
  DesignModel model;
  MORTISE_ASSIGN_OR_RETURN(model.surface, cad::FuseAssembly(parametric::PartShapes(design)));
  for (std::size_t p = 0; p < design.parts.size(); ++p) {
    MORTISE_ASSIGN_OR_RETURN(Material material, MaterialOf(bundle, design.parts[p], p));
    model.analysis.materials.push_back(std::move(material));
  }
  for (std::size_t i = 0; i < design.boundary_conditions.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(AddCondition(design, i, model.analysis));
  }
  return model;
}

bool OffersGradient(const std::string& metric) { return metric == "mass" || metric == "volume"; }

absl::StatusOr<std::vector<MetricGradient>> MetricGradients(
    const parametric::TemplateFunction& function, const Eigen::VectorXd& parameters,
    const std::vector<std::string>& metrics) {
  std::vector<MetricGradient> gradients;
  for (const std::string& metric : metrics) {
    if (!OffersGradient(metric)) continue;
    MORTISE_ASSIGN_OR_RETURN(const parametric::MassProperties mass,
                             function.EvaluateMass(parameters));
    gradients.push_back({metric, metric == "mass" ? mass.mass_gradient : mass.volume_gradient});
  }
  return gradients;
}

}  // namespace mortise::simulator
