#include "common/fem/problems/elasticity.h"

#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/elapsed_time.h"
#include "common/base/errors.h"
#include "common/fem/elements/internal_forces.h"
#include "common/fem/elements/loads.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/elements/supports.h"
#include "common/fem/linear/exact_correction.h"
#include "common/fem/linear/thread_team.h"
#include "common/fem/mechanisms/free_motions.h"
#include "common/fem/stress/stress_recovery.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

// What a solution is corrected to, in the norm of energy, where rounding has spoilt it.
constexpr double kWantedError = 1e-10;

// An error beyond which a solution is of no use.
constexpr double kUseless = 1e-3;

// The relative error that rounding of K leaves in an iterated solution is at most about the share
// that a unit of rounding, spread over all stiffnesses, has in its energy. Below this it is left.
constexpr double kNoticeable = 1e-9;

Eigen::VectorXd SafetyFactors(const std::vector<Material>& materials,
                              const Eigen::VectorXd& stress) {
  Eigen::VectorXd factors(stress.size());
  for (Eigen::Index p = 0; p < stress.size(); ++p) {
    factors[p] = materials[p].strength > 0 && stress[p] > 0
                     ? materials[p].strength / stress[p]
                     : std::numeric_limits<double>::infinity();
  }
  return factors;
}

}  // namespace

struct ElasticSystem::State {
  const mesh::TetrahedralMesh& mesh;
  std::vector<Material> materials;
  ElasticityOptions options;
  ThreadTeam team;
  std::vector<Support> supports;
  Constraints constraints;
  std::shared_ptr<const BlockMatrix> stiffness;  // in the constraints' frames
  std::unique_ptr<LinearSolver> solver;
  double assembly_seconds = 0;
  double preparation_seconds = 0;
  Clock::time_point started;                 // of the work on the next solution
  double error = 0;                          // of the last one, estimated, in the norm of energy
  std::optional<PartNodes> part_nodes = {};  // these two where stress is recovered
  std::optional<PartSurface> surface = {};

  Eigen::Matrix3Xd FreePart(const Eigen::Matrix3Xd& vectors) const {
    return (constraints.fixed == 0).select(vectors.array(), 0.0).matrix();
  }

  // K times displacements along the frames, without the rounding of K.
  Eigen::Matrix3Xd MultiplyExactly(const Eigen::Matrix3Xd& vectors) {
    const NodeFrames& frames = constraints.frames;
    return frames.ToFrames(InternalForces(mesh, materials, frames.ToSpace(vectors), team));
  }

  // Found when first asked for.
  const PartSurface& Surface() {
    if (!surface) {
      part_nodes.emplace(mesh);
      surface.emplace(mesh, *part_nodes);
    }
    return *surface;
  }

  absl::StatusOr<Eigen::Matrix3Xd> SolveByAnyMeans(
      const std::function<absl::StatusOr<Eigen::Matrix3Xd>(LinearSolver&)>& solve);
  bool NeedsCorrection(const Eigen::Matrix3Xd& loads, const Eigen::Matrix3Xd& displacement) const;
  absl::StatusOr<Eigen::Matrix3Xd> SolveInFrames(const Eigen::Matrix3Xd& loads);
  absl::StatusOr<Eigen::Matrix3Xd> SolveAtRest(const Eigen::Matrix3Xd& loads);
  void Summarise(ElasticitySolution& solution);
};

absl::StatusOr<Eigen::Matrix3Xd> ElasticSystem::State::SolveInFrames(
    const Eigen::Matrix3Xd& loads) {
  Eigen::Matrix3Xd rest = loads;
  if (!constraints.displacement.isZero(0)) rest -= MultiplyExactly(constraints.displacement);
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd displacement, SolveAtRest(rest));
  return displacement + constraints.displacement;
}

// Solves by a factor, if that fits into the memory, where an iteration that was asked for does not
// converge: over sheets of very thin elements it may not.
absl::StatusOr<Eigen::Matrix3Xd> ElasticSystem::State::SolveByAnyMeans(
    const std::function<absl::StatusOr<Eigen::Matrix3Xd>(LinearSolver&)>& solve) {
  absl::StatusOr<Eigen::Matrix3Xd> solution = solve(*solver);
  if (solution.ok() || DetailOf(solution.status()).reason != "NOT_CONVERGED") return solution;
  SolverOptions direct = options.solver;
  direct.kind = SolverKind::kDirect;
  direct.threads = options.threads;
  direct.is_corrected = true;
  direct.memory_limit -= solver->summary().bytes;
  auto factor = LinearSolver::Create(mesh, stiffness->pattern(), constraints.fixed,
                                     constraints.frames, direct);
  if (absl::IsResourceExhausted(factor.status())) return solution;
  MORTISE_RETURN_IF_ERROR(factor.status());
  MORTISE_RETURN_IF_ERROR((*factor)->Prepare(stiffness, mesh.nodes));
  solver = *std::move(factor);
  return solve(*solver);
}

