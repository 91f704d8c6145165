// Makes designs that are one solid rather than an assembly of parts.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/design/face_condition.h"
#include "common/templates/template.h"

namespace mortise::templates {

// The name and the material of a solid.
struct SolidIdentity {
  std::string name;  // templates/{id}
  std::string title;
  std::string material;  // materials/{id}
  double density = 0;    // kg/m³
};

// Returns what its one part is called: as its template, without "templates/".
std::string PartName(const SolidIdentity& identity);

// Returns the identity of a template's solid, its density that of the material among the head's.
// INVALID_ARGUMENT, field "material", if there is none of that name.
absl::StatusOr<SolidIdentity> IdentityOf(const TemplateHead& head, std::string name,
                                         std::string title, std::string material);

// Returns the design of this shape alone, its part named as its template is. `volume`: m³, exact
// where the facets are not. Each condition acts on a face of its own that is called after it and is
// made of the faces of the shape that the condition lists.
parametric::EvaluatedDesign DesignOf(const SolidIdentity& identity, parametric::FacetedShape shape,
                                     const std::vector<parametric::FaceCondition>& conditions,
                                     double volume);

}  // namespace mortise::templates
