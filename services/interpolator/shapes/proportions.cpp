#include "services/interpolator/shapes/proportions.h"

#include "common/mesh/mass_properties.h"

namespace mortise::interpolator {

Proportions ProportionsOf(const BlendedShape& shape, const CanonicalMesh& mesh) {
  mesh::SurfaceMesh surface;
  surface.vertices =
      Eigen::Map<const Eigen::Matrix3Xf>(shape.positions.data(), 3, mesh.surface_nodes)
          .cast<double>();
  surface.triangles = mesh.triangles;
  Proportions proportions;
  proportions.surface_area = mesh::SurfaceArea(surface);
  if (!mesh.is_closed) return proportions;
  const mesh::MassProperties properties = mesh::ComputeMassProperties(surface);
  proportions.has_volume = true;
  proportions.volume = properties.volume;
  proportions.centroid = properties.centroid;
  return proportions;
}

}  // namespace mortise::interpolator
