#include "services/simulator/analysis/mesh_analysis.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/fem/elements/shape_functions.h"
#include "common/fem/elements/supports.h"
#include "common/fem/linear/sparse_cholesky.h"
#include "common/fem/linear/stopping.h"
#include "common/fem/problems/modal_analysis.h"
#include "common/fem/stress/error_estimate.h"
#include "common/mesh/files/vtu_writer.h"
#include "services/simulator/analysis/analysis_notes.h"
#include "services/simulator/analysis/probe_table.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kJson[] = "application/json";
constexpr char kVtu[] = "model/vnd.vtu";
constexpr char kPng[] = "image/png";

// The failure of an algorithm, whose fields are below `prefix` in the case.
absl::Status InCase(const std::string& prefix, const absl::Status& status) {
  const ErrorDetail detail = DetailOf(status);
  if (status.ok() || detail.field.empty()) return status;
  if (absl::StartsWith(status.message(), detail.field)) return UnderField(prefix, status);
  return WithDetail(status, {detail.reason, absl::StrCat(prefix, ".", detail.field)});
}

absl::Status NotFinite(const std::string& field) {
  return InvalidField(field, "leads to results that are not finite: some number is far too large");
}

// Bytes that an analysis takes, but for the factor for the modes.
double EstimateBytes(Eigen::Index nodes, Eigen::Index elements, std::size_t load_cases, int modes) {
  // Measured: 460 MB for 95,000 nodes of quadratic elements, matrix, multigrid, fields and files.
  double of_node = 5000 + 56 * static_cast<double>(load_cases);
  // Two vectors a mode are iterated; those found are copied, made into shapes and into a file.
  if (modes > 0) of_node += 24 * (8.0 * modes + 20);
  return static_cast<double>(nodes) * of_node + static_cast<double>(elements) * 300;
}

class Analyst {
 public:
  Analyst(const MeshModel& model, const MeshAnalysisOptions& options, const KeepFile& keep)
      : model_(model), options_(options), keep_(keep), team_(options.threads) {}

  absl::StatusOr<MeshAnalysis> Run() {
    const auto start = Clock::now();
    MORTISE_RETURN_IF_ERROR(CheckMemory(model_.mesh.nodes.cols(), model_.mesh.tetrahedra.cols(),
                                        model_.load_cases.size(), options_.memory_limit,
                                        model_.modes));
    MORTISE_RETURN_IF_ERROR(CheckProbes());
    auto table = ProbeTable::Create(model_.mesh, model_.probes, model_.node_numbers);
    MORTISE_RETURN_IF_ERROR(InCase("case", table.status()));
    probes_ = *std::move(table);
    Weigh();
    if (!std::isfinite(analysis_.mass)) return NotFinite("case.materials");
    const bool is_only_modes = model_.load_cases.empty() && !model_.heat;
    if (model_.modes > 0 && !is_only_modes) MORTISE_RETURN_IF_ERROR(CheckFactor());
    if (model_.heat) MORTISE_RETURN_IF_ERROR(Heat());
    if (!model_.load_cases.empty()) MORTISE_RETURN_IF_ERROR(Loads());
    if (model_.modes > 0) MORTISE_RETURN_IF_ERROR(Vibration());
    if (probes_.size() > 0) {
      MORTISE_RETURN_IF_ERROR(Keep({"probes.csv", "text/csv", probes_.csv()}));
    }
    NoteImplausible();
    analysis_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return std::move(analysis_);
  }

 private:
  absl::Status CheckProbes() const {
    constexpr double kMaxRows = 1e6;
    const double cases = static_cast<double>(model_.load_cases.size()) +
                         static_cast<double>(model_.combinations.size()) + model_.modes + 1;
    double places = 0;
    for (const Probe& probe : model_.probes) {
      places += static_cast<double>(probe.points.size() + probe.nodes.size());
    }
    const double rows = cases * places;
    if (rows <= kMaxRows) return absl::OkStatus();
    return TooLarge(absl::StrFormat("a table of about %.0f rows for the probes", rows),
                    absl::StrFormat("%.0f rows", kMaxRows));
  }

