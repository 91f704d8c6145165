// Brings the geometry of one tetrahedral mesh into the connectivity of another of the same design:
// p_A^l of the thesis (§6.6.2), from surface to interior.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/control_variables.h"
#include "common/mesh/tetrahedral_mesh.h"
#include "services/interpolator/mapping/marked_surface.h"
#include "services/interpolator/mapping/outer_surface.h"
#include "services/interpolator/mapping/surface_map.h"
#include "services/interpolator/mapping/volume_map.h"

namespace mortise::interpolator {

// A mesh with control points and paths on its surface, by nodes that are corners of elements.
struct MarkedMesh {
  mesh::TetrahedralMesh mesh;
  std::vector<ControlPoint> points;  // `vertex` is a node
  std::vector<ControlPath> paths;    // nodes
};

// Returns the surface of all parts together. INVALID_ARGUMENT below `field` if a point or path is
// not on it.
absl::StatusOr<OuterSurface> OuterSurfaceOf(const MarkedMesh& marked, const std::string& field);

struct MeshMap {
  Eigen::Matrix3Xd nodes;         // 3 × target's nodes, m: of the source's shape
  OuterSurface outer;             // of the target
  SurfaceMap surface;             // where its vertices are on the source's outer surface
  std::vector<NodePlace> places;  // of its vertices, in nodes of the source
  VolumeMap volume;               // how the interior followed, and which elements it could not keep
};

// Maps every node of the target. Fails as MapSurface and MapVolume do, with fields below "source"
// and "target".
absl::StatusOr<MeshMap> MapMesh(const MarkedMesh& source, const MarkedMesh& target,
                                const LayoutOptions& layout = {},
                                const VolumeMapOptions& volume = {});

// A mesh of a CAD model with the model's control variables, which need not be nodes of it.
struct ModelMesh {
  mesh::TetrahedralMesh mesh;
  mesh::ControlVariables variables;
};

// Does the same for two models, whose control variables are found on their surfaces
// (control_points.h). Places are in triangles of the source's outer surface, as it is without
// them. For more than one source of a target there is MeshMapper.
absl::StatusOr<MeshMap> MapMesh(const ModelMesh& source, const ModelMesh& target,
                                const LayoutOptions& layout = {},
                                const VolumeMapOptions& volume = {});

}  // namespace mortise::interpolator
