// Brings the geometry of many designs into the connectivity of one tetrahedral mesh, the canonical
// one: p_A^l of the thesis (§6.6.2), from surface to interior. All that only depends on the target
// is made once: its surface, the places of its control variables, and what solves for its interior
// (VolumeMapper).
//
// Where the elements of a source are quadratic, the nodes of the target's surface come to lie on
// their curved sides: on triangles between corners, which cut what is round, elements with all
// corners on a round face would become flat.
//
//   MORTISE_ASSIGN_OR_RETURN(const auto mapper, MeshMapper::Create({mesh, variables}));
//   MORTISE_ASSIGN_OR_RETURN(const MeshMap map, mapper->Map({sample_mesh, sample_variables}));
//
// On flat faces that lie in a plane of two axes in both designs only control points and paths have
// their places; the nodes between slide on the face as the elastic body takes them. So the two
// sides of a board, whose triangles know nothing of each other, are not sheared against each other.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/control_variables.h"
#include "common/mesh/tetrahedral_mesh.h"
#include "services/interpolator/mapping/marked_surface.h"
#include "services/interpolator/mapping/outer_surface.h"
#include "services/interpolator/mapping/surface_map.h"
#include "services/interpolator/mapping/volume_map.h"

namespace mortise::interpolator {

// A mesh of a CAD model with the model's control variables, which need not be nodes of it: they are
// found on its surface (control_points.h).
struct ModelMesh {
  mesh::TetrahedralMesh mesh;
  mesh::ControlVariables variables;
};

struct MeshMap {
  Eigen::Matrix3Xd nodes;         // 3 × target's nodes, m: of the source's shape
  OuterSurface outer;             // of the target
  SurfaceMap surface;             // where its vertices are on the source's outer surface
  std::vector<NodePlace> places;  // of its vertices, in nodes of the source
  VolumeMap volume;               // how the interior followed, and which elements it could not keep
};

struct MeshMapOptions {
  LayoutOptions layout;
  VolumeMapOptions volume;
};

class MeshMapper {
 public:
  // INVALID_ARGUMENT below "target", as PlaceControlVariables and VolumeMapper say.
  static absl::StatusOr<std::unique_ptr<const MeshMapper>> Create(
      ModelMesh target, const MeshMapOptions& options = {});

  // Maps every node of the target to where it belongs in `source`. The result does not depend on
  // what was mapped before. May be called from any number of threads; they wait for each other
  // while they solve for interiors. Fails as PlaceControlVariables, below "source", MapSurface and
  // VolumeMapper do.
  absl::StatusOr<MeshMap> Map(const ModelMesh& source) const;

  const ModelMesh& target() const { return target_; }

  // Returns the surface of all parts of the target, as it comes with every map.
  const OuterSurface& outer() const { return outer_; }

 private:
  MeshMapper(ModelMesh target, LayoutOptions layout);

  ModelMesh target_;
  OuterSurface outer_;
  MarkedSurface marked_;  // with the target's control variables
  LayoutOptions layout_;
  std::unique_ptr<const VolumeMapper> volume_;
};

}  // namespace mortise::interpolator
