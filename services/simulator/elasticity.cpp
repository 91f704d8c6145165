#include "services/simulator/elasticity.h"

#include <chrono>
#include <cmath>

#include "common/base/errors.h"
#include "services/simulator/loads.h"
#include "services/simulator/stiffness.h"
#include "services/simulator/stress_recovery.h"
#include "services/simulator/supports.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Eigen::Matrix3Xd FreePart(const Eigen::Matrix3Xd& vectors, const Eigen::Array3Xi& fixed) {
  return (fixed == 0).select(vectors.array(), 0.0).matrix();
}

// Reactions, energies and balances of a displacement.
void Summarise(const BlockMatrix& stiffness, const Eigen::Matrix3Xd& loads,
               const Constraints& constraints, ElasticitySolution& solution) {
  const Eigen::Matrix3Xd internal = stiffness.Multiply(solution.displacement);
  const Eigen::Matrix3Xd unbalanced = internal - loads;
  const Eigen::Matrix3Xd free = FreePart(unbalanced, constraints.fixed);
  solution.reaction = unbalanced - free;
  ElasticitySummary& summary = solution.summary;
  summary.total_load = loads.rowwise().sum();
  summary.total_reaction = solution.reaction.rowwise().sum();
  const double scale = loads.colwise().norm().sum() + solution.reaction.colwise().norm().sum();
  summary.imbalance = scale > 0 ? (summary.total_load + summary.total_reaction).norm() / scale : 0;
  const double internal_size = internal.norm();
  summary.residual = internal_size > 0 ? free.norm() / internal_size : 0;
  summary.strain_energy = 0.5 * (internal.array() * solution.displacement.array()).sum();
  summary.compliance = (loads.array() * solution.displacement.array()).sum();
  Eigen::Index node = 0;
  summary.maximum_displacement = solution.displacement.colwise().norm().maxCoeff(&node);
  summary.maximum_displacement_node = static_cast<int>(node);
}

}  // namespace

absl::StatusOr<ElasticitySolution> SolveElasticity(const mesh::TetrahedralMesh& mesh,
                                                   const AnalysisCase& analysis,
                                                   const ElasticityOptions& options) {
  const auto start = Clock::now();
  MORTISE_RETURN_IF_ERROR(CheckCase(analysis, mesh));
  MORTISE_ASSIGN_OR_RETURN(const Constraints constraints, CollectConstraints(mesh, analysis));
  MORTISE_RETURN_IF_ERROR(CheckRigidMotion(mesh, constraints));
  MORTISE_ASSIGN_OR_RETURN(const BlockMatrix stiffness,
                           AssembleStiffness(mesh, analysis.materials));
  const Eigen::Matrix3Xd loads = AssembleLoads(mesh, analysis);
  ElasticitySolution solution;
  ElasticitySummary& summary = solution.summary;
  summary.nodes = static_cast<int>(mesh.nodes.cols());
  summary.elements = static_cast<int>(mesh.tetrahedra.cols());
  summary.assembly_seconds = SecondsSince(start);

  const auto solution_start = Clock::now();
  MORTISE_ASSIGN_OR_RETURN(SparseCholesky factor,
                           SparseCholesky::Create(stiffness, constraints.fixed, options.cholesky));
  summary.cholesky = factor.summary();
  solution.displacement = constraints.displacement;
  // The second round refines: it removes most of the rounding of slender, badly conditioned frames.
  for (int round = 0; round < 2; ++round) {
    const Eigen::Matrix3Xd rest = loads - stiffness.Multiply(solution.displacement);
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd correction, factor.Solve(rest));
    solution.displacement += correction;
  }
  if (!solution.displacement.allFinite()) {
    return PreconditionFailed("SINGULAR", "the solution is not finite", "supports");
  }
  Summarise(stiffness, loads, constraints, solution);
  summary.solution_seconds = SecondsSince(solution_start);

  const auto recovery_start = Clock::now();
  if (options.recover_stress) {
    NodalStress nodal = RecoverStress(mesh, analysis.materials, solution.displacement);
    solution.stress = std::move(nodal.stress);
    solution.von_mises = std::move(nodal.von_mises);
    solution.part_maximum_von_mises = std::move(nodal.part_maximum);
  }
  summary.recovery_seconds = SecondsSince(recovery_start);
  summary.seconds = SecondsSince(start);
  return solution;
}

}  // namespace mortise::simulator
