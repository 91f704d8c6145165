// The shapes of one structure's map, as they are stored and served: beside its MapContent.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "services/interpolator/shapes/canonical_mesh.h"
#include "services/interpolator/shapes/shape_difference.h"

namespace mortise::interpolator {

struct ShapedStructure {
  struct Mesh {
    std::string digest;      // of its file
    std::int64_t bytes = 0;  // of its file
    std::int64_t nodes = 0;
    std::int64_t triangles = 0;  // of the outside
    std::int64_t tetrahedra = 0;
    std::vector<std::string> regions;  // names
  };
  struct Shape {
    std::string digest;      // of its file
    std::int64_t bytes = 0;  // of its file
    int inverted = 0;        // tetrahedra that are turned over in it
    double size = 0;         // m, diagonal of its box
    double rounding = 0;     // m: the most that packing moved a node
  };
  // How far interpolation was off at probes, figure by figure the largest of them.
  struct Errors {
    Spread shape{};                // m
    std::vector<Spread> fields{};  // SI units, in the order of `fields`
  };

  std::vector<Mesh> meshes;        // those that elements have; the same fields in all of them
  std::vector<FieldKind> fields;   // none where no element has ever had shapes
  std::vector<FieldRange> ranges;  // of each field: what was sampled
  // In the order of the content's RefinementTree::Elements: the canonical mesh of each, an index
  // into `meshes`; -1 of what is cut off, or has metrics alone. And its errors; zeros of those.
  std::vector<int> element_mesh;
  std::vector<Errors> element_errors;
  // Of each mesh, and each sample on an element that has it.
  std::map<std::pair<int, int>, Shape> shapes;

  Errors largest;  // of all elements
  Errors mean;     // means over all probes of their means, and of their other figures
  // Designs that no canonical mesh around them could take.
  std::int64_t unmapped = 0;
};

}  // namespace mortise::interpolator
