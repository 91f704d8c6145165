// Solves steady heat conduction by finite elements, on the meshes of elasticity.
//
// Find T with ∫ ∇vᵀ k ∇T dV + ∫ v h (T − Tₐ) dA = ∫ v q dA + ∫ v s dV for all v that vanish where
// the temperature is fixed: conductivity k, convection h to the ambient Tₐ, flux q into the body,
// source s. Faces without a condition are insulated; parts that touch conduct to each other (thesis
// §6.7).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/elements/material.h"
#include "common/fem/linear/sparse_cholesky.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// Temperatures are in any unit whose degree is a kelvin, the same throughout: °C or K.
struct FixedTemperature {
  mesh::NamedFace face;  // without a name: `nodes` are held instead
  double temperature = 0;
  std::vector<int> nodes{};  // of the mesh, where there is no face
};

struct HeatFlux {
  mesh::NamedFace face;
  double flux = 0;  // W/m² into the body through the free area of the face
};

struct Convection {
  mesh::NamedFace face;
  double coefficient = 0;  // W/(m² K), over the free area of the face
  double ambient = 0;
};

struct HeatSource {
  int part = 0;                 // -1: `elements` are heated instead
  double power = 0;             // W/m³
  std::vector<int> elements{};  // of the mesh, where there is no part
};

struct HeatCase {
  std::vector<Material> materials;  // one for each part; their conductivity counts
  std::vector<FixedTemperature> temperatures;
  std::vector<HeatFlux> fluxes;
  std::vector<Convection> convections;
  std::vector<HeatSource> sources;
};

struct HeatOptions {
  CholeskyOptions cholesky{};
  int threads = 1;  // the result is the same for any number
};

struct HeatSolution {
  Eigen::VectorXd temperature;  // nodes
  // The heat into the body at nodes of fixed temperature, W; zero elsewhere.
  Eigen::VectorXd reaction;
  Eigen::VectorXd convected;  // W that leaves through each of the case's convections
  // The heat that comes in through each of the case's fixed temperatures, W; nodes of several count
  // for the first.
  Eigen::VectorXd held;
  double supplied = 0;   // W of fluxes and sources
  double imbalance = 0;  // |supplied + reactions − convected| over the sum of their magnitudes
  double minimum = 0;
  double maximum = 0;
  double mean = 0;  // over the volume
  double seconds = 0;
};

// Errors: INVALID_ARGUMENT naming the field ("convections[0].face", "tetrahedra[12]");
// FAILED_PRECONDITION, reason FREE_TEMPERATURE, naming parts that have neither a fixed temperature
// nor convection; RESOURCE_EXHAUSTED.
absl::StatusOr<HeatSolution> SolveHeat(const mesh::TetrahedralMesh& mesh, const HeatCase& heat,
                                       const HeatOptions& options = {});

// Returns the heat that leaves through convections and fixed temperatures, W: the sum over those of
// them that let more out than in.
double DissipatedHeat(const HeatSolution& solution);

// Returns the heat flux −k ∇T at the integration points, W/m²: 3 × (points · elements), those of an
// element in a row, in the order of TetrahedronRule.
Eigen::Matrix3Xd HeatFluxAtPoints(const mesh::TetrahedralMesh& mesh,
                                  const std::vector<Material>& materials,
                                  const Eigen::VectorXd& temperature);

}  // namespace mortise::simulator
