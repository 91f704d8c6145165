// Brings the geometry of many designs into the connectivity of one tetrahedral mesh, the canonical
// one: as MapMesh (mesh_map.h), with all that only depends on the target made once: its surface,
// the places of its control variables, and what solves for its interior (VolumeMapper).
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

#include <memory>

#include "absl/status/statusor.h"
#include "services/interpolator/mapping/mesh_map.h"

namespace mortise::interpolator {

struct MeshMapOptions {
  LayoutOptions layout;
  VolumeMapOptions volume;
};

class MeshMapper {
 public:
  // INVALID_ARGUMENT below "target", as MapMesh says.
  static absl::StatusOr<std::unique_ptr<const MeshMapper>> Create(
      ModelMesh target, const MeshMapOptions& options = {});

  // Maps every node of the target to where it belongs in `source`. The result does not depend on
  // what was mapped before. May be called from any number of threads; they wait for each other
  // while they solve for interiors. Fails as MapMesh does.
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
