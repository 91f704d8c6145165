#include "common/templates/parts_template.h"

#include <algorithm>
#include <utility>

#include "common/base/errors.h"
#include "common/design/evaluation.h"
#include "common/terrain/height_field.h"

namespace mortise::templates {
namespace {

class PartsTemplate final : public Template {
 public:
  PartsTemplate(TemplateHead head, parametric::TemplateFunction function)
      : Template(std::move(head)), function_(std::move(function)) {}

  bool OffersMassGradient() const override { return true; }

  bool MayLeaveOut() const override {
    const auto& parts = function_.bundle().definition.parts;
    return Template::MayLeaveOut() ||
           std::any_of(parts.begin(), parts.end(), [](const parametric::PartTemplate& part) {
             return !part.present.empty() || !part.repeat.empty() || !part.items.empty();
           });
  }

  std::size_t MemoryUse() const override {
    std::size_t bytes = Template::MemoryUse();
    for (const parametric::Ground& ground : function_.bundle().definition.grounds) {
      bytes += ground.heights->MemoryUse();
    }
    return bytes;
  }

  absl::StatusOr<parametric::MassProperties> Mass(const Eigen::VectorXd& q) const override {
    return function_.EvaluateMass(q);
  }

 protected:
  absl::StatusOr<parametric::EvaluatedDesign> DesignAt(const Eigen::VectorXd& q) const override {
    return function_.Evaluate(q);
  }

  // There may be no design at q; evaluating takes microseconds, a few milliseconds for thousands of
  // pegs.
  absl::StatusOr<parametric::Structure> CountsAt(const Eigen::VectorXd& q) const override {
    MORTISE_ASSIGN_OR_RETURN(parametric::EvaluatedDesign design, function_.Evaluate(q));
    return *std::move(design.structure);
  }

 private:
  const parametric::TemplateFunction function_;
};

}  // namespace

absl::StatusOr<std::shared_ptr<const Template>> MakePartsTemplate(
    const parametric::TemplateBundle& bundle) {
  MORTISE_ASSIGN_OR_RETURN(parametric::TemplateFunction function,
                           parametric::TemplateFunction::Create(bundle));
  const parametric::TemplateDefinition& definition = bundle.definition;
  TemplateHead head{definition.name,       definition.revision, definition.digest, definition.title,
                    definition.parameters, bundle.items,        bundle.materials};
  return std::make_shared<const PartsTemplate>(std::move(head), std::move(function));
}

}  // namespace mortise::templates
