// Has OpenFOAM compute the steady flow of air around a body (thesis §6.7: the toy airplane).
#pragma once

#include <Eigen/Core>
#include <stop_token>

#include "absl/status/statusor.h"
#include "common/design/airflow.h"
#include "common/fem/linear/stage_progress.h"
#include "common/mesh/surface_mesh.h"
#include "services/simulator/airflow/wall_pressure.h"

namespace mortise::simulator {

struct AirflowSolverOptions {
  double memory_limit = 8e9;          // bytes
  StageProgress* progress = nullptr;  // told of "air: cells" and "air: flow", if it is there
  std::stop_token stop = {};          // ends it within a moment, as CANCELLED
};

// The effect of air on a body.
struct AirflowSolution {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();     // N, mean of the last quarter of iterations
  Eigen::Vector3d friction = Eigen::Vector3d::Zero();  // N, the part of it along the surface
  double force_swing = 0;  // N, the largest departure of the force from its mean there
  // The surface where the flow is told of: the body's triangles, divided where they are larger than
  // cells, each with vertices of its own, so that pressures may differ on both sides of an edge.
  mesh::SurfaceMesh surface;
  Eigen::VectorXd pressure;  // Pa at the vertices of `surface`, above that of the oncoming air
  WallFaces wall;            // the faces of cells that it comes from, and the pressure on each, Pa
  // The pressures that all but a thousandth of the surface keeps to, Pa; a single cell may be far
  // off.
  double minimum_pressure = 0, maximum_pressure = 0;
  int cells = 0;
  int iterations = 0;
};

// Returns the flow around a body (closed; what cells cannot get between is bridged), in the open,
// far from any ground. One processor; the same result each time. About 30,000 cells take half a
// minute.
//
// FAILED_PRECONDITION, NO_OPENFOAM, where it is not installed; RESOURCE_EXHAUSTED beyond the limit
// of memory; FAILED_PRECONDITION, TOO_FEW_CELLS, where none meets the body; FAILED_PRECONDITION,
// NOT_CONVERGED, where the flow does not settle into finite numbers; else as
// parametric::CheckAirflow and RunOpenFoam.
absl::StatusOr<AirflowSolution> SolveAirflow(const mesh::SurfaceMesh& body,
                                             const parametric::Airflow& airflow,
                                             const AirflowSolverOptions& options = {});

}  // namespace mortise::simulator
