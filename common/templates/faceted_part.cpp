#include "common/templates/faceted_part.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace mortise::templates {

parametric::EvaluatedPart FacetedPart(const SolidIdentity& identity, parametric::FacetedShape shape,
                                      double volume) {
  parametric::EvaluatedPart part;
  part.name = identity.name.substr(identity.name.find('/') + 1);
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

std::string ConditionFace(const std::string& condition) {
  return absl::StrCat("condition:", condition);
}

}  // namespace mortise::templates
