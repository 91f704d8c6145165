// The mesh that shapes of many designs share: nodes, tetrahedra, triangles, parts and regions of
// one design, its own (p^l of thesis §6.4.2). Shapes that have been brought into it (bring_into.h)
// differ in the places of nodes and in the values of fields alone, so that they can be added up.
//
// Nodes are sorted: those of outer triangles come first, so that who shows the surface needs only
// the first `surface_nodes` of every shape; within these, and within those behind them, neighbours
// in space are near each other, which packs better and is quicker to draw. Only corners of
// elements are nodes: middles of edges of 10-node elements are left out.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fields/design_fields.h"
#include "common/mesh/control_variables.h"

namespace mortise::interpolator {

// What every shape has beside its places of nodes.
struct FieldKind {
  std::string name;
  std::string unit;       // SI unit
  std::string load_case;  // empty of what belongs to none
  fields::FieldPlace place = fields::FieldPlace::kNodes;
  int components = 1;

  friend bool operator==(const FieldKind&, const FieldKind&) = default;
};

// Whether a field's sign is arbitrary, as that of natural modes, "mode_shape", is: two designs that
// are alike may have it either way.
bool HasArbitrarySign(const FieldKind& kind);

// Made by Create, and not changed after that.
struct CanonicalMesh {
  // Makes the mesh of one design. With tetrahedra the outer triangles are those faces that only one
  // element has, without them those given ones that have the outside on one side. Nodes that no
  // corner of a tetrahedron (or triangle, where there are none) names are dropped. The same design
  // gives the same mesh, and so does a mesh read from its file.
  //
  // INVALID_ARGUMENT as fields::Check, for numbers that are not finite too; "triangles" where there
  // are none on the outside.
  static absl::StatusOr<CanonicalMesh> Create(const fields::DesignFields& design);

  int node_count() const { return static_cast<int>(nodes.cols()); }
  int element_count() const { return static_cast<int>(tetrahedra.cols()); }

  // Returns how many nodes or tetrahedra a field has values of.
  int ValueCount(const FieldKind& field) const {
    return field.place == fields::FieldPlace::kNodes ? node_count() : element_count();
  }

  // Returns the number of a field, or -1.
  int FindField(std::string_view name, std::string_view load_case) const;

  Eigen::Matrix3Xd nodes;       // 3 × N, m: of the design that it was made of
  int surface_nodes = 0;        // how many: 0 … surface_nodes − 1 are those of outer triangles
  Eigen::Matrix4Xi tetrahedra;  // 4 × E, of positive volume; E = 0 of a surface alone
  Eigen::VectorXi tetrahedron_part;  // E, index into `parts`

  // The outside of all parts together, counter-clockwise seen from outside.
  Eigen::Matrix3Xi triangles;     // 3 × F
  Eigen::VectorXi triangle_part;  // F, index into `parts`, the part behind; -1 if it has none
  bool is_closed = false;         // whether they enclose a volume: every edge is balanced

  // Between parts: the others of the design's triangles. Their nodes need not be among the first. A
  // surface alone is without them.
  Eigen::Matrix3Xi inner_triangles;  // 3 × I
  Eigen::VectorXi inner_back;        // I, the part behind, and
  Eigen::VectorXi inner_front;       // I, the part in front

  std::vector<std::string> parts;
  std::vector<fields::Region> regions;  // of outer triangles alone; may be left without any
  std::vector<FieldKind> fields;
  // Of each field whose sign is arbitrary the design's own values, components × N, with 24 bits:
  // what the sign of others is told by. Of other fields nothing, 0 × 0.
  std::vector<Eigen::MatrixXd> own_values;
  double size = 0;  // m, diagonal of the box around its nodes

  // What it was made of, with corners alone and nodes in the order given: what the file keeps, and
  // what tells a design of the same nodes and elements. It is without fields.
  fields::DesignFields given;
  std::vector<int> given_node;  // of each node: the node of `given`
};

// Returns the mesh's file: that of `given` (common/fields/fields_file.h), compressed (zstd) behind
// a header with a SHA-256 checksum.
absl::StatusOr<std::string> WriteMesh(const CanonicalMesh& mesh);

// Reads it. INVALID_ARGUMENT naming "mesh.header", "mesh.checksum" or below "mesh" for what is no
// such file, is cut short or changed; RESOURCE_EXHAUSTED where it says that it is larger than
// fields::kMaximumFileSize.
absl::StatusOr<CanonicalMesh> ReadMesh(std::string_view bytes);

}  // namespace mortise::interpolator
