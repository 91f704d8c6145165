// Brings designs into a canonical mesh: p_k^l of thesis §6.4.2, the shape and the fields of one
// design in the nodes and elements that all share.
//
// A design with the same elements as the canonical mesh's own, as from evaluators of fixed
// topology, is taken over node by node. Any other is mapped (../mapping, thesis §6.6.2): its outer
// surface onto the canonical one, patch by patch between control variables, and the interior by
// elasticity. Its fields follow by place: nodes on the surface have the value at the nearest point
// of the design's own surface, linear in its triangle, which rounding apart is the place that the
// map took them to; nodes inside have the value linear in the design's tetrahedron that they lie
// in, and what is of elements that of the element that the centre lies in. What lies outside of the
// design, as its elements are not quite those mapped, has the value of the nearest place on its
// surface. Values are so never beyond those that the design has.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fields/design_fields.h"
#include "services/interpolator/mapping/mesh_mapper.h"
#include "services/interpolator/shapes/canonical_mesh.h"

namespace mortise::interpolator {

// Exact: what maps compute with before it is packed (packed_shape.h).
struct ConsistentShape {
  Eigen::Matrix3Xd nodes;               // 3 × N, m, in the canonical mesh's order
  std::vector<Eigen::MatrixXd> fields;  // of each of its fields: components × nodes or tetrahedra
};

struct BroughtShape {
  ConsistentShape shape;
  bool is_identity = false;  // whether its elements were the canonical mesh's own
  int inverted =
      0;  // elements that are turned over or flat in this shape, and not in the mesh itself
  int outside = 0;      // nodes and centres whose values come from the nearest place, and
  double furthest = 0;  // m, how far away that was at the most
};

// Returns how many elements are turned over or flat with nodes at these places, 3 × N, and are not
// in the mesh itself.
int TurnedOver(const CanonicalMesh& mesh, const Eigen::Matrix3Xd& nodes);

// A canonical mesh that many designs are brought into. Whatever only depends on the mesh is
// computed once, when the first design wants it: the solver of a large mesh takes much memory, and
// designs with the mesh's own elements need none.
class PreparedMesh {
 public:
  explicit PreparedMesh(std::shared_ptr<const CanonicalMesh> mesh,
                        const MeshMapOptions& options = {});
  ~PreparedMesh();

  const CanonicalMesh& mesh() const { return *mesh_; }

  // Brings a design into the mesh; the same design gives the same shape, whatever was brought
  // before. May be called from any number of threads, which wait for each other where interiors are
  // solved.
  //
  // INVALID_ARGUMENT as fields::Check, for numbers that are not finite too; "fields" naming the
  // field and load case that the canonical mesh has and the design lacks, or has in another unit,
  // number of components or place; "tetrahedra" where it has none and the mesh has.
  // FAILED_PRECONDITION, reason TOPOLOGY_DIFFERS, TOO_FEW_POINTS or PATCH_NOT_SIMPLE, where its
  // topology is another one (patch_layout.h), so that its element of the map wants a mesh of its
  // own; TOPOLOGY_DIFFERS also where it has another number of parts. Fields of errors of the
  // mapping are below "design" and, where it is the canonical mesh's fault, "mesh".
  absl::StatusOr<BroughtShape> Bring(const fields::DesignFields& design) const;

 private:
  class Mapping;

  absl::StatusOr<BroughtShape> BringOther(const fields::DesignFields& design) const;

  std::shared_ptr<const CanonicalMesh> mesh_;
  std::unique_ptr<Mapping> mapping_;
};

}  // namespace mortise::interpolator
