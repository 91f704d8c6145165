// The file of a packed shape: a header with sizes and a SHA-256 checksum of all else in the file,
// then all numbers, compressed (zstd). Everything is little-endian. Before they are compressed,
// numbers of 16 bits are replaced by their differences from those of the node or element before,
// lower bytes apart from higher ones: as neighbours in space are near each other in the mesh's
// order, these are small and alike.
//
//   bytes  0–7   MORTISEP
//          8–11  u32 version, 1
//         12–15  u32 how many fields
//         16–23  u64 nodes
//         24–31  u64 bytes before compression
//         32–63  SHA-256 of bytes 0–31 and of all bytes from 64 on
//         64–    zstd: origin and step of the positions, 6 f64; of each field minimum and step,
//                2 f64, u32 components, u32 0, u64 how many numbers; then the numbers of positions
//                and of each field: all first bytes, then all second ones
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "services/interpolator/shapes/canonical_mesh.h"
#include "services/interpolator/shapes/packed_shape.h"

namespace mortise::interpolator {

// Returns the file. The same shape gives the same bytes.
absl::StatusOr<std::string> WriteShape(const PackedShape& shape);

// Reads a shape in a canonical mesh, to the last bit as it was written. INVALID_ARGUMENT naming
// "shape.header" or "shape.checksum" for what is no such file, is cut short or changed, or of a
// version that is not known; below "shape" where it is of another mesh.
absl::StatusOr<PackedShape> ReadShape(std::string_view bytes, const CanonicalMesh& mesh);

}  // namespace mortise::interpolator
