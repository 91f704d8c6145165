// Linear elasticity by finite elements: small displacements of bonded parts under static loads.
//
// Find u with ∫ ε(v)ᵀ D ε(u) dV = ∫ vᵀ t dA + ∫ vᵀ ρ g dV for all v that vanish on the supports
// (thesis §6.6, §8.4). With u = Σ Nᵢ uᵢ on tetrahedra this is K u = f.
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/statusor.h"
#include "common/mesh/tetrahedral_mesh.h"
#include "services/simulator/analysis_case.h"
#include "services/simulator/sparse_cholesky.h"

namespace mortise::simulator {

struct ElasticityOptions {
  CholeskyOptions cholesky;
  bool recover_stress = true;  // false saves about a tenth of the time where only u is wanted
};

// How a solution went, and what proves it.
struct ElasticitySummary {
  int nodes = 0;
  int elements = 0;
  CholeskySummary cholesky;
  Eigen::Vector3d total_load = Eigen::Vector3d::Zero();      // N, sum of applied forces
  Eigen::Vector3d total_reaction = Eigen::Vector3d::Zero();  // N, sum of reactions at the supports
  double imbalance = 0;             // |load + reaction| over the sum of the nodal loads' magnitudes
  double residual = 0;              // |K u − f| of free directions over |f|
  double strain_energy = 0;         // J, ½ uᵀ K u
  double compliance = 0;            // J, fᵀ u: the work of the loads were they applied at once
  double maximum_displacement = 0;  // m
  int maximum_displacement_node = -1;
  double assembly_seconds = 0;
  double solution_seconds = 0;
  double recovery_seconds = 0;
  double seconds = 0;  // all of it
};

struct ElasticitySolution {
  Eigen::Matrix3Xd displacement;                    // 3 × nodes, m
  Eigen::Matrix3Xd reaction;                        // 3 × nodes, N; zero away from supports
  Eigen::Matrix<double, 6, Eigen::Dynamic> stress;  // 6 × nodes, Pa: xx yy zz xy yz xz
  Eigen::VectorXd von_mises;                        // nodes, Pa
  Eigen::VectorXd part_maximum_von_mises;           // parts, Pa
  ElasticitySummary summary;
};

// Solves one case. Errors: INVALID_ARGUMENT naming the field of the case or the element at fault;
// FAILED_PRECONDITION with reason RIGID_MOTION or SINGULAR; RESOURCE_EXHAUSTED.
absl::StatusOr<ElasticitySolution> SolveElasticity(const mesh::TetrahedralMesh& mesh,
                                                   const AnalysisCase& analysis,
                                                   const ElasticityOptions& options = {});

}  // namespace mortise::simulator
