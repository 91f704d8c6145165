#include "services/simulator/analysis/design_analysis.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/elapsed_time.h"
#include "common/base/errors.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "common/mesh/tetrahedra/curved_elements.h"
#include "services/simulator/analysis/analysis_notes.h"
#include "services/simulator/analysis/custom_metrics.h"
#include "services/simulator/analysis/design_gradients.h"
#include "services/simulator/analysis/design_solver.h"
#include "services/simulator/analysis/mesh_analysis.h"
#include "services/simulator/analysis/metric_values.h"
#include "services/simulator/analysis/place_functions.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

// By name of the metric, or text of the call.
using Gradients = std::map<std::string, Eigen::VectorXd>;

std::vector<SolidPart> PartsOf(const DesignModel& model) {
  if (!model.parts.empty()) return model.parts;
  std::vector<SolidPart> parts;
  for (std::size_t p = 0; p < model.analysis.materials.size(); ++p) {
    SolidPart& part = parts.emplace_back();
    part.surface = mesh::PartSurface(model.surface, static_cast<int>(p));
    part.volume = mesh::ComputeMassProperties(part.surface).volume;
    part.density = model.analysis.materials[p].density;
  }
  return parts;
}

// The stages of one more mesh: itself, temperatures, and each load case with its stresses.
int StagesOfMesh(const DesignModel& model, const DesignAnalysis& analysis) {
  return 1 + (model.heat ? 1 : 0) + 2 * static_cast<int>(analysis.cases.size());
}

// Tells that the mesh is refined, where it is, and how far off the last one was.
void TellRefinement(const DesignModel& model, const DesignAnalysis& analysis, int step,
                    const DesignAnalysisOptions& options) {
  double error = 0;
  for (const SolvedCase& solved : analysis.cases) error = std::max(error, solved.error->relative);
  if (options.progress == nullptr || error <= options.wanted_error) return;
  options.progress->Add(StagesOfMesh(model, analysis));
  options.progress->Within(absl::StrFormat("refining, step %d, error %.2g %%", step, 100 * error));
  options.progress->Begin("mesh");
}

// Solves on finer meshes than `straight`, which has straight sides, until the error is as wanted.
absl::Status Refine(const DesignSolver& solver, bool heat_wanted, const DesignModel& model,
                    mesh::TetrahedralMesh straight, const DesignAnalysisOptions& options,
                    DesignAnalysis& analysis, Gradients& gradients) {
  Refinement refinement({.wanted_error = options.wanted_error,
                         .mesh = options.mesh,
                         .memory_limit = options.elasticity.solver.memory_limit});
  while (true) {
    std::vector<ErrorEstimate> estimates;
    for (const SolvedCase& solved : analysis.cases) estimates.push_back(*solved.error);
    TellRefinement(model, analysis, static_cast<int>(refinement.steps().size()) + 1, options);
    MORTISE_ASSIGN_OR_RETURN(auto finer, refinement.Next(straight, estimates));
    if (!finer) break;
    straight = *std::move(finer);
    mesh::TetrahedralMesh curved = mesh::WithCurvedElements(model.surface, straight);
    absl::StatusOr<SolvedDesign> solved = solver.Solve(curved, heat_wanted);
    if (absl::IsResourceExhausted(solved.status())) {
      refinement.GiveUp(std::string(solved.status().message()));
      break;
    }
    MORTISE_RETURN_IF_ERROR(solved.status());
    analysis.mesh = std::move(curved);
    analysis.cases = std::move(solved->cases);
    analysis.heat = std::move(solved->heat);
    for (auto& [name, gradient] : solved->gradients) gradients[name] = std::move(gradient);
  }
  if (options.progress != nullptr) options.progress->Within("");
  analysis.refinements = refinement.steps();
  analysis.shortfall = refinement.shortfall();
  return absl::OkStatus();
}

