#include "common/templates/faceted_part.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::templates {
namespace {

parametric::EvaluatedPart PartOf(const SolidIdentity& identity, parametric::FacetedShape shape,
                                 double volume) {
  parametric::EvaluatedPart part;
  part.name = PartName(identity);
  part.title = identity.title;
  part.material = identity.material;
  part.minimum = shape.surface.vertices.rowwise().minCoeff();
  part.maximum = shape.surface.vertices.rowwise().maxCoeff();
  part.size = part.maximum - part.minimum;
  part.volume = volume;
  part.mass = identity.density * volume;
  part.faceted = std::move(shape);
  return part;
}

}  // namespace

std::string PartName(const SolidIdentity& identity) {
  return identity.name.substr(identity.name.find('/') + 1);
}

absl::StatusOr<SolidIdentity> IdentityOf(const TemplateHead& head, std::string name,
                                         std::string title, std::string material) {
  const parametric::Material* const found = parametric::FindMaterial(head.materials, material);
  if (found == nullptr) return InvalidField("material", absl::StrCat("there is no ", material));
  return SolidIdentity{std::move(name), std::move(title), std::move(material), found->density};
}

parametric::EvaluatedDesign DesignOf(const SolidIdentity& identity, parametric::FacetedShape shape,
                                     const std::vector<parametric::FaceCondition>& conditions,
                                     double volume) {
  for (const parametric::FaceCondition& condition : conditions) {
    for (const int face : condition.faces) {
      shape.face_names[static_cast<std::size_t>(face)].push_back(
          absl::StrCat("condition:", condition.name));
    }
  }
  parametric::EvaluatedDesign design;
  design.parts.push_back(PartOf(identity, std::move(shape), volume));
  design.mass = design.parts[0].mass;
  for (const parametric::FaceCondition& condition : conditions) {
    parametric::EvaluatedBoundaryCondition& at = design.boundary_conditions.emplace_back();
    static_cast<parametric::ConditionNumbers&>(at) = condition;
    at.name = condition.name;
    at.kind = condition.kind;
    at.load_case = condition.load_case;
    if (!parametric::ActsOnFace(condition.kind)) continue;
    at.part = design.parts[0].name;
    at.face = absl::StrCat("condition:", condition.name);
  }
  return design;
}

}  // namespace mortise::templates
