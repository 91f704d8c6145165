#include "common/templates/feature_template.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/feature_model.h"
#include "common/cad/solid_surface.h"
#include "common/templates/faceted_part.h"

namespace mortise::templates {
namespace {

parametric::BoundaryConditionKind KindOf(cad::ConditionKind kind) {
  switch (kind) {
    case cad::ConditionKind::kFixed:
      return parametric::BoundaryConditionKind::kFixed;
    case cad::ConditionKind::kForce:
      return parametric::BoundaryConditionKind::kForce;
    case cad::ConditionKind::kPressure:
      return parametric::BoundaryConditionKind::kPressure;
    case cad::ConditionKind::kHeatFlux:
      return parametric::BoundaryConditionKind::kHeatFlux;
    case cad::ConditionKind::kTemperature:
      return parametric::BoundaryConditionKind::kTemperature;
  }
  return parametric::BoundaryConditionKind::kFixed;
}

class FeatureTemplate final : public Template {
 public:
  FeatureTemplate(TemplateHead head, cad::FeatureModel model, double density)
      : Template(std::move(head)), model_(std::move(model)), density_(density) {}

 protected:
  absl::StatusOr<parametric::EvaluatedDesign> DesignAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(const cad::RegeneratedModel made, model_.Regenerate(q));
    MORTISE_ASSIGN_OR_RETURN(mesh::AssemblySurface surface, cad::SurfaceOf(made.solid));
    const cad::CadTemplate& definition = model_.definition();
    const std::string part = definition.name.substr(definition.name.find('/') + 1);
    parametric::FacetedShape shape;
    shape.surface = {std::move(surface.vertices), std::move(surface.triangles)};
    shape.triangle_face = std::move(surface.triangle_face);
    for (const std::vector<cad::FaceName>& origins : made.origins) {
      std::vector<std::string>& names = shape.face_names.emplace_back();
      for (const cad::FaceName& name : origins) names.push_back(cad::ToString(name));
    }
    parametric::EvaluatedDesign design;
    for (const cad::ModelCondition& condition : made.conditions) {
      for (const int face : condition.faces) {
        shape.face_names[static_cast<std::size_t>(face)].push_back(ConditionFace(condition.name));
      }
      design.boundary_conditions.push_back({.name = condition.name,
                                            .kind = KindOf(condition.kind),
                                            .part = part,
                                            .face = ConditionFace(condition.name),
                                            .force = condition.force,
                                            .pressure = condition.pressure,
                                            .heat_flux = condition.heat_flux,
                                            .temperature = condition.temperature});
    }
    design.parts.push_back(
        FacetedPart({definition.name, definition.title, definition.material, density_},
                    std::move(shape), made.solid.Volume()));
    design.mass = design.parts[0].mass;
    return design;
  }

  absl::StatusOr<std::vector<cad::Solid>> SolidsAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(cad::RegeneratedModel made, model_.Regenerate(q));
    return std::vector<cad::Solid>{std::move(made.solid)};
  }

 private:
  const cad::FeatureModel model_;
  const double density_;  // kg/m³
};

}  // namespace

absl::StatusOr<std::shared_ptr<const Template>> MakeFeatureTemplate(TemplateHead head,
                                                                    cad::CadTemplate definition) {
  head.title = definition.title;
  head.parameters = definition.parameters;
  const parametric::Material* const material =
      parametric::FindMaterial(head.materials, definition.material);
  if (material == nullptr) {
    return InvalidField("material", absl::StrCat("there is no ", definition.material));
  }
  const double density = material->density;
  MORTISE_ASSIGN_OR_RETURN(cad::FeatureModel model,
                           cad::FeatureModel::Create(std::move(definition)));
  return std::make_shared<const FeatureTemplate>(std::move(head), std::move(model), density);
}

}  // namespace mortise::templates
