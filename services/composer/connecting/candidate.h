// A connection of another design that is to hold parts of a component and of the body of a model
// together.
#pragma once

#include <vector>

#include "common/assembly/connections/connection_optimizer.h"
#include "services/composer/connecting/part_connection.h"
#include "services/composer/model/placed_forms.h"

namespace mortise::composer {

// A part that stands for a principal of the connection.
struct BoundPrincipal {
  bool of_component = false;  // else of the body
  int part = 0;               // index into the component's, or body's, principal parts
};

struct Candidate {
  const CollectionConnection* from = nullptr;
  std::vector<BoundPrincipal> principals;  // in the order of the connection's elements
};

// The two sides of a model that are to be connected, as they are now.
struct BothSides {
  Design body, component;
  std::vector<PrincipalPart> body_parts, component_parts;

  const PrincipalPart& PartOf(const BoundPrincipal& bound) const {
    return (bound.of_component ? component_parts
                               : body_parts)[static_cast<std::size_t>(bound.part)];
  }
  std::vector<parametric::BoundingBox> BoxesOf(const Candidate& candidate) const {
    std::vector<parametric::BoundingBox> boxes;
    for (const BoundPrincipal& bound : candidate.principals) boxes.push_back(PartOf(bound).box);
    return boxes;
  }
};

// Returns both sides with their principal parts.
inline BothSides SidesOf(const Design& body, const Design& component) {
  return {body, component, PrincipalPartsOf(body), PrincipalPartsOf(component)};
}

}  // namespace mortise::composer
