// How a map gets its shapes and fields.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "services/interpolator/building/known_shapes.h"
#include "services/interpolator/shapes/bring_into.h"

namespace mortise::interpolator {

// A field that every design must have, in whichever load cases.
struct WantedField {
  std::string name;
  double noise_floor = 0;  // over its range: where it is off by less, nothing is sampled for it
};

struct ShapeOptions {
  std::vector<WantedField> fields;  // a design that lacks one has failed
  double noise_floor = 0;           // of the shape, over its size
  // The share of a mesh's tetrahedra that may be turned over in a shape as it is served, by mapping
  // or by rounding. Where there are more, the design cannot be brought into the mesh.
  double most_inverted = 0.05;
  int threads = 1;  // that map. Their number does not change the map.
  // Bytes of designs, meshes and shapes that are kept in memory; what is in use comes on top.
  std::size_t memory = std::size_t{512} << 20;
  MeshMapOptions mapping;  // how designs are brought into canonical meshes
  // Keeps bytes; returns the digest by which `get` gives them back. Both are called by several
  // threads at once. A failure stops the build as if the evaluator were lost.
  std::function<absl::StatusOr<std::string>(const std::string& bytes)> put;
  std::function<absl::StatusOr<std::string>(const std::string& digest)> get;
  // Called with what is found out, after its files have been put and before anything else happens
  // with it, on the thread that runs the build. A failure stops the build likewise.
  std::function<absl::Status(const KnownShapes&)> keep;
};

}  // namespace mortise::interpolator
