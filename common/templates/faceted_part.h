// The one part of designs that are no assemblies of prisms.
#pragma once

#include <string>

#include "common/parametric/evaluated_design.h"

namespace mortise::templates {

// What a solid is called and made of.
struct SolidIdentity {
  std::string name;  // templates/{id}
  std::string title;
  std::string material;  // materials/{id}
  double density = 0;    // kg/m³
};

// The part of this shape, named as its template is. `volume`: m³, exact where the facets are not.
parametric::EvaluatedPart FacetedPart(const SolidIdentity& identity, parametric::FacetedShape shape,
                                      double volume);

// The name of the face on which a condition acts: all its faces together.
std::string ConditionFace(const std::string& condition);

}  // namespace mortise::templates
