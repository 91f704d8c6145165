#include "common/templates/analysis_needs.h"

#include <algorithm>

#include "common/design/boundary_condition.h"

namespace mortise::templates {
namespace {

// What of conditions a template has.
struct Conditions {
  bool supports = false;
  bool loads = false;
  bool heat = false;

  void Add(parametric::BoundaryConditionKind kind) {
    supports = supports || parametric::IsSupport(kind);
    loads = loads || parametric::IsLoad(kind);
    heat = heat || parametric::IsHeat(kind);
  }

  // Of a feature of a CAD template, or a condition of a cage, which name kinds alike.
  template <typename Message>
  void AddKindOf(const Message& message) {
    supports =
        supports || message.has_fixed() || message.has_symmetric() || message.has_displacement();
    loads = loads || message.has_force() || message.has_pressure() || message.has_gravity() ||
            message.has_rotation();
    heat = heat || message.has_heat();
  }
};

Conditions ConditionsIn(const v1::Template& message) {
  Conditions conditions;
  for (const v1::BoundaryCondition& condition : message.boundary_conditions()) {
    if (condition.kind() == v1::BoundaryCondition::KIND_UNSPECIFIED) continue;
    conditions.Add(static_cast<parametric::BoundaryConditionKind>(condition.kind()));
  }
  for (const v1::Feature& feature : message.cad().features()) conditions.AddKindOf(feature);
  for (const v1::CageCondition& condition : message.cage().conditions()) {
    conditions.AddKindOf(condition);
  }
  return conditions;
}

// Whether something that bears is made of nothing that anybody knows.
bool LacksMaterial(const v1::TemplateBundle& bundle) {
  const v1::Template& message = bundle.template_();
  if (message.has_cad()) return message.cad().material().empty();
  if (message.has_cage()) return message.cage().material().empty();
  const auto is_of_nothing = [](const v1::AssemblyPart& part) {
    return part.item().empty() && part.role() != v1::AssemblyPart::CONNECTING;
  };
  return std::any_of(bundle.assembly().parts().begin(), bundle.assembly().parts().end(),
                     is_of_nothing);
}

}  // namespace

std::vector<std::string> AnalysisLacks(const v1::TemplateBundle& bundle) {
  const Conditions conditions = ConditionsIn(bundle.template_());
  std::vector<std::string> lacks;
  if (!conditions.supports && !conditions.heat) lacks.emplace_back("supports");
  if (!conditions.loads && !conditions.heat) lacks.emplace_back("loads");
  if (LacksMaterial(bundle)) lacks.emplace_back("materials");
  return lacks;
}

}  // namespace mortise::templates
