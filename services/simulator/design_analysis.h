// From an evaluated design to metrics: geometry, mesh, solution, numbers with names and units.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/mesh_quality.h"
#include "common/mesh/mesher.h"
#include "common/mesh/surface_mesh.h"
#include "services/simulator/analysis_case.h"
#include "services/simulator/elasticity.h"
#include "services/simulator/stage_progress.h"

namespace mortise::simulator {

// An evaluated design as physics sees it. Faces in the supports and loads name parts by index.
struct DesignModel {
  mesh::AssemblySurface surface;
  AnalysisCase analysis;  // one material for each part of `surface`
};

// A number with a name.
struct Metric {
  std::string name;
  std::string unit;  // SI
  double value = 0;
};

// A metric that can be asked for.
struct MetricDescription {
  std::string name;
  std::string unit;
  std::string description;
  bool needs_solution = false;  // computed from displacements, not from geometry alone
};

// mass, volume, max_displacement, max_von_mises, max_principal, compliance, strain_energy,
// stress_ratio, relative_error.
const std::vector<MetricDescription>& OfferedMetrics();

// Whether any of these takes a solution.
bool NeedsSolution(const std::vector<std::string>& metrics);

struct DesignAnalysisOptions {
  mesh::MeshOptions mesh;
  ElasticityOptions elasticity;
  StageProgress* progress = nullptr;  // told of "mesh" and "solution", if it is there
};

// All that was computed. Without a metric that needs it there is no mesh and no solution.
struct DesignAnalysis {
  std::vector<Metric> metrics;  // in the order asked for
  std::optional<mesh::TetrahedralMesh> mesh;
  std::optional<ElasticitySolution> solution;
  double meshing_seconds = 0;
  double seconds = 0;
};

// Computes `metrics` by name, in order; INVALID_ARGUMENT naming "metrics[i]" for an unknown one,
// else as MeshAssembly and SolveElasticity fail. With `fields` the solution is made in any case.
absl::StatusOr<DesignAnalysis> AnalyzeDesign(const DesignModel& model,
                                             const std::vector<std::string>& metrics, bool fields,
                                             const DesignAnalysisOptions& options = {});

// INVALID_ARGUMENT naming "metrics[i]" (or "metrics" if there are none) unless all are offered.
absl::Status CheckMetricNames(const std::vector<std::string>& metrics);

}  // namespace mortise::simulator
