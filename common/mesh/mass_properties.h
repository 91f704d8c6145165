// Computes volume, centroid and inertia of solids given by their surface or by tetrahedra.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/surface_mesh.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::mesh {

// The properties of a solid of density 1 kg/m³. Multiply `volume` and `inertia` by the density.
struct MassProperties {
  double volume = 0;                                   // m³; negative if inside out
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();   // m⁵, tensor about the centroid
};

// Returns the properties of the solid within a closed surface. By the divergence theorem, it sums
// the signed tetrahedra between each triangle and a reference point, which is exact for polyhedra.
MassProperties ComputeMassProperties(const SurfaceMesh& surface);

// Returns the properties of the elements of one part, or of all parts with `part` = -1. Elements
// count as straight-sided: the mid nodes of quadratic ones are taken to lie on the middles of the
// edges.
MassProperties ComputeMassProperties(const TetrahedralMesh& mesh, int part = -1);

// Returns the properties of several bodies of densities `densities` taken together; `volume` is
// then the mass (kg) and `inertia` is in kg m².
MassProperties Combine(const std::vector<MassProperties>& bodies,
                       const std::vector<double>& densities);

// Returns the area of a surface, m².
double SurfaceArea(const SurfaceMesh& surface);

}  // namespace mortise::mesh
