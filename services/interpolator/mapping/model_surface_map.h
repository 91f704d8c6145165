// Brings the surface of a design into the triangles of another one, where there are no tetrahedra
// (thesis §6.6.2, surface mapping alone).
//
// The outside of all parts together is mapped as MapSurface says. Triangles between parts follow
// it: vertices that are on them alone go where a harmonic map takes them (mean value coordinates of
// the target's triangles between parts), which keeps what is flat and was stretched evenly, and
// from there to the nearest point of the source's triangles between the same parts, where it has
// any. What is joined to no vertex on the outside, a part within another one, goes first where the
// box of the outside takes it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/control_variables.h"
#include "common/mesh/surface_mesh.h"
#include "services/interpolator/mapping/outer_surface.h"

namespace mortise::interpolator {

// The triangles of a design: on the outside, and between parts that touch. The former are outward,
// closed and oriented together.
struct ModelSurface {
  mesh::SurfaceMesh surface;
  // Of each triangle: the parts behind it and in front; the latter is −1 on the outside. Both empty
  // where all triangles are on the outside.
  Eigen::VectorXi back, front;
  // Of quadratic elements: 3 × triangles, the vertices in the middles of the sides 01, 12, 20,
  // which `surface` has besides; or empty.
  Eigen::Matrix3Xi middles;
  mesh::ControlVariables variables;  // need not be vertices
};

struct ModelSurfaceMap {
  Eigen::Matrix3Xd positions;     // 3 × target's vertices, m: of the source's shape
  std::vector<NodePlace> places;  // of each, in vertices of the source; nodes −1 of those that no
                                  // triangle names, which stay
  SurfaceMap surface;             // how the outside was mapped
  int between_parts = 0;          // vertices that are on triangles between parts alone
};

// A surface into whose triangles others are brought. What depends on it alone is made once.
class ModelSurfaceMapper {
 public:
  // INVALID_ARGUMENT below "target": "target.surface" unless the triangles on the outside are
  // closed and oriented; "target.front", "target.middles" where they are not as many as triangles;
  // as PlaceControlVariables.
  static absl::StatusOr<std::unique_ptr<const ModelSurfaceMapper>> Create(
      ModelSurface target, const LayoutOptions& layout = {});

  // Maps every corner of the target's triangles; middles of sides come halfway between, and what no
  // triangle names stays, without a place. May be called from any number of threads. Fails as
  // MapSurface does, and as Create does, below "source".
  absl::StatusOr<ModelSurfaceMap> Map(const ModelSurface& source) const;

  const ModelSurface& target() const { return target_; }

 private:
  ModelSurfaceMapper() = default;

  ModelSurface target_;
  OuterSurface outer_;
  MarkedSurface marked_;
  LayoutOptions layout_;
};

}  // namespace mortise::interpolator
