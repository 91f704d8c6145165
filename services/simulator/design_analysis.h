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
#include "services/simulator/geometry_metrics.h"
#include "services/simulator/metric.h"
#include "services/simulator/modal_analysis.h"
#include "services/simulator/refinement.h"
#include "services/simulator/stage_progress.h"

namespace mortise::simulator {

// An evaluated design as physics sees it. Faces in the supports and loads name parts by index.
struct DesignModel {
  // The parts joined; may be left empty where no metric needs it and no fields are wanted.
  mesh::AssemblySurface surface;
  AnalysisCase analysis;              // one material for each part
  std::vector<SolidPart> parts = {};  // by themselves; those of `surface` if there are none
  absl::StatusOr<Cost> cost = absl::FailedPreconditionError("nobody says what it costs");
};

// Those of GeometryMetrics; surface_area; cost; natural_frequency; max_displacement, max_von_mises,
// max_principal, compliance, strain_energy, stress_ratio, relative_error.
const std::vector<MetricDescription>& OfferedMetrics();

// Whether any of these takes a solution under loads.
bool NeedsSolution(const std::vector<std::string>& metrics);

// Whether any of these takes the natural modes.
bool NeedsModes(const std::vector<std::string>& metrics);

// Whether any of these takes the joined surface of the parts.
bool NeedsSurface(const std::vector<std::string>& metrics);

struct DesignAnalysisOptions {
  mesh::MeshOptions mesh;
  ElasticityOptions elasticity;
  StageProgress* progress = nullptr;  // told of "mesh", "solution" …, if it is there
  // Metrics that this design cannot have (a draught where it sinks) are left out, with a note.
  bool leave_out_inapplicable = false;
  // How many natural modes that deform are wanted beside the metrics; one, if a metric needs it.
  int modes = 0;
  // The mesh is refined until the estimated relative error is at most this, 0.001 to 1, or the
  // limits of memory and elements forbid it; 0 for no refinement.
  double wanted_error = 0;
};

// All that was computed. Without a metric that needs them there are no mesh, solution and modes.
struct DesignAnalysis {
  std::vector<Metric> metrics;     // in the order asked for
  std::vector<std::string> notes;  // what was left out, and why
  std::optional<mesh::TetrahedralMesh> mesh;
  std::optional<ElasticitySolution> solution;
  std::optional<ModalSolution> vibration;
  std::vector<RefinementStep> refinements;  // the meshes solved on, where an error was wanted
  std::string shortfall;                    // why it was not reached; empty if it was
  double meshing_seconds = 0;
  double seconds = 0;
};

// Computes `metrics` by name, in order; INVALID_ARGUMENT naming "metrics[i]" for an unknown one,
// else as GeometryMetrics, the design's cost, MeshAssembly, SolveElasticity and FindModes fail;
// "modes" where there are more than the mesh has. With `fields` the solution is made in any case.
absl::StatusOr<DesignAnalysis> AnalyzeDesign(const DesignModel& model,
                                             const std::vector<std::string>& metrics, bool fields,
                                             const DesignAnalysisOptions& options = {});

// INVALID_ARGUMENT naming "metrics[i]" (or "metrics" if there are none) unless all are offered.
absl::Status CheckMetricNames(const std::vector<std::string>& metrics);

}  // namespace mortise::simulator
