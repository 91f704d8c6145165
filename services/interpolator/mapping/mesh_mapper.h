// Brings the geometry of many designs into the connectivity of one tetrahedral mesh, the canonical
// one: as MapMesh (mesh_map.h), with all that only depends on the target made once: its surface,
// the places of its control variables, and what solves for its interior (VolumeMapper).
//
//   MORTISE_ASSIGN_OR_RETURN(const auto mapper, MeshMapper::Create({mesh, variables}));
//   MORTISE_ASSIGN_OR_RETURN(const MeshMap map, mapper->Map({sample_mesh, sample_variables}));
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

// Returns places that `map` found in triangles of `marked`, of the first `count` vertices, as
// places in the triangles of the surface that its control variables were placed on.
std::vector<TrianglePlace> PlacesBeforeMarking(const mesh::SurfaceMesh& given,
                                               const MarkedSurface& marked, const SurfaceMap& map,
                                               std::size_t count);

}  // namespace mortise::interpolator
