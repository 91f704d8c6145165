// A volume mesh as users bring it: nodes, tetrahedra, and named groups of them and of their faces.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::mesh {

// A side of an element, numbered as kTetrahedronFaces: opposite that corner.
struct ElementSide {
  int element = 0;
  int side = 0;

  friend auto operator<=>(const ElementSide&, const ElementSide&) = default;
};

// Members are ascending and distinct; a group may be empty.
struct NodeGroup {
  std::string name;
  std::vector<int> members;  // node indices
};
struct ElementGroup {
  std::string name;
  std::vector<int> members;  // element indices
};
struct FaceGroup {
  std::string name;
  std::vector<ElementSide> members;  // of a face between two elements, the first one's side
};

struct GroupedMesh {
  Eigen::Matrix3Xd nodes;      // 3 × N, in whatever unit the file is; each belongs to an element
  Eigen::MatrixXi tetrahedra;  // 4 × E or 10 × E node indices, in the order of TetrahedralMesh;
                               // inverted where the file's are
  std::vector<std::int64_t> node_numbers;     // N, as in the file
  std::vector<std::int64_t> element_numbers;  // E, as in the file
  std::vector<ElementGroup> element_groups;   // names are distinct within a kind of group
  std::vector<FaceGroup> face_groups;
  std::vector<NodeGroup> node_groups;
  std::vector<std::string> notes;  // what of the file was not used, for people
};

// Reads a mesh file: Gmsh MSH (gmsh_reader.h) if its first character is '$', else Abaqus or
// CalculiX input (abaqus_reader.h). Files may be hostile: no more memory is taken than a dozen
// times their size and a gigabyte. INVALID_ARGUMENT naming "mesh_file", with the line (or byte, of
// binary files).
absl::StatusOr<GroupedMesh> ReadGroupedMesh(std::string_view bytes);

// Returns the nodes of a side, 3 or 6: its corners, outward, then the middles of 01, 12, 20.
Eigen::VectorXi SideNodes(const Eigen::MatrixXi& tetrahedra, ElementSide side);

}  // namespace mortise::mesh
