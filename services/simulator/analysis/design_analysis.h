// Computes the metrics of an evaluated design: geometry, mesh, solution, numbers with names and
// units.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/geometry_metrics.h"
#include "common/design/metric.h"
#include "common/design/metric_registry.h"
#include "common/expressions/metric_expressions.h"
#include "common/fem/elements/analysis_case.h"
#include "common/fem/linear/stage_progress.h"
#include "common/fem/problems/elasticity.h"
#include "common/fem/problems/heat_conduction.h"
#include "common/fem/problems/modal_analysis.h"
#include "common/fem/stress/error_estimate.h"
#include "common/fem/stress/stress_spread.h"
#include "common/mesh/control_variables.h"
#include "common/mesh/surface_mesh.h"
#include "common/mesh/tetrahedra/element_budget.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "services/simulator/airflow/airflow.h"
#include "services/simulator/analysis/metric_gradient.h"
#include "services/simulator/analysis/refinement.h"

namespace mortise::simulator {

// An evaluated design as physics sees it. Faces in the supports and loads name parts by index.
struct DesignModel {
  // The parts joined; may be left empty where no metric needs it and no fields are wanted.
  mesh::AssemblySurface surface;
  // One material for each part, the supports, and the loads that act in every load case.
  AnalysisCase analysis;
  std::vector<SolidPart> parts = {};  // by themselves; those of `surface` if there are none
  absl::StatusOr<Cost> cost = absl::FailedPreconditionError("nobody says what it costs");
  // The loads of each besides; if there are none there is one load case, "loads".
  std::vector<NamedLoadCase> load_cases = {};
  std::optional<HeatCase> heat = {};  // K; its materials are those of `analysis`
  // K: at which nothing is under stress; with it the temperatures of `heat` act in every load case.
  std::optional<double> reference_temperature = {};
  // What the conditions that act on faces are called, and on which.
  std::vector<std::pair<std::string, mesh::NamedFace>> condition_faces = {};
  // Vertices and edges of the solid that it is; of other designs, the faces of `surface` tell.
  std::optional<mesh::ControlVariables> control_variables = {};
};

// Whether anything in the model causes stress: a load, a support that is moved, or temperatures.
bool IsLoaded(const DesignModel& model);

// Whether a metric of the registry, or all that one of `own` needs, has an exact gradient on
// designs that say how they move (MetricDescription::has_gradient; areas, centroids, distances and
// displacements of faces and points).
bool HasGradient(const std::string& metric, const parametric::MetricExpressions& own = {});

// What must be known of a design to tell some metrics of it.
struct MetricDemands {
  bool loads = false;    // a solution under the loads
  bool heat = false;     // the temperatures
  bool modes = false;    // the natural modes
  bool airflow = false;  // the air around it
  bool surface = false;  // the joined surface of the parts
};

// Returns what must be known to tell `metrics`; `own` are metrics that are offered besides.
MetricDemands DemandsOf(const std::vector<std::string>& metrics,
                        const parametric::MetricExpressions& own = {});

struct DesignMotion;

struct DesignAnalysisOptions {
  mesh::MeshOptions mesh;
  // Where it is there, the mesh is coarser than `mesh` asks if that would take more elements.
  std::optional<mesh::ElementBudget> budget = {};
  ElasticityOptions elasticity;
  StageProgress* progress = nullptr;  // told of "mesh", "heat", "solution" …, if it is there
  // Metrics that this design cannot have (a draught where it sinks) are left out, with a note.
  bool leave_out_inapplicable = false;
  // The number of natural modes that deform that are wanted beside the metrics; one, if a metric
  // needs it.
  int modes = 0;
  // How the air around it is computed, where a metric needs it or it is wanted besides.
  parametric::Airflow airflow = {};
  AirflowSolverOptions airflow_solver = {};
  bool with_airflow = false;
  MetricDemands besides = {};  // what is computed whether the metrics need it or not
  bool with_mesh = false;      // a mesh of the volume in any case
  // The mesh is refined until the estimated relative error is at most this, 0.001 to 1, or the
  // limits of memory and elements forbid it; 0 for no refinement.
  double wanted_error = 0;
  // Metrics that are offered besides, and the parameters that they speak of.
  parametric::MetricExpressions custom_metrics = {};
  Eigen::VectorXd parameters = {};
  // How the model changes with the parameters: with it, exact gradients of those metrics that have
  // one (HasGradient) are computed besides. It must outlive the call.
  const DesignMotion* motion = nullptr;
};

// A load case, solved.
struct SolvedCase {
  std::string name;
  ElasticitySolution solution;
  std::optional<ErrorEstimate> error;  // where the metrics, the files or a refinement need it
  std::optional<StressSpread> spread;  // where the metrics or the files need it
};

// All that was computed. Without a metric that needs them there are no mesh, cases, heat, modes and
// air.
struct DesignAnalysis {
  std::vector<Metric> metrics;            // in the order asked for
  std::vector<MetricGradient> gradients;  // of those metrics that have one, where asked for
  std::vector<std::string> notes;         // what was left out, and why; what cannot be meant
  std::optional<mesh::TetrahedralMesh> mesh;
  std::vector<SolvedCase> cases;  // those of the model, in its order
  std::optional<HeatSolution> heat;
  std::optional<ModalSolution> vibration;
  std::optional<AirflowSolution> airflow;
  std::vector<RefinementStep> refinements;  // the meshes solved on, where an error was wanted
  std::string shortfall;                    // why it was not reached; empty if it was
  double meshing_seconds = 0;
  double seconds = 0;
};

// Computes `metrics` by name, in order, each of metric_registry.h or of the options; those under
// loads are of the load case where each is worst. INVALID_ARGUMENT naming "metrics[i]" for an
// unknown one, FAILED_PRECONDITION, NO_HEAT, for temperatures of a model without heat; else as
// GeometryMetrics, the design's cost, MeshAssembly, SolveHeat, SolveAirflow, ElasticSystem and
// FindModes fail; "modes" where there are more than the mesh has. With `fields` all that the model
// has is solved in any case: loads, if it is loaded or neither heat nor air are there, and heat.
absl::StatusOr<DesignAnalysis> AnalyzeDesign(const DesignModel& model,
                                             const std::vector<std::string>& metrics, bool fields,
                                             const DesignAnalysisOptions& options = {});

}  // namespace mortise::simulator
