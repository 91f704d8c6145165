// The door to evaluation: parameter vectors in, designs and mass out.
#include "common/parametric/evaluation.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/parametric/compiled_template.h"
#include "common/parametric/design_evaluation.h"

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

VectorXd TemplateFunction::Defaults() const {
  VectorXd q(static_cast<Eigen::Index>(parameters().size()));
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    q(i) = parameters()[static_cast<std::size_t>(i)].default_value;
  }
  return q;
}

absl::StatusOr<VectorXd> TemplateFunction::Complete(const std::vector<NamedValue>& values) const {
  VectorXd q = Defaults();
  std::set<std::string> seen;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string field = absl::StrCat("parameters[", i, "]");
    const auto found =
        std::find_if(parameters().begin(), parameters().end(),
                     [&](const Parameter& entry) { return entry.name == values[i].name; });
    if (found == parameters().end()) {
      return InvalidField(absl::StrCat(field, ".name"),
                          absl::StrCat("there is no parameter '", values[i].name, "'"));
    }
    if (!seen.insert(values[i].name).second) {
      return InvalidField(absl::StrCat(field, ".name"),
                          absl::StrCat("'", values[i].name, "' is given twice"));
    }
    MORTISE_RETURN_IF_ERROR(
        CheckParameterValue(*found, values[i].value, absl::StrCat(field, ".value")));
    q(found - parameters().begin()) = values[i].value;
  }
  return q;
}

VectorXd TemplateFunction::RoundToSteps(const VectorXd& q) const {
  VectorXd rounded = q;
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(q.size(), Defaults().size()); ++i) {
    const Parameter& parameter = parameters()[static_cast<std::size_t>(i)];
    if (parameter.step > 0) rounded(i) = std::round(q(i) / parameter.step) * parameter.step;
    rounded(i) = std::clamp(rounded(i), parameter.minimum, parameter.maximum);
  }
  return rounded;
}

absl::StatusOr<EvaluatedDesign> TemplateFunction::Evaluate(const VectorXd& q) const {
  const TemplateDefinition& definition = compiled_->bundle.definition;
  MORTISE_RETURN_IF_ERROR(CheckParameterValues(definition.parameters, q));
  EvaluatedDesign design;
  design.template_name = definition.name;
  design.template_revision = definition.revision;
  design.template_digest = definition.digest;
  for (std::size_t i = 0; i < definition.parameters.size(); ++i) {
    design.parameters.push_back({definition.parameters[i].name, q(static_cast<Eigen::Index>(i))});
  }
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
  for (std::size_t i = 0; i < definition.boundary_conditions.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(EvaluatedBoundaryCondition condition,
                             EvaluateBoundaryCondition(*compiled_, i, q));
    design.boundary_conditions.push_back(std::move(condition));
  }
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
