#include "common/templates/cage_template.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/parametric/cage_model.h"
#include "common/templates/faceted_part.h"

namespace mortise::templates {
namespace {

using parametric::BoundaryConditionKind;
using parametric::CageConditionKind;

BoundaryConditionKind KindOf(CageConditionKind kind) {
  switch (kind) {
    case CageConditionKind::kFixed:
      return BoundaryConditionKind::kFixed;
    case CageConditionKind::kForce:
      return BoundaryConditionKind::kForce;
    case CageConditionKind::kPressure:
      return BoundaryConditionKind::kPressure;
    case CageConditionKind::kHeatFlux:
      return BoundaryConditionKind::kHeatFlux;
    case CageConditionKind::kTemperature:
      return BoundaryConditionKind::kTemperature;
  }
  return BoundaryConditionKind::kFixed;
}

class CagedMesh final : public Template {
 public:
  CagedMesh(TemplateHead head, parametric::CageModel model, double density)
      : Template(std::move(head)), model_(std::move(model)), density_(density) {}

  bool OffersMassGradient() const override { return true; }

  absl::StatusOr<parametric::MassProperties> Mass(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(const parametric::Dual volume, model_.Volume(q));
    return parametric::MassProperties{volume.value, density_ * volume.value, volume.gradient,
                                      density_ * volume.gradient};
  }

 protected:
  absl::StatusOr<parametric::EvaluatedDesign> DesignAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(parametric::CageDesign made, model_.Evaluate(q));
    MORTISE_ASSIGN_OR_RETURN(const parametric::Dual volume, model_.Volume(q));
    const parametric::CageTemplate& definition = model_.definition();
    parametric::FacetedShape shape{std::move(made.surface), std::move(made.triangle_face), {}};
    for (std::string& name : made.face_names) shape.face_names.push_back({std::move(name)});
    parametric::EvaluatedDesign design;
    const std::string part = definition.name.substr(definition.name.find('/') + 1);
    for (const parametric::CageDesignCondition& condition : made.conditions) {
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
                    std::move(shape), volume.value));
    design.mass = design.parts[0].mass;
    return design;
  }

  absl::StatusOr<std::vector<cad::Solid>> SolidsAt(const Eigen::VectorXd&) const override {
    return PreconditionFailed("NO_SOLID",
                              "a mesh in a cage has no boundary representation: "
                              "ask for GLB",
                              head().name);
  }

 private:
  const parametric::CageModel model_;
  const double density_;  // kg/m³
};

}  // namespace

absl::StatusOr<std::shared_ptr<const Template>> MakeCageTemplate(
    TemplateHead head, parametric::CageTemplate definition) {
  head.title = definition.title;
  head.parameters = definition.parameters;
  const parametric::Material* const material =
      parametric::FindMaterial(head.materials, definition.material);
  if (material == nullptr) {
    return InvalidField("material", absl::StrCat("there is no ", definition.material));
  }
  const double density = material->density;
  MORTISE_ASSIGN_OR_RETURN(parametric::CageModel model,
                           parametric::CageModel::Create(std::move(definition)));
  return std::make_shared<const CagedMesh>(std::move(head), std::move(model), density);
}

}  // namespace mortise::templates
