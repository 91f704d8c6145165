// The door to evaluation: parameter vectors in, designs and mass out.
#include "common/design/evaluation.h"

#include <iterator>
#include <utility>

#include "common/base/errors.h"
#include "common/design/compiled_template.h"
#include "common/design/design_evaluation.h"
#include "common/design/parameter_values.h"

namespace mortise::parametric {

using Eigen::VectorXd;

TemplateFunction::TemplateFunction(std::shared_ptr<const CompiledTemplate> compiled)
    : compiled_(std::move(compiled)) {}

absl::StatusOr<TemplateFunction> TemplateFunction::Create(const TemplateBundle& bundle) {
  MORTISE_ASSIGN_OR_RETURN(CompiledTemplate compiled, CompileTemplate(bundle));
  return TemplateFunction(std::make_shared<const CompiledTemplate>(std::move(compiled)));
}

const TemplateBundle& TemplateFunction::bundle() const { return compiled_->bundle; }

const std::vector<Parameter>& TemplateFunction::parameters() const {
  return compiled_->bundle.definition.parameters;
}

VectorXd TemplateFunction::Defaults() const { return parametric::Defaults(parameters()); }

absl::StatusOr<VectorXd> TemplateFunction::CompleteParameters(
    const std::vector<NamedValue>& values) const {
  return parametric::CompleteParameters(parameters(), values);
}

VectorXd TemplateFunction::RoundToSteps(const VectorXd& q) const {
  return parametric::RoundToSteps(parameters(), q);
}

absl::StatusOr<EvaluatedDesign> TemplateFunction::Evaluate(const VectorXd& q) const {
  const TemplateDefinition& definition = compiled_->bundle.definition;
  MORTISE_RETURN_IF_ERROR(CheckParameterValues(definition.parameters, q));
  EvaluatedDesign design;
  design.template_name = definition.name;
  design.template_revision = definition.revision;
  design.template_digest = definition.digest;
  design.parameters = NamedValues(definition.parameters, q);
  for (std::size_t i = 0; i < definition.parts.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(EvaluatedPart part, EvaluatePart(*compiled_, i, q));
    design.mass += part.mass;
    design.parts.push_back(std::move(part));
  }
  for (std::size_t i = 0; i < definition.connections.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(std::vector<EvaluatedConnector> pegs,
                             EvaluateConnection(*compiled_, i, design.parts));
    std::move(pegs.begin(), pegs.end(), std::back_inserter(design.connectors));
  }
  for (std::size_t i = 0; i < compiled_->conditions.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(EvaluatedBoundaryCondition condition, compiled_->conditions.At(i, q));
    design.boundary_conditions.push_back(std::move(condition));
  }
  MORTISE_ASSIGN_OR_RETURN(design.reference_temperature,
                           compiled_->conditions.ReferenceTemperature(q));
  return design;
}

absl::StatusOr<MassProperties> TemplateFunction::EvaluateMass(const VectorXd& q) const {
  MORTISE_RETURN_IF_ERROR(CheckParameterValues(parameters(), q));
  MassProperties sum;
  sum.volume_gradient = VectorXd::Zero(q.size());
  sum.mass_gradient = VectorXd::Zero(q.size());
  for (const CompiledPart& part : compiled_->parts) {
    MORTISE_ASSIGN_OR_RETURN(const Dual volume, EvaluateVolume(part, q));
    sum.volume += volume.value;
    sum.mass += part.density * volume.value;
    sum.volume_gradient += volume.gradient;
    sum.mass_gradient += part.density * volume.gradient;
  }
  return sum;
}

}  // namespace mortise::parametric