  // What the rest leaves for the factor.
  CholeskyOptions FactorOptions() const {
    return {.memory_limit = options_.memory_limit -
                            EstimateBytes(model_.mesh.nodes.cols(), model_.mesh.tetrahedra.cols(),
                                          model_.load_cases.size(), model_.modes)};
  }

  // The modes come last, and no formula tells how large their factor is: it is counted before
  // anything is computed in vain.
  absl::Status CheckFactor() const {
    const mesh::TetrahedralMesh& mesh = model_.mesh;
    MORTISE_RETURN_IF_ERROR(CheckMesh(mesh));
    MORTISE_RETURN_IF_ERROR(InCase("case", CheckModel(mesh, model_.materials, model_.supports)));
    const auto constraints = CollectConstraints(mesh, model_.supports);
    MORTISE_RETURN_IF_ERROR(InCase("case", constraints.status()));
    const BlockPattern pattern(static_cast<int>(mesh.nodes.cols()), mesh.tetrahedra);
    return SparseCholesky::Analyze(pattern, constraints->fixed, FactorOptions()).status();
  }

  void Begin(std::string stage) const {
    if (options_.progress != nullptr) options_.progress->Begin(std::move(stage));
  }

  // The case goes before the first file.
  absl::Status Keep(AnalysisFile file) {
    MORTISE_RETURN_IF_ERROR(CheckStopped(options_.stop));
    if (!std::exchange(is_case_kept_, true) && !model_.case_json.empty()) {
      MORTISE_RETURN_IF_ERROR(keep_({"case.json", kJson, model_.case_json}));
    }
    return keep_(std::move(file));
  }