// What all paths rely on; the path with a mesh checks the rest.
absl::Status CheckModel(const DesignModel& model, bool needs_surface) {
  const bool by_surface = needs_surface || model.parts.empty();
  if (by_surface) MORTISE_RETURN_IF_ERROR(mesh::CheckAssembly(model.surface));
  const std::size_t parts = by_surface ? model.surface.part_names.size() : model.parts.size();
  if (model.analysis.materials.size() != parts) {
    return InvalidField("materials", "there must be one for each part");
  }
  for (std::size_t p = 0; p < model.analysis.materials.size(); ++p) {
    MORTISE_RETURN_IF_ERROR(
        CheckMaterial(model.analysis.materials[p], absl::StrCat("materials[", p, "]")));
  }
  return absl::OkStatus();
}

absl::Status CheckMetricNames(const std::vector<std::string>& metrics,
                              const parametric::MetricExpressions& own) {
  if (metrics.empty()) return InvalidField("metrics", "ask for at least one metric");
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    if (FindMetric(metrics[i]) != nullptr || own.Find(metrics[i]) >= 0) continue;
    const std::string offered = absl::StrJoin(
        OfferedMetrics(), ", ",
        [](std::string* out, const MetricDescription& metric) { out->append(metric.name); });
    return InvalidField(absl::StrCat("metrics[", i, "]"),
                        absl::StrCat("'", metrics[i], "' is not offered; there are ", offered));
  }
  return absl::OkStatus();
}

absl::StatusOr<ModalSolution> Vibrate(const DesignModel& model, const mesh::TetrahedralMesh& mesh,
                                      int count, const DesignAnalysisOptions& options) {
  const double limit = options.elasticity.solver.memory_limit;
  MORTISE_RETURN_IF_ERROR(CheckMemory(mesh.nodes.cols(), mesh.tetrahedra.cols(), 1, limit, count));
  ModalOptions modal;
  modal.count = count;
  modal.threads = options.elasticity.threads;
  modal.cholesky.memory_limit = limit;
  absl::StatusOr<ModalSolution> vibration =
      FindModes(mesh, model.analysis.materials, model.analysis.supports, modal);
  if (DetailOf(vibration.status()).field == "count") {
    return WithDetail(vibration.status(), {"FIELD_INVALID", "modes"});
  }
  return vibration;
}

// Whether any of what is needed tells how the stress is spread over the volume.
bool NeedsSpread(const parametric::MetricExpressions::Needs& needs) {
  return std::any_of(needs.metrics.begin(), needs.metrics.end(),
                     [](const std::string& name) {
                       const MetricDescription* const known = FindMetric(name);
                       return known != nullptr && IsOfSpread(known->metric);
                     }) ||
         std::any_of(needs.calls.begin(), needs.calls.end(),
                     [](const parametric::MetricCall& call) { return IsOfSpread(call); });
}

// Points are where their coordinates say, whatever the shape.
bool OfPointsAlone(const parametric::MetricCall& call, const parametric::MetricExpressions& own) {
  return std::all_of(call.places.begin(), call.places.end(),
                     [&own](const std::string& place) { return own.HasPoint(place); });
}

}  // namespace

bool IsLoaded(const DesignModel& model) {
  const auto loads_something = [](const LoadCase& loads) {
    return !loads.forces.empty() || !loads.pressures.empty() || !loads.tractions.empty() ||
           !loads.point_forces.empty() || !loads.nodal_forces.empty() || !loads.gravity.isZero(0) ||
           loads.rotation || loads.body_force || loads.temperature.size() > 0;
  };
  return (model.heat && model.reference_temperature) || loads_something(model.analysis) ||
         std::any_of(model.load_cases.begin(), model.load_cases.end(),
                     [&](const NamedLoadCase& named) { return loads_something(named.loads); }) ||
         std::any_of(model.analysis.supports.begin(), model.analysis.supports.end(),
                     [](const Support& support) { return !support.displacement.isZero(0); });
}