// A factor's solution costs little to correct, one that is iterated as much as before.
bool ElasticSystem::State::NeedsCorrection(const Eigen::Matrix3Xd& loads,
                                           const Eigen::Matrix3Xd& displacement) const {
  if (displacement.isZero(0)) return false;
  const SolverSummary& summary = solver->summary();
  if (summary.kind == SolverKind::kDirect || summary.error > kWantedError) return true;
  double scale = 0;
  for (int v = 0; v < stiffness->nodes(); ++v) {
    scale += stiffness->blocks()[stiffness->starts()[v + 1] - 1].trace() *
             displacement.col(v).squaredNorm();
  }
  const double energy = (loads.array() * displacement.array()).sum();
  return std::numeric_limits<double>::epsilon() * scale > kNoticeable * energy;
}

absl::StatusOr<Eigen::Matrix3Xd> ElasticSystem::State::SolveAtRest(const Eigen::Matrix3Xd& loads) {
  const Eigen::Matrix3Xd free_loads = FreePart(loads);
  MORTISE_ASSIGN_OR_RETURN(Eigen::Matrix3Xd displacement,
                           SolveByAnyMeans([&](LinearSolver& by) { return by.Solve(free_loads); }));
  error = solver->summary().error;
  if (!NeedsCorrection(free_loads, displacement)) return displacement;
  const CorrectedSystem exact{
      [this](const Eigen::Matrix3Xd& x) { return FreePart(MultiplyExactly(x)); },
      [this](const Eigen::Matrix3Xd& b) {
        return SolveByAnyMeans([&](LinearSolver& by) { return by.SolveRoughly(b); });
      }};
  MORTISE_ASSIGN_OR_RETURN(const Correction correction,
                           CorrectSolution(exact, free_loads, kWantedError, displacement));
  error = correction.error;
  if (error < kUseless) return displacement;
  return PreconditionFailed(
      "SINGULAR",
      absl::StrFormat("rounding leaves a relative error of %.2g in the solution: stiffnesses or "
                      "sizes differ beyond what numbers can hold",
                      error),
      "materials");
}

// Reactions, energies and balances of a displacement.
void ElasticSystem::State::Summarise(ElasticitySolution& solution) {
  const NodeFrames& frames = constraints.frames;
  const Eigen::Matrix3Xd internal =
      frames.ToFrames(InternalForces(mesh, materials, solution.displacement, team));
  const Eigen::Matrix3Xd unbalanced = internal - frames.ToFrames(solution.load);
  const Eigen::Matrix3Xd free = FreePart(unbalanced);
  solution.reaction = frames.ToSpace(unbalanced - free);
  ElasticitySummary& summary = solution.summary;
  summary.nodes = static_cast<int>(mesh.nodes.cols());
  summary.elements = static_cast<int>(mesh.tetrahedra.cols());
  summary.solver = solver->summary();
  summary.solver.error = error;
  summary.total_load = solution.load.rowwise().sum();
  summary.total_reaction = solution.reaction.rowwise().sum();
  const double scale =
      solution.load.colwise().norm().sum() + solution.reaction.colwise().norm().sum();
  summary.imbalance = scale > 0 ? (summary.total_load + summary.total_reaction).norm() / scale : 0;
  const double internal_size = internal.norm();
  summary.residual = internal_size > 0 ? free.norm() / internal_size : 0;
  summary.compliance = (solution.load.array() * solution.displacement.array()).sum();
  summary.strain_energy =
      0.5 * (summary.compliance +
             (unbalanced.array() * frames.ToFrames(solution.displacement).array()).sum());
  Eigen::Index node = 0;
  summary.maximum_displacement = solution.displacement.colwise().norm().maxCoeff(&node);
  summary.maximum_displacement_node = static_cast<int>(node);
}

ElasticSystem::ElasticSystem(std::unique_ptr<State> state) : state_(std::move(state)) {}
ElasticSystem::~ElasticSystem() = default;
ElasticSystem::ElasticSystem(ElasticSystem&&) noexcept = default;
ElasticSystem& ElasticSystem::operator=(ElasticSystem&&) noexcept = default;

absl::StatusOr<ElasticSystem> ElasticSystem::Create(const mesh::TetrahedralMesh& mesh,
                                                    std::vector<Material> materials,
                                                    const std::vector<Support>& supports,
                                                    const ElasticityOptions& options) {
  const auto start = Clock::now();
  MORTISE_RETURN_IF_ERROR(CheckMesh(mesh));
  MORTISE_RETURN_IF_ERROR(CheckModel(mesh, materials, supports));
  MORTISE_ASSIGN_OR_RETURN(Constraints constraints, CollectConstraints(mesh, supports));
  MORTISE_RETURN_IF_ERROR(CheckRigidMotion(mesh, constraints));
  ThreadTeam team(options.threads);
  MORTISE_ASSIGN_OR_RETURN(BlockMatrix assembled,
                           AssembleStiffness(mesh, materials, constraints.frames, team));
  const auto stiffness = std::make_shared<const BlockMatrix>(std::move(assembled));
  const double assembly_seconds = SecondsSince(start);
  const auto preparation_start = Clock::now();
  SolverOptions solver_options = options.solver;
  solver_options.threads = options.threads;
  solver_options.is_corrected = true;
  MORTISE_ASSIGN_OR_RETURN(auto solver,
                           LinearSolver::Create(mesh, stiffness->pattern(), constraints.fixed,
                                                constraints.frames, solver_options));
  MORTISE_RETURN_IF_ERROR(solver->Prepare(stiffness, mesh.nodes));
  return ElasticSystem(std::unique_ptr<State>(
      new State{mesh, std::move(materials), options, ThreadTeam(options.threads), supports,
                std::move(constraints), stiffness, std::move(solver), assembly_seconds,
                SecondsSince(preparation_start), start}));
}

