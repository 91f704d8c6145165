#include "common/mesh/files/grouped_mesh.h"

#include <algorithm>

#include "common/base/errors.h"
#include "common/base/text_encoding.h"
#include "common/mesh/element_faces.h"
#include "common/mesh/files/abaqus_reader.h"
#include "common/mesh/files/gmsh_reader.h"

namespace mortise::mesh {

absl::StatusOr<GroupedMesh> ReadGroupedMesh(std::string_view bytes) {
  MORTISE_ASSIGN_OR_RETURN(bytes, WithoutByteOrderMark(bytes, "mesh_file"));
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return InvalidField("mesh_file", "is empty");
  return bytes[first] == '$' ? ReadGmsh(bytes) : ReadAbaqus(bytes);
}

Eigen::VectorXi SideNodes(const Eigen::MatrixXi& tetrahedra, ElementSide side) {
  const auto& corners = kTetrahedronFaces[side.side];
  const bool quadratic = tetrahedra.rows() == 10;
  Eigen::VectorXi nodes(quadratic ? 6 : 3);
  for (int k = 0; k < 3; ++k) {
    nodes[k] = tetrahedra(corners[k], side.element);
    if (!quadratic) continue;
    const auto [low, high] = std::minmax(corners[k], corners[(k + 1) % 3]);
    for (int edge = 0; edge < 6; ++edge) {
      if (kTetrahedronEdges[edge][0] == low && kTetrahedronEdges[edge][1] == high) {
        nodes[3 + k] = tetrahedra(4 + edge, side.element);
      }
    }
  }
  return nodes;
}

}  // namespace mortise::mesh
