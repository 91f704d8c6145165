// Adds up packed shapes: P(x) = Σ ψ_k(x) p_k (thesis (6.3)), straight out of the packed numbers.
#pragma once

#include <span>
#include <vector>

#include "absl/status/status.h"
#include "services/interpolator/shapes/canonical_mesh.h"
#include "services/interpolator/shapes/packed_shape.h"

namespace mortise::interpolator {

struct WeightedShape {
  const PackedShape* shape = nullptr;
  double weight = 0;  // ψ_k(x); any finite number
};

struct BlendedParts {
  bool surface_only = false;  // only the first `surface_nodes` nodes
  std::vector<int> fields;    // numbers of the canonical mesh's fields
};

// What is reused takes no memory anew.
struct BlendedShape {
  std::vector<float> positions;            // m: x, y, z of the first node, then the next
  std::vector<int> field_numbers;          // which fields,
  std::vector<std::vector<float>> fields;  // SI unit: all components of the first node, then …

  int node_count() const { return static_cast<int>(positions.size() / 3); }
};

// Blends shapes of one mesh (CheckFits), however many; those of weight 0 cost nothing. Beside what
// packing has changed, a number is off by the rounding of 32 bits: at most 1e-6 of
// Σ |weight| · largest size of a number in the shape. The same input gives the same bits on every
// processor.
//
// INVALID_ARGUMENT: "shapes" if there are none; "shapes[i].weight" where it is not finite;
// "shapes[i]" where its sizes are not those of the mesh; "fields[i]" for a number that the mesh has
// not, or a field of elements with surface_only.
absl::Status Blend(std::span<const WeightedShape> shapes, const CanonicalMesh& mesh,
                   const BlendedParts& parts, BlendedShape& out);

}  // namespace mortise::interpolator
