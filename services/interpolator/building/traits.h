// A few places of shapes by which it is told along which parameters they bend: whole shapes are too
// large for fitting a model to each of their numbers. Private to this folder. Our own.
#pragma once

#include <vector>

#include "services/interpolator/shapes/bring_into.h"
#include "services/interpolator/shapes/canonical_mesh.h"

namespace mortise::interpolator {

// How many nodes, where there are as many.
inline constexpr int kTraitNodes = 32;

struct TraitPlaces {
  std::vector<int> nodes;     // of the surface, each as far as can be from those before
  std::vector<int> elements;  // a tetrahedron at each of them; none where there are no tetrahedra
};

// O(surface nodes · kTraitNodes + tetrahedra). The same mesh gives the same places.
TraitPlaces ChooseTraits(const CanonicalMesh& mesh);

// Returns the coordinates of the nodes, m, then of each field all components there, SI unit.
std::vector<float> TraitsOf(const ConsistentShape& shape, const CanonicalMesh& mesh,
                            const TraitPlaces& places);

}  // namespace mortise::interpolator
