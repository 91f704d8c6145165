#include "common/templates/template.h"

#include <algorithm>
#include <utility>

#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/design/part_shapes.h"

namespace mortise::templates {

absl::StatusOr<parametric::EvaluatedDesign> Template::Evaluate(const Eigen::VectorXd& q) const {
  MORTISE_RETURN_IF_ERROR(parametric::CheckParameterValues(head_.parameters, q));
  MORTISE_ASSIGN_OR_RETURN(parametric::EvaluatedDesign design, DesignAt(q));
  design.template_name = head_.name;
  design.template_revision = head_.revision;
  design.template_digest = head_.digest;
  design.parameters = parametric::NamedValues(head_.parameters, q);
  if (!design.structure) design.structure.emplace();
  design.structure->choices = parametric::ChosenAt(head_.parameters, q);
  return design;
}

absl::StatusOr<parametric::Structure> Template::StructureAt(const Eigen::VectorXd& q) const {
  MORTISE_RETURN_IF_ERROR(parametric::CheckParameterValues(head_.parameters, q));
  MORTISE_ASSIGN_OR_RETURN(parametric::Structure structure, CountsAt(q));
  structure.choices = parametric::ChosenAt(head_.parameters, q);
  return structure;
}

bool Template::MayLeaveOut() const {
  return std::any_of(head_.parameters.begin(), head_.parameters.end(),
                     [](const parametric::Parameter& parameter) { return parameter.IsChoice(); });
}

absl::StatusOr<std::vector<cad::Solid>> Template::Solids(const Eigen::VectorXd& q) const {
  MORTISE_RETURN_IF_ERROR(parametric::CheckParameterValues(head_.parameters, q));
  return SolidsAt(q);
}

absl::StatusOr<std::optional<Template::AssemblyDesign>> Template::AssemblyAt(
    const Eigen::VectorXd& q) const {
  MORTISE_RETURN_IF_ERROR(parametric::CheckParameterValues(head_.parameters, q));
  return AssemblyDesignAt(q);
}

absl::StatusOr<std::optional<Template::AssemblyDesign>> Template::AssemblyDesignAt(
    const Eigen::VectorXd&) const {
  return std::optional<AssemblyDesign>();
}

absl::StatusOr<Template::ParameterLimits> Template::LimitsAmongParameters() const {
  const auto count = static_cast<Eigen::Index>(head_.parameters.size());
  return ParameterLimits{Eigen::MatrixXd(0, count), Eigen::VectorXd(0)};
}

absl::StatusOr<parametric::MassProperties> Template::Mass(const Eigen::VectorXd&) const {
  return PreconditionFailed("NO_GRADIENT", "the mass of this kind of template has no gradient",
                            head_.name);
}

std::size_t Template::MemoryUse() const {
  constexpr std::size_t kItem = 4096, kMaterial = 1024, kParameter = 512;  // bytes, texts included
  constexpr std::size_t kDefinition = std::size_t{64} << 10;  // expressions, features, conditions
  return kDefinition + head_.items.size() * kItem + head_.materials.size() * kMaterial +
         head_.parameters.size() * kParameter;
}

absl::StatusOr<std::vector<cad::Solid>> Template::SolidsAt(const Eigen::VectorXd& q) const {
  MORTISE_ASSIGN_OR_RETURN(const parametric::EvaluatedDesign design, DesignAt(q));
  return SolidsOf(design);
}

absl::StatusOr<std::vector<cad::Solid>> SolidsOf(const parametric::EvaluatedDesign& design) {
  std::vector<cad::Solid> solids;
  for (const mesh::PartShape& shape : parametric::PartShapes(design)) {
    MORTISE_ASSIGN_OR_RETURN(cad::Solid solid, cad::Solid::FromPart(shape));
    solids.push_back(std::move(solid));
  }
  return solids;
}

}  // namespace mortise::templates
