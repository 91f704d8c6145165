#include "services/simulator/analysis/design_solver.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/simulator/analysis/design_gradients.h"
#include "services/simulator/analysis/mesh_analysis.h"

namespace mortise::simulator {

std::vector<NamedLoadCase> LoadCasesOf(const DesignModel& model) {
  const bool is_warm = model.heat && model.reference_temperature;
  const LoadCase& common = model.analysis;
  if (model.load_cases.empty()) return {{"loads", common, is_warm}};
  std::vector<NamedLoadCase> load_cases;
  for (const NamedLoadCase& own : model.load_cases) {
    NamedLoadCase& whole = load_cases.emplace_back(NamedLoadCase{own.name, own.loads, is_warm});
    LoadCase& loads = whole.loads;
    loads.forces.insert(loads.forces.end(), common.forces.begin(), common.forces.end());
    loads.pressures.insert(loads.pressures.end(), common.pressures.begin(), common.pressures.end());
    loads.gravity += common.gravity;
    if (!loads.rotation) loads.rotation = common.rotation;
  }
  return load_cases;
}

DesignSolver::DesignSolver(const DesignModel& model, const DesignAnalysisOptions& options,
                           CaseDetails details, std::vector<std::string> gradients)
    : model_(model),
      options_(options),
      load_cases_(LoadCasesOf(model)),
      details_(details),
      gradients_(std::move(gradients)) {
  details_.error = details.error || options.wanted_error > 0;
}

absl::StatusOr<HeatSolution> DesignSolver::Heat(const mesh::TetrahedralMesh& mesh) const {
  Begin("heat");
  HeatOptions heat;
  heat.cholesky.memory_limit = options_.elasticity.solver.memory_limit;
  heat.threads = options_.elasticity.threads;
  return SolveHeat(mesh, *model_.heat, heat);
}

absl::StatusOr<SolvedDesign> DesignSolver::Solve(const mesh::TetrahedralMesh& mesh,
                                                 bool heat_wanted) const {
  SolvedDesign solved;
  if (heat_wanted || load_cases_.front().thermal_stress) {
    MORTISE_ASSIGN_OR_RETURN(solved.heat, Heat(mesh));
  }
  const double limit = options_.elasticity.solver.memory_limit;
  if (load_cases_.size() > 1) {
    // All of their solutions are kept: 136 bytes a node, two and a half times what it counts.
    MORTISE_RETURN_IF_ERROR(
        CheckMemory(mesh.nodes.cols(), mesh.tetrahedra.cols(), 3 * load_cases_.size(), limit));
  }
  ElasticityOptions elasticity = options_.elasticity;
  elasticity.solver.loads = static_cast<int>(load_cases_.size());
  std::string stage = StageOf(0);
  elasticity.before_recovery = [&] {
    Begin(load_cases_.size() > 1 ? stage + ": stresses" : "stresses");
  };
  Begin(stage);
  MORTISE_ASSIGN_OR_RETURN(
      ElasticSystem system,
      ElasticSystem::Create(mesh, model_.analysis.materials, model_.analysis.supports, elasticity));
  ThreadTeam team(elasticity.threads);
  for (std::size_t i = 0; i < load_cases_.size(); ++i) {
    if (i > 0) {
      stage = StageOf(i);
      Begin(stage);
    }
    LoadCase loads = load_cases_[i].loads;
    if (load_cases_[i].thermal_stress) {
      loads.temperature = solved.heat->temperature.array() - *model_.reference_temperature;
    }
    SolvedCase& of = solved.cases.emplace_back();
    of.name = load_cases_[i].name;
    MORTISE_ASSIGN_OR_RETURN(of.solution, system.Solve(loads));
    AddDetails(mesh, team, of);
  }
  if (options_.motion != nullptr && !options_.motion->faces.empty() &&
      AllowsGradients(model_, *options_.motion)) {
    const auto needs = options_.custom_metrics.NeedsOf(gradients_);
    auto gradients = GradientsUnderLoads(
        {mesh, model_, load_cases_, solved.cases, system, options_.custom_metrics,
         options_.parameters, limit, elasticity.threads},
        *options_.motion, needs.metrics, needs.calls);
    // Where parts do not stay in touch there are none; everything else is a failure.
    if (gradients.ok()) {
      solved.gradients = *std::move(gradients);
    } else if (!absl::IsFailedPrecondition(gradients.status())) {
      return gradients.status();
    }
  }
  return solved;
}

void DesignSolver::AddDetails(const mesh::TetrahedralMesh& mesh, ThreadTeam& team,
                              SolvedCase& of) const {
  const std::vector<Material>& materials = model_.analysis.materials;
  const ElasticitySolution& solution = of.solution;
  if (details_.error) {
    of.error = EstimateError(mesh, materials, solution.displacement, solution.temperature, team,
                             solution.traction);
  }
  if (details_.spread) {
    of.spread = SpreadOf(mesh, materials, solution.displacement, solution.temperature, team);
  }
}

void DesignSolver::Begin(std::string stage) const {
  if (options_.progress != nullptr) options_.progress->Begin(std::move(stage));
}

std::string DesignSolver::StageOf(std::size_t index) const {
  if (load_cases_.size() == 1) return "solution";
  return absl::StrCat("load case ", index + 1, " of ", load_cases_.size());
}

}  // namespace mortise::simulator
