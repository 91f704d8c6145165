// The file of a packed shape, for those who have its canonical mesh.
//
// It is compressed (zstd) behind a header with a SHA-256 checksum of all else in the file. What is
// compressed is, little-endian: origin and step of the positions, 6 f64; of each field minimum and
// step, 2 f64; then the numbers, first all x, y, z and then those of each field, component by
// component, of 16 bits: all lower bytes, then all higher ones. They are residuals: the number less
// the one of the node or element before; of positions first less the number that the canonical
// mesh's own node has, packed in its own box. As the mesh's nodes are sorted in space, and shapes
// are much like their canonical mesh, these are small; 0, −1, 1, −2 … are written as 0, 1, 2, 3 …
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "services/interpolator/shapes/canonical_mesh.h"
#include "services/interpolator/shapes/packed_shape.h"

namespace mortise::interpolator {

// Returns the file. The same shape gives the same bytes. INVALID_ARGUMENT as CheckFits.
absl::StatusOr<std::string> WriteShape(const PackedShape& shape, const CanonicalMesh& mesh);

// Reads a shape of the same canonical mesh, to the last bit as it was written. INVALID_ARGUMENT
// naming "shape.header" or "shape.checksum" for what is no such file, is cut short or changed, or
// of a version that is not known; "shape" where its size is that of another mesh's.
absl::StatusOr<PackedShape> ReadShape(std::string_view bytes, const CanonicalMesh& mesh);

}  // namespace mortise::interpolator
