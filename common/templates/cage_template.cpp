#include "common/templates/cage_template.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/cad/faceted_solid.h"
#include "common/templates/cage/cage_model.h"
#include "common/templates/faceted_part.h"

namespace mortise::templates {
namespace {

class CagedMesh final : public Template {
 public:
  CagedMesh(TemplateHead head, parametric::CageModel model, SolidIdentity identity)
      : Template(std::move(head)), model_(std::move(model)), identity_(std::move(identity)) {}

  bool OffersMassGradient() const override { return true; }

  absl::StatusOr<parametric::MassProperties> Mass(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(const parametric::Dual volume, model_.Volume(q));
    const double density = identity_.density;
    return parametric::MassProperties{volume.value, density * volume.value, volume.gradient,
                                      density * volume.gradient};
  }

  // The coordinates are dense; what else a model has of its surface is less.
  std::size_t MemoryUse() const override {
    return Template::MemoryUse() +
           2 * static_cast<std::size_t>(model_.coordinates().size()) * sizeof(double);
  }

  bool HasExactSurfaces() const override { return false; }

 protected:
  absl::StatusOr<parametric::EvaluatedDesign> DesignAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(parametric::CageDesign made, model_.Evaluate(q));
    MORTISE_ASSIGN_OR_RETURN(const parametric::Dual volume, model_.Volume(q));
    parametric::FacetedShape shape{std::move(made.surface), std::move(made.triangle_face), {}};
    for (std::string& name : made.face_names) shape.face_names.push_back({std::move(name)});
    parametric::EvaluatedDesign design =
        DesignOf(identity_, std::move(shape), made.conditions, volume.value);
    design.reference_temperature = made.reference_temperature;
    design.structure.emplace().absent_conditions = std::move(made.absent_conditions);
    return design;
  }

  // Nothing is counted, but there may be no design at q.
  absl::StatusOr<parametric::Structure> CountsAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(parametric::CageDesign made, model_.Evaluate(q));
    parametric::Structure structure;
    structure.absent_conditions = std::move(made.absent_conditions);
    return structure;
  }

  absl::StatusOr<std::vector<cad::Solid>> SolidsAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(const parametric::CageDesign made, model_.Evaluate(q));
    absl::StatusOr<cad::Solid> solid =
        cad::FacetedSolid(made.surface, made.triangle_face, made.face_names, PartName(identity_));
    if (!solid.ok()) return NoSolid(std::string(solid.status().message()));
    if (!cad::IsSound(*solid)) {
      return NoSolid("shape: the kernel finds faces that cross each other");
    }
    return std::vector<cad::Solid>{*std::move(solid)};
  }

 private:
  absl::Status NoSolid(const std::string& why) const {
    return PreconditionFailed(
        "NO_SOLID",
        absl::StrCat("the mesh in its cage cannot be written as exact surfaces (", why,
                     "): ask for GLB, OBJ or STL"),
        head().name);
  }

  const parametric::CageModel model_;
  const SolidIdentity identity_;
};

}  // namespace

absl::StatusOr<std::shared_ptr<const Template>> MakeCageTemplate(
    TemplateHead head, parametric::CageTemplate definition) {
  head.title = definition.title;
  head.parameters = definition.parameters;
  absl::StatusOr<SolidIdentity> identity =
      IdentityOf(head, definition.name, definition.title, definition.material);
  absl::StatusOr<parametric::CageModel> model =
      parametric::CageModel::Create(std::move(definition));
  MORTISE_RETURN_IF_ERROR(CombineViolations(identity.status(), model.status()));
  return std::make_shared<const CagedMesh>(std::move(head), *std::move(model),
                                           *std::move(identity));
}

}  // namespace mortise::templates
