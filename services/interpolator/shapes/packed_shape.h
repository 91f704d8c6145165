// A shape in a canonical mesh in numbers of 16 bits: what maps keep, store and blend (blend.h).
//
// Coordinates are whole steps within the shape's own box, and the numbers of each field whole steps
// between its own smallest and largest one: value = origin + step · number, number 0 … 65535. So a
// coordinate is off by at most half a step, 7.7e-6 of the box's side along its axis, and a number
// of a field by at most 7.7e-6 of the field's range in this shape; a constant is exact.
//
// An element that is wider than PositionError × 2 in every direction keeps its orientation: each
// corner moves by at most PositionError, and to turn an element over all four corners must come
// into one plane. Thinner ones may be turned over or become flat: TurnedOver (bring_into.h) counts
// them in what Unpack returns.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "services/interpolator/shapes/bring_into.h"
#include "services/interpolator/shapes/canonical_mesh.h"

namespace mortise::interpolator {

struct PackedField {
  double minimum = 0;  // SI unit
  double step = 0;     // SI unit; 0 of a constant
  int components = 1;
  std::vector<std::uint16_t> numbers;  // all components of the first node or element, then the next

  double maximum() const { return minimum + 65535 * step; }
};

struct PackedShape {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // m, lowest corner of the box
  Eigen::Vector3d step = Eigen::Vector3d::Zero();    // m, along each axis; 0 where it is flat
  std::vector<std::uint16_t> positions;              // x, y, z of the first node, then the next
  std::vector<PackedField> fields;                   // in the canonical mesh's order

  // Returns what it takes in memory, bytes.
  std::int64_t ByteSize() const;
};

// Packs a shape. INVALID_ARGUMENT below "shape" where its numbers are not as many as the mesh's or
// not finite, or larger than 3.4e32, so that sums of them fit into 32 bits.
absl::StatusOr<PackedShape> Pack(const ConsistentShape& shape, const CanonicalMesh& mesh);

// Returns the places and values that the packed numbers stand for.
ConsistentShape Unpack(const PackedShape& shape);

// Fails with INVALID_ARGUMENT naming what is not of this mesh: "positions", "fields[1]".
absl::Status CheckFits(const PackedShape& shape, const CanonicalMesh& mesh);

// Returns how far packing can have moved a node, m: half the diagonal of a step.
double PositionError(const PackedShape& shape);

}  // namespace mortise::interpolator
