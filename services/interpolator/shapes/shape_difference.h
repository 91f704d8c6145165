// Tells how far an interpolated design is off the true one: the errors of thesis §6.7 and
// Table 6.2.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fields/design_fields.h"
#include "services/interpolator/shapes/blend.h"
#include "services/interpolator/shapes/bring_into.h"
#include "services/interpolator/shapes/canonical_mesh.h"

namespace mortise::interpolator {

// Of the distances at many nodes, m, or of differences of a field, its SI unit.
struct Spread {
  double largest = 0;
  double of_99 = 0;  // the largest of the best 99 of 100 nodes
  double mean = 0;
};

struct ShapeDifference {
  // Distances of the interpolated surface's nodes from the true surface, and of the true surface's
  // nodes from the interpolated one (both sides of the Hausdorff distance),
  Spread to_truth, from_truth;
  Spread shape;     // and the larger of the two, figure by figure.
  double size = 0;  // m, diagonal of the true design's box: what to divide by
  // Of each field of the blended shape, in its order: |interpolated − true| at canonical nodes, or
  // elements, the true values being those brought into the mesh. Of vectors and tensors the length
  // of the difference; of tensors of six numbers, xx, yy, zz, xy, yz, xz, those off the diagonal
  // count twice (Frobenius).
  std::vector<Spread> fields;
};

// Compares a blended shape with the design that is truly there, whose surface is that of its
// 6-node triangles where they have so many: the four between their nodes. `truth_brought`: the same
// design in the canonical mesh, or nullptr to compare shapes alone, which leaves `fields` empty.
// Where the blended shape has surface nodes alone, so are those compared. INVALID_ARGUMENT as
// fields::Check, "truth"; "blended" and "truth_brought" where sizes are not those of the mesh.
// Fails as NearestPlaces, too.
absl::StatusOr<ShapeDifference> Difference(const BlendedShape& blended, const CanonicalMesh& mesh,
                                           const fields::DesignFields& truth,
                                           const ConsistentShape* truth_brought);

// Returns the spread of numbers, none of them negative; zeros if there are none. Reorders them.
Spread SpreadOf(std::vector<double>& numbers);

// The smallest and the largest number of a field in some shapes: what its errors are divided by.
struct FieldRange {
  double minimum = 0;  // SI unit; of vectors and tensors of all components together
  double maximum = 0;

  double length() const { return maximum - minimum; }
  void Include(const FieldRange& other);
};

// Returns the range of each field of a shape, in the canonical mesh's order.
std::vector<FieldRange> RangesOf(const ConsistentShape& shape);
std::vector<FieldRange> RangesOf(const PackedShape& shape);

}  // namespace mortise::interpolator