bool HasGradient(const std::string& metric, const parametric::MetricExpressions& own) {
  const parametric::MetricExpressions::Needs needs = own.NeedsOf(std::vector{metric});
  return std::all_of(needs.metrics.begin(), needs.metrics.end(),
                     [](const std::string& name) {
                       const MetricDescription* const known = FindMetric(name);
                       return known != nullptr && known->has_gradient;
                     }) &&
         std::all_of(needs.calls.begin(), needs.calls.end(),
                     [](const parametric::MetricCall& call) {
                       return call.function->source == parametric::MetricFunctionSource::kShape ||
                              HasGradientUnderLoads(call);
                     });
}

MetricDemands DemandsOf(const std::vector<std::string>& metrics,
                        const parametric::MetricExpressions& own) {
  const parametric::MetricExpressions::Needs needs = own.NeedsOf(metrics);
  MetricDemands demands;
  for (const std::string& name : needs.metrics) {
    const MetricDescription* const metric = FindMetric(name);
    if (metric == nullptr) continue;
    demands.loads = demands.loads || metric->source == MetricSource::kLoads;
    demands.heat = demands.heat || metric->source == MetricSource::kHeat;
    demands.modes = demands.modes || metric->source == MetricSource::kModes;
    demands.airflow = demands.airflow || metric->source == MetricSource::kAirflow;
    demands.surface = demands.surface || metric->source == MetricSource::kOutside;
  }
  for (const parametric::MetricCall& call : needs.calls) {
    using Source = parametric::MetricFunctionSource;
    demands.loads = demands.loads || call.function->source == Source::kLoads;
    demands.heat = demands.heat || call.function->source == Source::kHeat;
    demands.surface = demands.surface || !OfPointsAlone(call, own);
  }
  demands.surface =
      demands.surface || demands.loads || demands.heat || demands.modes || demands.airflow;
  return demands;
}

namespace {

// What is computed of a design.
struct AnalysisPlan {
  bool loads = false;                           // the load cases
  bool heat = false;                            // the temperatures
  bool airflow = false;                         // the air around it
  int modes = 0;                                // how many natural modes
  bool mesh = false;                            // a mesh, if nothing else needs it
  CaseDetails details = {};                     // of each load case
  std::vector<std::string> with_gradient = {};  // the metrics that have one

  bool needs_mesh() const { return mesh || loads || heat || modes > 0; }
};

// Fails where a metric is none, or the model is not one or lacks what a metric needs.
absl::StatusOr<AnalysisPlan> PlanAnalysis(const DesignModel& model,
                                          const std::vector<std::string>& metrics, bool fields,
                                          const DesignAnalysisOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckMetricNames(metrics, options.custom_metrics));
  const MetricDemands demands = DemandsOf(metrics, options.custom_metrics);
  AnalysisPlan plan;
  plan.modes = demands.modes ? std::max(1, options.modes) : options.modes;
  plan.airflow = demands.airflow || options.with_airflow || options.besides.airflow;
  plan.mesh = options.with_mesh;
  MORTISE_RETURN_IF_ERROR(CheckModel(model, fields || plan.modes > 0 || plan.airflow ||
                                                demands.surface || options.besides.surface ||
                                                options.with_mesh));
  plan.loads = demands.loads || options.besides.loads ||
               (fields && (IsLoaded(model) || (!model.heat && !plan.airflow)));
  plan.heat = demands.heat || options.besides.heat || (model.heat && fields);
  if (plan.heat && !model.heat) {
    return PreconditionFailed("NO_HEAT", "there is no condition of heat", "boundary_conditions");
  }
  const auto needed = options.custom_metrics.NeedsOf(metrics);
  plan.details.error = fields || std::count(needed.metrics.begin(), needed.metrics.end(),
                                            DescriptionOf(BuiltInMetric::kRelativeError).name) > 0;
  plan.details.spread = fields || NeedsSpread(needed);
  std::copy_if(metrics.begin(), metrics.end(), std::back_inserter(plan.with_gradient),
               [&](const std::string& name) { return HasGradient(name, options.custom_metrics); });
  return plan;
}

