// Finds parts of the body and of the component that reach into each other.
#pragma once

#include <string>
#include <vector>

#include "services/composer/connecting/candidate.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {

struct SideOverlap {
  std::string body;       // a part of the body
  std::string component;  // a part of the component
  double depth = 0;       // m, more than kMaxOverlap (overlap.h)
};

// Returns all pairs of parts, one of each side, that reach into each other. They come in the order
// of the body's parts, then of the component's. O(parts of the body · parts of the component) where
// boxes are apart.
std::vector<SideOverlap> OverlapsBetween(const std::vector<SolidPart>& body,
                                         const std::vector<SolidPart>& component);

// Returns those that none of `connections` has so.
std::vector<SideOverlap> Unwanted(const std::vector<SideOverlap>& overlaps, const BothSides& sides,
                                  const std::vector<Candidate>& connections);

// Returns those of `after` that are not among `before`, or are deeper by more than kMaxOverlap.
std::vector<SideOverlap> NewOverlaps(const std::vector<SideOverlap>& before,
                                     const std::vector<SideOverlap>& after);

// Says an overlap for people: "'shelf' reaches 2 mm into 'side' of the model".
std::string Describe(const SideOverlap& overlap);

}  // namespace mortise::composer
