// How much memory what is kept for reuse takes, so that caches can be bounded by bytes. Estimates:
// arrays are counted exactly, texts and tables by their usual size.
#pragma once

#include <cstddef>

namespace mortise::mesh {
struct DrawnShape;
}

namespace mortise::parametric {

class ParametricAssembly;

// Bytes. O(faces).
std::size_t MemoryUse(const mesh::DrawnShape& shape);

// Bytes, each shape that parts share once. O(parts + relationships + faces).
std::size_t MemoryUse(const ParametricAssembly& assembly);

}  // namespace mortise::parametric