void AddNote(std::string note, DesignAnalysis& analysis) {
  if (!note.empty()) analysis.notes.push_back(std::move(note));
}

// Gives the mesh with straight sides, from which refinement goes on; what is solved on is curved.
absl::StatusOr<mesh::TetrahedralMesh> MakeMesh(const DesignModel& model,
                                               const DesignAnalysisOptions& options,
                                               DesignAnalysis& analysis) {
  const auto start = Clock::now();
  if (options.progress != nullptr) options.progress->Begin("mesh");
  mesh::TetrahedralMesh straight;
  if (options.budget) {
    MORTISE_ASSIGN_OR_RETURN(mesh::BudgetedMesh budgeted,
                             mesh::MeshWithinBudget(model.surface, options.mesh, *options.budget));
    AddNote(NoteOnBudget(budgeted, *options.budget), analysis);
    straight = std::move(budgeted.mesh);
  } else {
    MORTISE_ASSIGN_OR_RETURN(straight, mesh::MeshAssembly(model.surface, options.mesh));
  }
  analysis.mesh = mesh::WithCurvedElements(model.surface, straight);
  analysis.meshing_seconds = SecondsSince(start);
  return straight;
}

// Of what the shape alone says: mass, volume, and what the metrics `names` ask of faces and points.
Gradients GradientsOfShape(const DesignModel& model, const std::vector<std::string>& names,
                           const DesignAnalysisOptions& options) {
  const DesignMotion& motion = *options.motion;
  Gradients gradients = {{DescriptionOf(BuiltInMetric::kMass).name, motion.mass},
                         {DescriptionOf(BuiltInMetric::kVolume).name, motion.volume}};
  for (const parametric::MetricCall& call : options.custom_metrics.NeedsOf(names).calls) {
    if (call.function->source != parametric::MetricFunctionSource::kShape) continue;
    auto gradient =
        GradientOfShape(call, model, motion, options.custom_metrics, options.parameters);
    if (gradient) gradients[ToText(call)] = *std::move(gradient);
  }
  return gradients;
}

// The load cases, on meshes as fine as the error asks for, and the temperatures that act in them.
absl::Status SolveLoadCases(const DesignSolver& solver, bool heat, const DesignModel& model,
                            mesh::TetrahedralMesh straight, const DesignAnalysisOptions& options,
                            DesignAnalysis& analysis, Gradients& gradients) {
  MORTISE_ASSIGN_OR_RETURN(SolvedDesign solved, solver.Solve(*analysis.mesh, heat));
  analysis.heat = std::move(solved.heat);
  analysis.cases = std::move(solved.cases);
  gradients.merge(solved.gradients);
  if (heat && model.reference_temperature) {
    AddNote(NoteOnExpansion(model.analysis.materials), analysis);
  }
  return options.wanted_error > 0
             ? Refine(solver, heat, model, std::move(straight), options, analysis, gradients)
             : absl::OkStatus();
}

// Computes all that the plan names, and gives the gradients that came with it.
absl::StatusOr<Gradients> SolveDesign(const AnalysisPlan& plan, const DesignModel& model,
                                      const DesignAnalysisOptions& options,
                                      DesignAnalysis& analysis) {
  // First, as its engine may be missing.
  if (plan.airflow) {
    MORTISE_ASSIGN_OR_RETURN(
        analysis.airflow,
        SolveAirflow(OutsideOf(model.surface), options.airflow, options.airflow_solver));
  }
  mesh::TetrahedralMesh straight;
  if (plan.needs_mesh()) {
    MORTISE_ASSIGN_OR_RETURN(straight, MakeMesh(model, options, analysis));
  }
  const DesignSolver solver(model, options, plan.details, plan.with_gradient);
  Gradients gradients;
  if (options.motion != nullptr) gradients = GradientsOfShape(model, plan.with_gradient, options);
  if (plan.loads) {
    MORTISE_RETURN_IF_ERROR(SolveLoadCases(solver, plan.heat, model, std::move(straight), options,
                                           analysis, gradients));
  } else if (plan.heat) {
    MORTISE_ASSIGN_OR_RETURN(analysis.heat, solver.Heat(*analysis.mesh));
  }
  if (plan.modes > 0) {
    if (options.progress != nullptr) options.progress->Begin("frequencies");
    MORTISE_ASSIGN_OR_RETURN(analysis.vibration,
                             Vibrate(model, *analysis.mesh, plan.modes, options));
  }
  return gradients;
}