  void Weigh() {
    const mesh::TetrahedralMesh& mesh = model_.mesh;
    analysis_.nodes = static_cast<int>(mesh.nodes.cols());
    analysis_.elements = static_cast<int>(mesh.tetrahedra.cols());
    for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
      const GradientMatrix positions = ElementPositions(mesh, e);
      double volume = 0;
      for (const TetrahedronPoint& point : TetrahedronRule(mesh.IsQuadratic() ? 5 : 1)) {
        volume += point.weight * EvaluateElement(positions, point.barycentric).determinant / 6;
      }
      analysis_.volume += volume;
      analysis_.mass += volume * model_.materials[mesh.part[e]].density;
    }
  }

  absl::Status Write(const std::string& name, const std::vector<mesh::VtuField>& point_fields,
                     const std::vector<mesh::VtuField>& cell_fields) {
    MORTISE_ASSIGN_OR_RETURN(std::string bytes,
                             mesh::WriteVtu(model_.mesh, point_fields, cell_fields));
    return Keep({name, kVtu, std::move(bytes)});
  }

  std::string Heading(const std::string& what) const {
    return model_.title.empty() ? what : absl::StrCat(model_.title, ": ", what);
  }

  absl::Status Heat() {
    MORTISE_RETURN_IF_ERROR(CheckStopped(options_.stop));
    Begin("heat");
    HeatOptions heat_options;
    heat_options.cholesky.memory_limit = options_.memory_limit;
    heat_options.threads = options_.threads;
    auto solution = SolveHeat(model_.mesh, *model_.heat, heat_options);
    MORTISE_RETURN_IF_ERROR(InCase("case.heat", solution.status()));
    temperature_ = solution->temperature;
    if (!IsFinite(*solution)) return NotFinite("case.heat");
    analysis_.unknowns = analysis_.nodes;
    analysis_.heat = OutcomeOf(*solution);
    ProbedFields fields;
    fields.temperature = temperature_;
    probes_.Add("heat", fields);
    Begin("heat: files");

    MORTISE_ASSIGN_OR_RETURN(std::string bytes,
                             WriteHeat(model_.mesh, model_.heat->materials, temperature_));
    MORTISE_RETURN_IF_ERROR(Keep({"heat.vtu", kVtu, std::move(bytes)}));
    if (!options_.pictures) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(std::string picture,
                             DrawTemperature(model_.mesh, temperature_, Heading("temperature")));
    return Keep({"heat.png", kPng, std::move(picture)});
  }

  absl::Status Loads() {
    ElasticityOptions elasticity;
    elasticity.threads = options_.threads;
    elasticity.solver.kind = model_.solver;
    elasticity.solver.loads = static_cast<int>(model_.load_cases.size());
    elasticity.solver.memory_limit = options_.memory_limit;
    elasticity.solver.progress = [this](int iteration, double) {
      if (options_.progress != nullptr) options_.progress->Iterate(iteration);
      return CheckStopped(options_.stop);
    };
    std::string stage;
    elasticity.before_recovery = [this, &stage] { Begin(stage + ": stresses"); };
    Begin("stiffness");
    auto system = ElasticSystem::Create(model_.mesh, model_.materials, model_.supports, elasticity);
    MORTISE_RETURN_IF_ERROR(InCase("case", system.status()));
    NoteExpansion();
    std::vector<ElasticitySolution> solutions;
    for (std::size_t i = 0; i < model_.load_cases.size(); ++i) {
      const NamedLoadCase& load_case = model_.load_cases[i];
      LoadCase loads = load_case.loads;
      if (load_case.thermal_stress) {
        loads.temperature = temperature_.array() - model_.reference_temperature;
      }
      stage = absl::StrCat("load case ", i + 1, " of ", model_.load_cases.size());
      Begin(stage);
      auto solution = system->Solve(loads);
      MORTISE_RETURN_IF_ERROR(InCase(absl::StrCat("case.load_cases[", i, "]"), solution.status()));
      Begin(stage + ": files");
      MORTISE_RETURN_IF_ERROR(
          Report(load_case.name, absl::StrCat("case.load_cases[", i, "]"), *solution));
      // Combinations need no more than this.
      ElasticitySolution& kept = solutions.emplace_back();
      if (model_.combinations.empty()) continue;
      kept.displacement = std::move(solution->displacement);
      kept.load = std::move(solution->load);
      kept.temperature = std::move(solution->temperature);
    }
    for (const NamedCombination& combination : model_.combinations) {
      std::vector<CombinationTerm> terms;
      for (const NamedCombination::Term& term : combination.terms) {
        terms.push_back({term.factor, &solutions[term.load_case]});
      }
      const auto index = &combination - model_.combinations.data();
      stage = absl::StrCat("combination ", index + 1, " of ", model_.combinations.size());
      MORTISE_ASSIGN_OR_RETURN(const ElasticitySolution sum, system->Combine(terms));
      Begin(stage + ": files");
      MORTISE_RETURN_IF_ERROR(
          Report(combination.name, absl::StrCat("case.combinations[", index, "]"), sum));
    }
    return absl::OkStatus();
  }

  void NoteExpansion() {
    const bool is_asked =
        std::any_of(model_.load_cases.begin(), model_.load_cases.end(),
                    [](const NamedLoadCase& load_case) { return load_case.thermal_stress; });
    std::string note = is_asked ? NoteOnExpansion(model_.materials) : "";
    if (!note.empty()) analysis_.notes.push_back(std::move(note));
  }

  void NoteImplausible() {
    for (std::string& note : NotesOnMaterials(model_.materials)) {
      analysis_.notes.push_back(std::move(note));
    }
    double largest = 0;
    for (const CaseOutcome& outcome : analysis_.cases) {
      largest = std::max(largest, outcome.summary.maximum_displacement);
    }
    std::string note = NoteOnDisplacement(largest, model_.mesh.nodes);
    if (!note.empty()) analysis_.notes.push_back(std::move(note));
  }

  absl::Status Report(const std::string& name, const std::string& field,
                      const ElasticitySolution& solution) {
    if (!IsFinite(solution)) return NotFinite(field);
    analysis_.unknowns = solution.summary.solver.unknowns;
    const ErrorEstimate estimate =
        EstimateError(model_.mesh, model_.materials, solution.displacement, solution.temperature,
                      team_, solution.traction);
    if (!std::isfinite(estimate.relative)) return NotFinite(field);
    const StressSpread spread =
        SpreadOf(model_.mesh, model_.materials, solution.displacement, solution.temperature, team_);
    if (!IsFinite(spread)) return NotFinite(field);
    analysis_.cases.push_back(
        OutcomeOf(name, model_.mesh, solution, estimate.relative, spread, model_.support_nodes));

    ProbedFields fields;
    fields.displacement = solution.displacement;
    fields.stress = solution.stress;
    fields.von_mises = solution.von_mises;
    fields.maximum_principal = solution.maximum_principal;
    if (solution.temperature.size() > 0) {
      fields.temperature = solution.temperature.array() + model_.reference_temperature;
    }
    probes_.Add(name, fields);
    const std::string file = FileStem(analysis_.cases.size(), name);
    MORTISE_ASSIGN_OR_RETURN(
        std::string bytes,
        WriteFields(model_.mesh, solution, estimate.element_error, model_.reference_temperature));
    MORTISE_RETURN_IF_ERROR(Keep({file + ".vtu", kVtu, std::move(bytes)}));
    if (!options_.pictures) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(std::string picture, DrawStress(model_.mesh, solution, Heading(name)));
    return Keep({file + ".png", kPng, std::move(picture)});
  }

  absl::Status Vibration() {
    MORTISE_RETURN_IF_ERROR(CheckStopped(options_.stop));
    Begin("frequencies");
    ModalOptions modal;
    modal.count = model_.modes;
    modal.threads = options_.threads;
    modal.cholesky = FactorOptions();
    const auto solution = FindModes(model_.mesh, model_.materials, model_.supports, modal);
    if (DetailOf(solution.status()).field == "count") {
      return WithDetail(solution.status(), {"FIELD_INVALID", "case.modes"});
    }
    MORTISE_RETURN_IF_ERROR(InCase("case", solution.status()));
    const std::string note = NoteOnRigidMotions(*solution);
    if (!note.empty()) analysis_.notes.push_back(note);
    for (std::size_t m = 0; m < solution->modes.size(); ++m) {
      const Mode& mode = solution->modes[m];
      if (!std::isfinite(mode.frequency) || !mode.shape.allFinite()) {
        return NotFinite("case.materials");
      }
      analysis_.modes.push_back({mode.frequency, mode.rigid});
      ProbedFields fields;
      fields.displacement = mode.shape;
      probes_.Add(absl::StrCat("mode ", m + 1), fields);
    }
    if (analysis_.unknowns == 0) analysis_.unknowns = 3 * analysis_.nodes;
    Begin("frequencies: files");
    return Write("modes.vtu", ShapeFields(*solution), {});
  }

  const MeshModel& model_;
  const MeshAnalysisOptions& options_;
  const KeepFile& keep_;
  ThreadTeam team_;
  ProbeTable probes_;
  Eigen::VectorXd temperature_;  // nodes, if heat was asked for
  MeshAnalysis analysis_;
  bool is_case_kept_ = false;
};

}  // namespace

absl::Status CheckMemory(Eigen::Index nodes, Eigen::Index elements, std::size_t load_cases,
                         double memory_limit, int modes) {
  const double bytes = EstimateBytes(nodes, elements, load_cases, modes);
  if (bytes <= memory_limit) return absl::OkStatus();
  return TooLarge(absl::StrFormat("an analysis of %d elements on %d nodes, about %.2g GB, ",
                                  elements, nodes, bytes / 1e9),
                  absl::StrFormat("the worker's %.2g GB", memory_limit / 1e9));
}

int StagesOf(const MeshModel& model) {
  const int load_cases = static_cast<int>(model.load_cases.size());
  const int combinations = static_cast<int>(model.combinations.size());
  int stages = 0;
  if (model.heat) stages += 2;                                          // temperatures, files
  if (load_cases > 0) stages += 1 + 3 * load_cases + 2 * combinations;  // solution, stresses, files
  if (model.modes > 0) stages += 2;                                     // shapes, files
  return stages;
}

absl::StatusOr<MeshAnalysis> AnalyzeMesh(const MeshModel& model, const MeshAnalysisOptions& options,
                                         const KeepFile& keep) {
  return Analyst(model, options, keep).Run();
}

}  // namespace mortise::simulator
