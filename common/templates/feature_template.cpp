#include "common/templates/feature_template.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/cad/solid_surface.h"
#include "common/templates/faceted_part.h"
#include "common/templates/features/feature_model.h"

namespace mortise::templates {
namespace {

class FeatureTemplate final : public Template {
 public:
  FeatureTemplate(TemplateHead head, cad::FeatureModel model, SolidIdentity identity)
      : Template(std::move(head)), model_(std::move(model)), identity_(std::move(identity)) {}

  bool MeshesAnew() const override { return true; }

  bool MayLeaveOut() const override {
    const std::vector<cad::Feature>& features = model_.definition().features;
    return Template::MayLeaveOut() ||
           std::any_of(features.begin(), features.end(),
                       [](const cad::Feature& feature) { return !feature.present.empty(); });
  }

 protected:
  absl::StatusOr<parametric::EvaluatedDesign> DesignAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(const cad::RegeneratedModel made, Regenerate(q));
    MORTISE_ASSIGN_OR_RETURN(mesh::AssemblySurface surface, cad::SurfaceOf(made.solid));
    parametric::FacetedShape shape;
    shape.surface = {std::move(surface.vertices), std::move(surface.triangles)};
    shape.triangle_face = std::move(surface.triangle_face);
    for (const std::vector<cad::FaceName>& origins : made.origins) {
      std::vector<std::string>& names = shape.face_names.emplace_back();
      for (const cad::FaceName& name : origins) names.push_back(cad::ToString(name));
    }
    parametric::EvaluatedDesign design =
        DesignOf(identity_, std::move(shape), made.conditions, made.solid.Volume());
    design.reference_temperature = made.reference_temperature;
    MORTISE_ASSIGN_OR_RETURN(design.structure, model_.StructureAt(q));
    return design;
  }

  absl::StatusOr<parametric::Structure> CountsAt(const Eigen::VectorXd& q) const override {
    return model_.StructureAt(q);
  }

  absl::StatusOr<std::vector<cad::Solid>> SolidsAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(cad::RegeneratedModel made, Regenerate(q));
    return std::vector<cad::Solid>{std::move(made.solid)};
  }

 private:
  struct Regenerated {
    Eigen::VectorXd q;
    cad::RegeneratedModel model;
  };

  // Who asks for a design mostly asks for its solid next, and regeneration takes most of either.
  absl::StatusOr<cad::RegeneratedModel> Regenerate(const Eigen::VectorXd& q) const {
    {
      const std::lock_guard lock(mutex_);
      if (last_ && last_->q == q) return last_->model;
    }
    MORTISE_ASSIGN_OR_RETURN(cad::RegeneratedModel made, model_.Regenerate(q));
    const std::lock_guard lock(mutex_);
    last_ = Regenerated{q, made};
    return made;
  }

  const cad::FeatureModel model_;
  const SolidIdentity identity_;
  mutable std::mutex mutex_;
  mutable std::optional<Regenerated> last_;  // guarded by mutex_
};

}  // namespace

absl::StatusOr<std::shared_ptr<const Template>> MakeFeatureTemplate(TemplateHead head,
                                                                    cad::CadTemplate definition) {
  head.title = definition.title;
  head.parameters = definition.parameters;
  absl::StatusOr<SolidIdentity> identity =
      IdentityOf(head, definition.name, definition.title, definition.material);
  absl::StatusOr<cad::FeatureModel> model = cad::FeatureModel::Create(std::move(definition));
  MORTISE_RETURN_IF_ERROR(CombineViolations(identity.status(), model.status()));
  return std::make_shared<const FeatureTemplate>(std::move(head), *std::move(model),
                                                 *std::move(identity));
}

}  // namespace mortise::templates