std::optional<Eigen::VectorXd> GradientOf(const std::string& name, const CustomMetrics& own,
                                          const Gradients& gradients,
                                          const DesignAnalysisOptions& options) {
  if (options.custom_metrics.Find(name) >= 0) return own.Gradient(name, gradients);
  const auto known = gradients.find(name);
  if (known == gradients.end()) return std::nullopt;
  return known->second;
}

// Of what was solved, what cannot be meant.
void NoteImplausible(const DesignModel& model, DesignAnalysis& analysis) {
  for (std::string& note : NotesOnMaterials(model.analysis.materials)) {
    AddNote(std::move(note), analysis);
  }
  double largest = 0;
  for (const SolvedCase& solved : analysis.cases) {
    largest = std::max(largest, solved.solution.summary.maximum_displacement);
  }
  if (analysis.mesh) AddNote(NoteOnDisplacement(largest, analysis.mesh->nodes), analysis);
}

// The metrics, and the gradients of those `with_gradient`, from what was solved.
absl::Status ReadMetrics(const DesignModel& model, const std::vector<std::string>& metrics,
                         const std::vector<std::string>& with_gradient, const Gradients& gradients,
                         const DesignAnalysisOptions& options, DesignAnalysis& analysis) {
  GeometryMetrics geometry(PartsOf(model));
  const auto compute = [&](const std::string& name) {
    return ReadMetric(*FindMetric(name), model, analysis, options.airflow.wind, geometry);
  };
  const CustomMetrics own(options.custom_metrics, options.parameters, metrics, model, analysis,
                          [&](const std::string& name) -> absl::StatusOr<double> {
                            MORTISE_ASSIGN_OR_RETURN(const Metric metric, compute(name));
                            return metric.value;
                          });
  for (const std::string& name : metrics) {
    const bool is_own = options.custom_metrics.Find(name) >= 0;
    absl::StatusOr<Metric> metric = is_own ? own.Compute(name) : compute(name);
    if (metric.ok()) {
      analysis.metrics.push_back(*std::move(metric));
    } else if (options.leave_out_inapplicable &&
               (is_own || absl::IsFailedPrecondition(metric.status()))) {
      analysis.notes.push_back(absl::StrCat(name, ": ", metric.status().message()));
    } else {
      return metric.status();
    }
  }
  for (const std::string& name : with_gradient) {
    const std::optional<Eigen::VectorXd> gradient = GradientOf(name, own, gradients, options);
    if (gradient && gradient->size() > 0) analysis.gradients.push_back({name, *gradient});
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<DesignAnalysis> AnalyzeDesign(const DesignModel& model,
                                             const std::vector<std::string>& metrics, bool fields,
                                             const DesignAnalysisOptions& options) {
  const auto start = Clock::now();
  MORTISE_ASSIGN_OR_RETURN(const AnalysisPlan plan, PlanAnalysis(model, metrics, fields, options));
  DesignAnalysis analysis;
  MORTISE_ASSIGN_OR_RETURN(const Gradients gradients, SolveDesign(plan, model, options, analysis));
  NoteImplausible(model, analysis);
  MORTISE_RETURN_IF_ERROR(
      ReadMetrics(model, metrics, plan.with_gradient, gradients, options, analysis));
  analysis.seconds = SecondsSince(start);
  return analysis;
}

}  // namespace mortise::simulator
