// Estimates how much memory the things take that are kept for reuse, so that caches can be bounded
// by bytes. Arrays are counted exactly, texts and tables by their usual size.
#pragma once

#include <cstddef>

namespace mortise::mesh {
struct DrawnShape;
}

namespace mortise::parametric {

class ParametricAssembly;

// Returns the bytes that a shape takes. O(faces).
std::size_t MemoryUse(const mesh::DrawnShape& shape);

// Returns the bytes that an assembly takes. A shape that parts share counts once. O(parts +
// relationships + faces).
std::size_t MemoryUse(const ParametricAssembly& assembly);

}  // namespace mortise::parametric