absl::StatusOr<ElasticitySolution> ElasticSystem::Solve(const LoadCase& loads) {
  State& state = *state_;
  const bool first = state.assembly_seconds > 0;
  if (!first) state.started = Clock::now();
  auto start = Clock::now();
  MORTISE_RETURN_IF_ERROR(CheckLoads(state.mesh, loads));
  ElasticitySolution solution;
  MORTISE_ASSIGN_OR_RETURN(solution.load, AssembleLoads(state.mesh, state.materials, loads));
  solution.temperature = loads.temperature;
  if (state.options.recover_stress) {
    solution.traction = TractionOn(state.mesh, state.Surface(), state.supports, loads);
  }
  solution.summary.assembly_seconds = state.assembly_seconds + SecondsSince(start);
  start = Clock::now();
  const NodeFrames& frames = state.constraints.frames;
  MORTISE_ASSIGN_OR_RETURN(solution.displacement,
                           state.SolveInFrames(frames.ToFrames(solution.load)));
  solution.displacement = frames.ToSpace(std::move(solution.displacement));
  solution.summary.solution_seconds = SecondsSince(start);
  solution.summary.preparation_seconds = state.preparation_seconds;
  state.assembly_seconds = state.preparation_seconds = 0;
  Finish(solution);
  return solution;
}

absl::StatusOr<Eigen::Matrix3Xd> ElasticSystem::SolveForces(const Eigen::Matrix3Xd& forces) {
  const NodeFrames& frames = state_->constraints.frames;
  MORTISE_ASSIGN_OR_RETURN(Eigen::Matrix3Xd displacement,
                           state_->SolveAtRest(frames.ToFrames(forces)));
  return frames.ToSpace(std::move(displacement));
}

absl::StatusOr<ElasticitySolution> ElasticSystem::Combine(std::span<const CombinationTerm> terms) {
  State& state = *state_;
  state.started = Clock::now();
  const Eigen::Index nodes = state.mesh.nodes.cols();
  ElasticitySolution sum;
  sum.displacement = sum.load = Eigen::Matrix3Xd::Zero(3, nodes);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const ElasticitySolution* solution = terms[i].solution;
    if (!std::isfinite(terms[i].factor) || solution == nullptr ||
        solution->displacement.cols() != nodes) {
      return InvalidField(absl::StrCat("terms[", i, "]"),
                          "must be a finite factor and a solution of this system");
    }
    sum.displacement += terms[i].factor * solution->displacement;
    sum.load += terms[i].factor * solution->load;
    if (i == 0) {
      sum.traction = solution->traction;
      sum.traction.at_nodes *= terms[i].factor;
    } else {
      sum.traction.at_nodes += terms[i].factor * solution->traction.at_nodes;
    }
    if (solution->temperature.size() == 0) continue;
    if (sum.temperature.size() == 0) sum.temperature = Eigen::VectorXd::Zero(nodes);
    sum.temperature += terms[i].factor * solution->temperature;
  }
  Finish(sum);
  return sum;
}

Stresses ElasticSystem::PointStress(const ElasticitySolution& solution) {
  return StressAtPoints(state_->mesh, state_->materials, solution.displacement,
                        solution.temperature, state_->team);
}

void ElasticSystem::Finish(ElasticitySolution& solution) {
  State& state = *state_;
  if (state.options.before_recovery) state.options.before_recovery();
  state.Summarise(solution);
  const auto start = Clock::now();
  if (state.options.recover_stress) {
    const PartSurface& surface = state.Surface();
    NodalStress nodal = RecoverStress({state.mesh, state.materials, solution.displacement,
                                       solution.temperature, solution.traction},
                                      *state.part_nodes, surface, state.team);
    solution.stress = std::move(nodal.stress);
    solution.von_mises = std::move(nodal.von_mises);
    solution.maximum_principal = std::move(nodal.maximum_principal);
    solution.part_maximum_von_mises = std::move(nodal.part_maximum);
    solution.part_safety_factor = SafetyFactors(state.materials, solution.part_maximum_von_mises);
  }
  solution.summary.recovery_seconds = SecondsSince(start);
  solution.summary.seconds = SecondsSince(state.started);
}

absl::StatusOr<ElasticitySolution> SolveElasticity(const mesh::TetrahedralMesh& mesh,
                                                   const AnalysisCase& analysis,
                                                   const ElasticityOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(ElasticSystem system, ElasticSystem::Create(mesh, analysis.materials,
                                                                       analysis.supports, options));
  return system.Solve(analysis);
}

}  // namespace mortise::simulator
