// Solves linear elasticity by finite elements: small displacements of bonded parts under static
// loads.
//
// Find u with ∫ ε(v)ᵀ D (ε(u) − ε_T) dV = ∫ vᵀ t dA + ∫ vᵀ b dV for all v that vanish on the
// supports (thesis §6.6, §8.4). With u = Σ Nᵢ uᵢ on tetrahedra this is K u = f.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/elements/analysis_case.h"
#include "common/fem/linear/linear_solver.h"
#include "common/fem/stress/patch_recovery.h"
#include "common/fem/stress/surface_traction.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

struct ElasticityOptions {
  SolverOptions solver{};      // `threads` below counts, not its own
  bool recover_stress = true;  // false saves about a tenth of the time where only u is wanted
  int threads = 1;             // the result is the same for any number
  std::function<void()> before_recovery{};  // called when only stresses are missing
};

// Tells how a solution went, and what proves it.
struct ElasticitySummary {
  int nodes = 0;
  int elements = 0;
  SolverSummary solver;
  Eigen::Vector3d total_load = Eigen::Vector3d::Zero();      // N, sum of applied forces
  Eigen::Vector3d total_reaction = Eigen::Vector3d::Zero();  // N, sum of reactions at the supports
  double imbalance = 0;      // |load + reaction| over the sum of the nodal loads' magnitudes
  double residual = 0;       // |K u − f| of free directions over |f|
  double strain_energy = 0;  // J, ½ uᵀ K u; of a warm body less the energy of free expansion
  double compliance = 0;     // J, fᵀ u: the work of the loads were they applied at once
  double maximum_displacement = 0;  // m
  int maximum_displacement_node = -1;
  double assembly_seconds = 0;     // of the loads; in the first case of the stiffness too
  double preparation_seconds = 0;  // of the solver; in the first case only
  double solution_seconds = 0;     // 0 of combinations, which are not solved
  double recovery_seconds = 0;
  double seconds = 0;  // all of it
};

struct ElasticitySolution {
  Eigen::Matrix3Xd displacement;           // 3 × nodes, m
  Eigen::Matrix3Xd load;                   // 3 × nodes, N
  Eigen::Matrix3Xd reaction;               // 3 × nodes, N; zero away from supports
  Eigen::VectorXd temperature;             // nodes, K, or empty: of the load case
  SurfaceTraction traction;                // on the faces of PartSurface, if stress is recovered
  Stresses stress;                         // 6 × nodes, Pa: xx yy zz xy yz xz
  Eigen::VectorXd von_mises;               // nodes, Pa
  Eigen::VectorXd maximum_principal;       // nodes, Pa
  Eigen::VectorXd part_maximum_von_mises;  // parts, Pa
  // parts: strength over the largest von Mises stress; infinite where the strength is unknown or
  // there is no stress. Of wood, whose strength differs by direction, a rough guide only.
  Eigen::VectorXd part_safety_factor;
  ElasticitySummary summary;
};

// A share of a combination of load cases.
struct CombinationTerm {
  double factor = 1;
  const ElasticitySolution* solution = nullptr;
};

// An assembly on its supports, prepared (factorised, or set up for iteration) once, under any
// number of load cases.
class ElasticSystem {
 public:
  // `mesh` must outlive the system and stay as it is. Errors: INVALID_ARGUMENT naming the field of
  // the model or the element at fault; FAILED_PRECONDITION with reason RIGID_MOTION or SINGULAR;
  // RESOURCE_EXHAUSTED.
  static absl::StatusOr<ElasticSystem> Create(const mesh::TetrahedralMesh& mesh,
                                              std::vector<Material> materials,
                                              const std::vector<Support>& supports,
                                              const ElasticityOptions& options = {});

  ~ElasticSystem();
  ElasticSystem(ElasticSystem&&) noexcept;
  ElasticSystem& operator=(ElasticSystem&&) noexcept;

  // Solves one load case. Prescribed displacements act in each. INVALID_ARGUMENT naming the field
  // of the load at fault.
  absl::StatusOr<ElasticitySolution> Solve(const LoadCase& loads);

  // Returns the displacements under nodal forces (3 × nodes, N) where all supports are at rest: the
  // adjoint solutions of derivatives. Fails as the linear solver does.
  absl::StatusOr<Eigen::Matrix3Xd> SolveForces(const Eigen::Matrix3Xd& forces);

  // Returns Σ factor · solution of load cases of this system, stresses and proofs included: a
  // linear combination, in which prescribed displacements are multiplied too. INVALID_ARGUMENT
  // naming "terms[i]" if a factor is not finite or a solution is of another mesh.
  absl::StatusOr<ElasticitySolution> Combine(std::span<const CombinationTerm> terms);

  // Returns the stresses at the integration points: see StressAtPoints.
  Stresses PointStress(const ElasticitySolution& solution);

 private:
  struct State;
  explicit ElasticSystem(std::unique_ptr<State> state);
  void Finish(ElasticitySolution& solution);

  std::unique_ptr<State> state_;
};

// Solves one case; fails as ElasticSystem does.
absl::StatusOr<ElasticitySolution> SolveElasticity(const mesh::TetrahedralMesh& mesh,
                                                   const AnalysisCase& analysis,
                                                   const ElasticityOptions& options = {});

}  // namespace mortise::simulator
