// Measures how well-shaped the elements of a volume mesh are.
#pragma once

#include <array>
#include <string>

#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::testing {

// Angles in radians. The aspect ratio of an element is its longest edge over its shortest height,
// scaled so that the regular tetrahedron has 1.
struct QualityReport {
  int elements = 0;
  int nodes = 0;
  double minimum_volume = 0;    // m³; zero or less means unusable elements
  double minimum_dihedral = 0;  // smallest angle between two faces of any element
  double maximum_dihedral = 0;
  double maximum_aspect = 0;
  double mean_aspect = 0;
  int worst_element = -1;                    // the one with the largest aspect ratio
  std::array<int, 18> dihedral_histogram{};  // elements' smallest angles, in steps of 5 degrees
};

// Measures every element by its corners. An empty mesh gives an empty report.
QualityReport MeasureQuality(const mesh::TetrahedralMesh& mesh);

// Returns a few lines for people.
std::string ToText(const QualityReport& report);

}  // namespace mortise::testing
