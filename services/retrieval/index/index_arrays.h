// The flat arrays that an index is: what is kept in memory, and written to files as it is.
//
// Whoever changes a struct here changes the file's format: raise kIndexVersion in index_file.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace mortise::retrieval {

// The sizes of all arrays.
struct IndexSizes {
  std::int64_t dimension = 0;  // N
  std::int64_t leading = 0;    // d <= N: leading principal components that bounds are taken from
  std::int64_t families = 0;
  std::int64_t primitives = 0;
  std::int64_t nodes = 0;
  std::int64_t vectors = 0;     // numbers in IndexArrays::vectors
  std::int64_t radii = 0;       // numbers in IndexArrays::radii
  std::int64_t parameters = 0;  // numbers in IndexArrays::parameters
};

// A primitive: where its numbers begin.
struct PrimitiveEntry {
  std::int64_t vectors = 0;     // N for the centre, then N for each axis
  std::int64_t radii = 0;       // one an axis
  std::int64_t parameters = 0;  // K
  std::int32_t axes = 0;
  std::int32_t parameter_count = 0;
  std::int32_t family = 0;  // a place in IndexArrays::families
  std::int32_t number = 0;  // its place in the family's cover
  std::int32_t structure = 0;
  // A place in IndexArrays::primitives: the first of its group, which are those of a leaf that
  // follow each other and are nearly the same but for where their centres are.
  std::int32_t representative = 0;
};

// How far a primitive's centre lies from that of the first of its group.
struct DriftEntry {
  std::array<float, 16> leading = {};  // along the first components, 0 where there are fewer
  float rest = 0;                      // length of what is beside these
  float misfit = 0;  // how far the primitive, moved there, reaches out of the first one's box
  float reach = 0;   // of the first of a group: no other's place is further from its box
  float unused = 0;  // 0
};

// A node of the tree: primitives first … last - 1, and its two children; a leaf has none (-1).
struct NodeEntry {
  std::int32_t first = 0;
  std::int32_t last = 0;
  std::int32_t left = -1;
  std::int32_t right = -1;
  std::int32_t family = -1;  // a place in IndexArrays::families if all are of that one
  std::int32_t unused = 0;   // 0
};

// Bounds live in the space of d leading components and what is left, the length of the rest:
// d + 1 numbers, whose distances are never longer than those of the descriptors.
struct IndexArrays {
  IndexSizes sizes;
  std::span<const double> mean;            // N
  std::span<const double> components;      // N × d, by columns
  std::span<const std::int32_t> families;  // the callers' numbers, ascending
  std::span<const PrimitiveEntry> primitives;
  std::span<const float> vectors;
  std::span<const double> radii;
  std::span<const double> parameters;
  std::span<const double> places;  // (d + 2) a primitive: its centre's place, its largest radius
  // (d + 1) an axis, in the order of radii: its part along the components, the length of the rest.
  std::span<const double> leading_axes;
  std::span<const DriftEntry> drifts;  // of each primitive
  std::span<const NodeEntry> nodes;    // the first is the root; children come after their parents
  std::span<const double> balls;       // (d + 2) a node: centre and radius of a ball around all
  std::span<const double> boxes;       // 2 (d + 1) a node: lower corner, upper corner
};

// Arrays in memory of their own.
struct OwnedArrays {
  IndexSizes sizes;
  std::vector<double> mean, components;
  std::vector<std::int32_t> families;
  std::vector<PrimitiveEntry> primitives;
  std::vector<float> vectors;
  std::vector<double> radii, parameters, places, leading_axes;
  std::vector<DriftEntry> drifts;
  std::vector<NodeEntry> nodes;
  std::vector<double> balls, boxes;

  IndexArrays View() const {
    return {sizes,      mean,   components,   families, primitives, vectors, radii,
            parameters, places, leading_axes, drifts,   nodes,      balls,   boxes};
  }
};

}  // namespace mortise::retrieval
