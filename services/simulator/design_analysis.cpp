#include "services/simulator/design_analysis.h"

#include <algorithm>
#include <chrono>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "services/simulator/error_estimate.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

const MetricDescription* FindMetric(const std::string& name) {
  for (const MetricDescription& metric : OfferedMetrics()) {
    if (metric.name == name) return &metric;
  }
  return nullptr;
}

// The largest share of its strength that any part is under; parts of unknown strength are left out.
double StressRatio(const DesignModel& model, const ElasticitySolution& solution) {
  double ratio = 0;
  for (std::size_t p = 0; p < model.analysis.materials.size(); ++p) {
    const double strength = model.analysis.materials[p].strength;
    if (strength > 0) ratio = std::max(ratio, solution.part_maximum_von_mises[p] / strength);
  }
  return ratio;
}

double Value(const std::string& name, const DesignModel& model, const DesignAnalysis& analysis,
             int threads) {
  if (name == "mass" || name == "volume") {
    double sum = 0;
    for (std::size_t p = 0; p < model.analysis.materials.size(); ++p) {
      const double volume =
          mesh::ComputeMassProperties(mesh::PartSurface(model.surface, static_cast<int>(p))).volume;
      sum += volume * (name == "mass" ? model.analysis.materials[p].density : 1);
    }
    return sum;
  }
  const ElasticitySolution& solution = *analysis.solution;
  if (name == "max_displacement") return solution.summary.maximum_displacement;
  if (name == "max_von_mises") return solution.part_maximum_von_mises.maxCoeff();
  if (name == "max_principal") return solution.maximum_principal.maxCoeff();
  if (name == "relative_error") {
    ThreadTeam team(threads);
    return EstimateError(*analysis.mesh, model.analysis.materials, solution.displacement,
                         solution.temperature, team)
        .relative;
  }
  if (name == "compliance") return solution.summary.compliance;
  if (name == "strain_energy") return solution.summary.strain_energy;
  return StressRatio(model, solution);
}

// What both paths rely on; the path with a mesh checks the rest.
absl::Status CheckModel(const DesignModel& model) {
  MORTISE_RETURN_IF_ERROR(mesh::CheckAssembly(model.surface));
  if (model.analysis.materials.size() != model.surface.part_names.size()) {
    return InvalidField("materials", "there must be one for each part");
  }
  for (std::size_t p = 0; p < model.analysis.materials.size(); ++p) {
    MORTISE_RETURN_IF_ERROR(
        CheckMaterial(model.analysis.materials[p], absl::StrCat("materials[", p, "]")));
  }
  return absl::OkStatus();
}

}  // namespace

const std::vector<MetricDescription>& OfferedMetrics() {
  static const std::vector<MetricDescription> metrics{
      {"mass", "kg", "Mass of all parts.", false},
      {"volume", "m^3", "Volume of all parts.", false},
      {"max_displacement", "m", "Largest displacement of any point under the loads.", true},
      {"max_von_mises", "Pa",
       "Largest von Mises stress at any node. At sharp inner corners it grows with refinement.",
       true},
      {"max_principal", "Pa",
       "Largest principal stress at any node: what pulls most. At sharp inner corners it grows "
       "with "
       "refinement.",
       true},
      {"compliance", "J", "Work of the loads on the displacements, f·u: the smaller, the stiffer.",
       true},
      {"strain_energy", "J", "Elastic energy stored under the loads.", true},
      {"stress_ratio", "1", "Largest von Mises stress of a part over its material's strength.",
       true},
      {"relative_error", "1",
       "Estimated error of the stresses, as a share of all, in the energy norm: 0.05 is good.",
       true}};
  return metrics;
}

bool NeedsSolution(const std::vector<std::string>& metrics) {
  return std::any_of(metrics.begin(), metrics.end(), [](const std::string& name) {
    const MetricDescription* const metric = FindMetric(name);
    return metric != nullptr && metric->needs_solution;
  });
}

absl::Status CheckMetricNames(const std::vector<std::string>& metrics) {
  if (metrics.empty()) return InvalidField("metrics", "ask for at least one metric");
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    if (FindMetric(metrics[i]) != nullptr) continue;
    const std::string offered = absl::StrJoin(
        OfferedMetrics(), ", ",
        [](std::string* out, const MetricDescription& metric) { out->append(metric.name); });
    return InvalidField(absl::StrCat("metrics[", i, "]"),
                        absl::StrCat("'", metrics[i], "' is not offered; there are ", offered));
  }
  return absl::OkStatus();
}

absl::StatusOr<DesignAnalysis> AnalyzeDesign(const DesignModel& model,
                                             const std::vector<std::string>& metrics, bool fields,
                                             const DesignAnalysisOptions& options) {
  const auto start = Clock::now();
  MORTISE_RETURN_IF_ERROR(CheckMetricNames(metrics));
  MORTISE_RETURN_IF_ERROR(CheckModel(model));
  DesignAnalysis analysis;
  const bool solve = fields || NeedsSolution(metrics);
  if (solve) {
    if (options.progress != nullptr) options.progress->Begin("mesh");
    MORTISE_ASSIGN_OR_RETURN(analysis.mesh, mesh::MeshAssembly(model.surface, options.mesh));
    analysis.meshing_seconds = SecondsSince(start);
    if (options.progress != nullptr) options.progress->Begin("solution");
    MORTISE_ASSIGN_OR_RETURN(analysis.solution,
                             SolveElasticity(*analysis.mesh, model.analysis, options.elasticity));
  }
  for (const std::string& name : metrics) {
    analysis.metrics.push_back(
        {name, FindMetric(name)->unit, Value(name, model, analysis, options.elasticity.threads)});
  }
  analysis.seconds = SecondsSince(start);
  return analysis;
}

}  // namespace mortise::simulator
