// Solves K u = f for the free displacements of a mesh: by a factor of K or by iteration.
//
// Analyse the topology once, prepare for the values of each matrix on it, solve for as many loads
// as there are:
//
//   MORTISE_ASSIGN_OR_RETURN(auto solver, LinearSolver::Create(mesh, pattern, fixed, {}, options));
//   MORTISE_RETURN_IF_ERROR(solver->Prepare(stiffness, mesh.nodes));
//   MORTISE_ASSIGN_OR_RETURN(Eigen::Matrix3Xd u, solver->Solve(load));
//
// The result is the same to the bit on any number of threads.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/linear/block_matrix.h"
#include "common/fem/linear/multigrid_options.h"
#include "common/fem/linear/node_frames.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

enum class SolverKind {
  kAutomatic,  // by size and shape, see ChooseSolver
  kDirect,     // supernodal Cholesky (CHOLMOD): heavy to prepare, then each load is cheap
  kIterative,  // conjugate gradients with multigrid: light to prepare, each load takes its time
};

struct SolverOptions {
  SolverKind kind = SolverKind::kAutomatic;

  // The number of loads that each matrix will have, for kAutomatic to choose by.
  int loads = 1;

  // RESOURCE_EXHAUSTED if more bytes would be needed, found out before they are allocated.
  double memory_limit = 8e9;

  // The error at which the iteration stops, relative to the solution in the norm of energy, √(uᵀ K
  // u), as the preconditioner estimates it, √(rᵀ M r / fᵀ M f) with the true residual r. Where
  // rounding keeps it above, the iteration stops where rounding does, and SolverSummary::error
  // tells.
  double tolerance = 1e-10;

  int maximum_iterations = 2000;  // NOT_CONVERGED beyond

  // The number of iterations for all loads of a matrix that a factor is worth: the iteration ends
  // NOT_CONVERGED as soon as it foresees more. kAutomatic has its own.
  double patience = std::numeric_limits<double>::infinity();
  int threads = 1;  // of the iterative solver; the direct one uses one

  // True if the caller corrects what is solved and judges its error (exact_correction.h): a
  // factor's solutions are not refused for what rounding has left of them.
  bool is_corrected = false;

  MultigridOptions multigrid;  // of the iterative solver

  // Called before each iteration with the relative error, and before preparing with −1. What it
  // returns other than OK ends the solution with that status (e.g. absl::CancelledError()).
  std::function<absl::Status(int iteration, double error)> progress;
};

// How the solution went.
struct SolverSummary {
  SolverKind kind = SolverKind::kAutomatic;  // the one used
  int unknowns = 0;
  double bytes = 0;             // of the factor or of the preconditioner
  double factor_entries = 0;    // direct
  double factor_flops = 0;      // direct
  int levels = 0;               // iterative
  int iterations = 0;           // iterative, of the last load
  double error = 0;             // of the last load: see SolverOptions::tolerance; iterative only,
                                // unless ElasticSystem has corrected it
  double residual = 0;          // |f − K u| / |f| of free directions, of the last load
  double condition = 0;         // estimate; iterative: of the preconditioned matrix
  double analysis_seconds = 0;  // Create
  double preparation_seconds = 0;
  double solution_seconds = 0;  // the last call
};

class LinearSolver {
 public:
  // `fixed` is 3 × nodes, non-zero where a displacement is prescribed and thus not an unknown,
  // counted like the matrices' rows along `frames`. Mesh and frames are read now only.
  // RESOURCE_EXHAUSTED; INVALID_ARGUMENT naming "fixed" or "tolerance".
  static absl::StatusOr<std::unique_ptr<LinearSolver>> Create(
      const mesh::TetrahedralMesh& mesh, std::shared_ptr<const BlockPattern> pattern,
      const Eigen::Array3Xi& fixed, const NodeFrames& frames, const SolverOptions& options = {});

  virtual ~LinearSolver() = default;

  // Takes a symmetric positive definite matrix on the pattern: a stiffness, or one shifted by a
  // mass. `positions`: 3 × nodes, m, of the mesh it belongs to. FAILED_PRECONDITION, reason
  // SINGULAR, if the matrix is not positive definite. One that only rounding makes so, of something
  // free to move, may pass; loads that move it are refused by Solve. CheckRigidMotion tells
  // (free_motions.h).
  virtual absl::Status Prepare(std::shared_ptr<const BlockMatrix> matrix,
                               const Eigen::Matrix3Xd& positions) = 0;

  // Returns the displacements (3 × nodes, zero where fixed) under the loads of free directions (3 ×
  // nodes), for each load. INVALID_ARGUMENT naming "loads[i]" if one is not finite or of another
  // size; FAILED_PRECONDITION, reason NOT_CONVERGED with the error reached, or SINGULAR.
  virtual absl::StatusOr<std::vector<Eigen::Matrix3Xd>> SolveAll(
      const std::vector<Eigen::Matrix3Xd>& loads) = 0;

  absl::StatusOr<Eigen::Matrix3Xd> Solve(const Eigen::Matrix3Xd& load);

  // Returns a rough solution, to a hundredth in the norm of energy where rounding allows: what
  // corrections of others need. Fails as SolveAll does.
  virtual absl::StatusOr<Eigen::Matrix3Xd> SolveRoughly(const Eigen::Matrix3Xd& load) = 0;

  virtual const SolverSummary& summary() const = 0;
};

// The method that kAutomatic stands for.
struct SolverChoice {
  SolverKind kind = SolverKind::kDirect;
  double patience = 0;  // of the iteration, before a factor is made after all
};

// Chooses by the flops of a factor, which take a tenth of a second to estimate: where that takes no
// longer than the usual iterations for so many loads, the factor; else the iteration, until it
// foresees that a factor would have been quicker, as for plates of stretched elements or more loads
// than were told. It looks after a tenth of what the factor takes, so that no more is lost. A
// factor beyond the limit of memory gives way to the iteration.
SolverChoice ChooseSolver(const BlockPattern& pattern, int loads = 1);

// Fails with INVALID_ARGUMENT naming "loads[i]" unless all have `nodes` columns and are finite.
absl::Status CheckLoads(const std::vector<Eigen::Matrix3Xd>& loads, int nodes);

}  // namespace mortise::simulator
