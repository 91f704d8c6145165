// What a build with shapes has found out, so that one that was interrupted need not find it out
// again: canonical meshes, shapes that were brought into them, how far interpolation was off.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "services/interpolator/shapes/shape_difference.h"

namespace mortise::interpolator {

// A canonical mesh: the `mesh`-th of a structure.
struct MeshKey {
  int structure = 0;
  int mesh = 0;

  auto operator<=>(const MeshKey&) const = default;
};

// A design in a canonical mesh: the `number`-th that the structure's map asked for.
struct ShapeKey {
  MeshKey mesh;
  std::int64_t number = 0;

  auto operator<=>(const ShapeKey&) const = default;
};

// A design in a canonical mesh, beside what is interpolated in its place.
struct DifferenceKey {
  ShapeKey shape;
  std::uint64_t weights = 0;  // a digest of the samples that act there and of their weights

  auto operator<=>(const DifferenceKey&) const = default;
};

struct KnownMesh {
  std::int64_t number = 0;  // of the design that it was made of
  absl::Status status;      // why none could be made of it; OK if one was
  std::string digest;       // of its file (WriteMesh)
  std::int64_t bytes = 0;   // of its file
};

struct KnownShape {
  absl::Status status;             // why the design cannot be brought into the mesh; OK if it was
  std::string digest;              // of its file (WriteShape)
  std::int64_t bytes = 0;          // of its file
  int inverted = 0;                // tetrahedra that are turned over in it, as it is served
  double size = 0;                 // m, diagonal of its box
  double rounding = 0;             // m: the most that packing moved a node
  std::vector<FieldRange> ranges;  // of each of the mesh's fields
  // Places of a few nodes, and values of each field there, by which it is told along which
  // parameters shapes bend (traits.h).
  std::vector<float> traits;
};

struct KnownDifference {
  double size = 0;             // m, diagonal of the true design's box
  Spread shape;                // m
  std::vector<Spread> fields;  // SI units, of each of the mesh's fields
};

struct KnownShapes {
  std::map<MeshKey, KnownMesh> meshes;
  std::map<ShapeKey, KnownShape> shapes;
  std::map<DifferenceKey, KnownDifference> differences;

  bool empty() const { return meshes.empty() && shapes.empty() && differences.empty(); }
};

}  // namespace mortise::interpolator
