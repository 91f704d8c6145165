// Writes the air around a body as a case that OpenFOAM reads: a box of cells that get finer towards
// the body, what flows in, what the air is, and how it is solved.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <map>
#include <string>

#include "common/design/airflow.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::simulator {

// The box in which the air is computed, divided evenly, whose cells are halved `levels` times
// towards the body. It is in the wind's frame, in which it blows along x.
struct AirflowDomain {
  Eigen::AlignedBox3d box;   // m
  Eigen::Array3i divisions;  // cells of the box along x, y and z, before they are halved
  int levels = 0;
  double surface_cell = 0;  // m, edge of a cell at the body
  int most_cells = 0;       // where halving ends, whatever the levels say
};

// Returns a domain of about `cells` cells around a closed body (wind's frame): four of the body's
// largest extents to each side and before it, eight behind it.
AirflowDomain MakeAirflowDomain(const mesh::SurfaceMesh& body, int cells);

// Returns the case's files by their paths in its folder. The body is a wall, on which "coefficient"
// is sampled at the end, the pressure above that of the oncoming air in units of its dynamic
// pressure; forces are written at each iteration. The solver is rhoSimpleFoam: steady,
// compressible, subsonic, with k-omega SST (Menter, 1994) and wall functions.
std::map<std::string, std::string> WriteAirflowCase(const mesh::SurfaceMesh& body,
                                                    const AirflowDomain& domain,
                                                    const parametric::Air& air, double speed,
                                                    int iterations);

}  // namespace mortise::simulator
