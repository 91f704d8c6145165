// Conforming assemblies of axis-aligned boxes, for tests of meshing and simulation.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

struct TestBox {
  std::string name;
  Eigen::Vector3d low;
  Eigen::Vector3d high;
};

// The conforming surface of boxes that may touch but not overlap. Faces are named x_min … z_max.
AssemblySurface AssembleBoxes(const std::vector<TestBox>& boxes);

// A table of nine parts: top, leg0 … leg3, apron0 … apron3; the feet stand on z = 0.
AssemblySurface TestTable(double length = 1.4, double width = 0.8, double height = 0.73,
                          double leg = 0.06, double apron_height = 0.09, double top = 0.027);

// One box as a closed surface.
SurfaceMesh BoxSurface(const Eigen::Vector3d& low, const Eigen::Vector3d& high);

}  // namespace mortise::mesh
