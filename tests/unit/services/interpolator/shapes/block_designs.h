// Designs that are images of a block of cells (../mapping/block_shapes.h), with regions, control
// points, paths and fields that are linear in space, for tests and benches of shapes.
#pragma once

#include <Eigen/Core>

#include "common/fields/design_fields.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {

// What the fields of a block's design are at a place, m.
double TemperatureAt(const Eigen::Vector3d& place);                  // K, of nodes
Eigen::Vector3d DisplacementAt(const Eigen::Vector3d& place);        // m, of nodes
Eigen::Matrix<double, 6, 1> StressAt(const Eigen::Vector3d& place);  // Pa, of nodes
Eigen::Vector3d HeatFluxAt(const Eigen::Vector3d& place);  // W/m², of elements, at their centres

// Returns the design of a block, of one part: its outer triangles, those at the first coordinate 0
// as region "held"; control points and paths by nodes; fields "temperature", "displacement" and
// "stress" of load case "wind", and "heat_flux".
fields::DesignFields BlockDesign(const BlockShape& shape, const BlockCells& cells);

// Returns the same without tetrahedra, and without what is of them.
fields::DesignFields SurfaceOnly(fields::DesignFields design);

// Returns it with 10-node elements and 6-node triangles, whose middles lie on the sides' middles
// and have no value of their own: 1e6 everywhere.
fields::DesignFields Quadratic(const fields::DesignFields& design);

}  // namespace mortise::interpolator
