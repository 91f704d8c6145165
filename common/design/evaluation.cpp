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

namespace {

void AddToStructure(const PartTemplate& definition, const PartCopies& copies,
                    Structure& structure) {
  if (!copies.is_present) {
    structure.absent_parts.push_back(definition.name);
    return;
  }
  if (!copies.numbers.empty()) structure.counts.push_back({definition.name, copies.numbers});
  if (!definition.items.empty()) structure.items.push_back({definition.name, copies.item});
}

absl::StatusOr<std::vector<PartCopies>> PartsAt(const CompiledTemplate& compiled,
                                                const VectorXd& q) {
  std::vector<PartCopies> all;
  std::size_t count = 0;
  for (std::size_t i = 0; i < compiled.parts.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(PartCopies copies, EvaluatePart(compiled, i, q));
    count += copies.parts.size();
    all.push_back(std::move(copies));
  }
  MORTISE_RETURN_IF_ERROR(CheckPartCount(count));
  return all;
}

absl::Status AddConnectors(const CompiledTemplate& compiled, const std::vector<PartCopies>& parts,
                           const VectorXd& q, EvaluatedDesign& design) {
  for (std::size_t i = 0; i < compiled.connections.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(std::vector<JoinedPair> pairs,
                             EvaluateConnection(compiled, i, parts, q));
    for (JoinedPair& pair : pairs) {
      std::move(pair.pegs.begin(), pair.pegs.end(), std::back_inserter(design.connectors));
    }
    MORTISE_RETURN_IF_ERROR(CheckPegCount(design.connectors.size()));
  }
  return absl::OkStatus();
}

absl::Status AddConditions(const CompiledTemplate& compiled, const std::vector<PartCopies>& parts,
                           const VectorXd& q, EvaluatedDesign& design) {
  for (std::size_t i = 0; i < compiled.conditions.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(auto conditions, EvaluateCondition(compiled, i, parts, q));
    if (!conditions) {
      design.structure->absent_conditions.push_back(
          compiled.bundle.definition.boundary_conditions[i].name);
      continue;
    }
    std::move(conditions->begin(), conditions->end(),
              std::back_inserter(design.boundary_conditions));
  }
  return absl::OkStatus();
}

}  // namespace

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
  design.structure.emplace().choices = ChosenAt(definition.parameters, q);
  MORTISE_ASSIGN_OR_RETURN(std::vector<PartCopies> copies, PartsAt(*compiled_, q));
  for (std::size_t i = 0; i < copies.size(); ++i) {
    AddToStructure(definition.parts[i], copies[i], *design.structure);
  }
  MORTISE_RETURN_IF_ERROR(AddConnectors(*compiled_, copies, q, design));
  MORTISE_RETURN_IF_ERROR(AddConditions(*compiled_, copies, q, design));
  for (PartCopies& part : copies) {
    for (EvaluatedPart& copy : part.parts) {
      design.mass += copy.mass;
      design.parts.push_back(std::move(copy));
    }
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
    MORTISE_ASSIGN_OR_RETURN(const PartMass mass, EvaluateMassOf(part, q));
    sum.volume += mass.volume.value;
    sum.mass += mass.density * mass.volume.value;
    sum.volume_gradient += mass.volume.gradient;
    sum.mass_gradient += mass.density * mass.volume.gradient;
  }
  return sum;
}

}  // namespace mortise::parametric
