// Finds which parts of a component and of the body of a model are to be held together: linked
// elements (thesis §5.6), part by part.
#pragma once

#include <vector>

#include "services/composer/model/placed_forms.h"

namespace mortise::composer {

struct LinkedPair {
  int body = 0;       // index into the body's parts
  int component = 0;  // index into the component's
  // m, between their boxes along the axis across which they face each other; less than 0 if they
  // reach into each other.
  double apart = 0;
};

// Returns the pairs whose boxes are no further apart than `distance`, m, along one axis, and share
// some of their extent, more than `least`, m, along the two others; the nearest first, then by
// index. O(parts · parts).
std::vector<LinkedPair> FindLinkedParts(const std::vector<PrincipalPart>& body,
                                        const std::vector<PrincipalPart>& component,
                                        double distance, double least);

// Returns the two parts that are least apart (DistanceBetween), the first of such by index; there
// is at least one of each. O(parts · parts).
LinkedPair NearestParts(const std::vector<PrincipalPart>& body,
                        const std::vector<PrincipalPart>& component);

}  // namespace mortise::composer
