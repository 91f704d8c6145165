// The shape of a design at one parameter vector, and fields on it: what an evaluator gives beside
// metrics, and what maps interpolate (thesis §6.6). fields_file.h writes and reads it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace mortise::fields {

// What may be in one, so that what a stranger wrote can be told from nonsense.
inline constexpr int kMaximumCount = 2'000'000'000;      // of nodes, triangles, tetrahedra
inline constexpr std::size_t kMaximumNameLength = 4096;  // bytes
inline constexpr int kMaximumComponents = 100;           // of a field
inline constexpr int kMaximumControls = 100'000;         // of control points, ways, paths, each
inline constexpr int kMaximumPositions = 1'000'000;      // of all ways; likewise nodes of all paths

// Some of the triangles, by a name that persists from design to design.
struct Region {
  std::string name;            // of a boundary condition, or of a face of a part
  std::vector<int> triangles;  // ascending, each once; may be none
};

// A place with a persistent name, such as a vertex of a CAD model.
struct ControlPoint {
  std::string id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  int node = -1;                                       // that lies there; -1 where none does
};

// A way over the surface with a persistent name, such as an edge of a CAD model.
struct Path {
  std::string id;
  std::vector<int> nodes;  // one after another, at least two; the first again at the end if closed
};

// A piece of such an edge from one control point to another, which needs no nodes on it.
struct ControlWay {
  std::string edge;            // the pieces of one edge share its name
  int from = -1;               // control points
  int to = -1;                 // and
  Eigen::Matrix3Xd positions;  // 3 × at least 2, m, from the one to the other along the edge
};

enum class FieldPlace { kNodes, kElements };

// A quantity all over the design, in one load case.
struct Field {
  std::string name;       // "von_mises"
  std::string unit;       // SI unit
  std::string load_case;  // empty of what belongs to none; "mode 2" of natural modes
  FieldPlace place = FieldPlace::kNodes;
  // components × nodes, or components × tetrahedra. Tensors are xx, yy, zz, xy, yz, xz.
  Eigen::MatrixXd values;
};

struct DesignFields {
  Eigen::Matrix3Xd nodes;  // 3 × N, m
  // 4 × E or 10 × E nodes of each tetrahedron in the order of mesh/tetrahedral_mesh.h; E = 0 where
  // there is the surface only.
  Eigen::MatrixXi tetrahedra;
  Eigen::VectorXi tetrahedron_part;  // E, index into `parts`
  // 3 × F or 6 × F nodes: corners, then the middles of sides 01, 12, 20. They lie on the outside,
  // and between parts that touch.
  Eigen::MatrixXi triangles;
  Eigen::VectorXi triangle_back;   // F: the part behind, index into `parts`; -1 is the outside
  Eigen::VectorXi triangle_front;  // F: the part that the normal points into; -1 is the outside
  std::vector<std::string> parts;  // names, each once
  std::vector<Region> regions;     // each name once
  std::vector<ControlPoint> control_points;  // each id once
  std::vector<Path> paths;                   // each id once
  std::vector<ControlWay> ways;
  std::vector<Field> fields;  // each pair of name and load case once
};

// Fails with INVALID_ARGUMENT naming the first that is wrong, "tetrahedra[12]", "fields[1].values",
// unless sizes agree, indices are in range, names are within their limits and unique, and all
// numbers are finite. O(size).
absl::Status Check(const DesignFields& design);

}  // namespace mortise::fields
