// Computes in turn everything that is asked of an uploaded mesh: heat, load cases and their
// combinations, vibration, and the files that show them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/elements/analysis_case.h"
#include "common/fem/linear/linear_solver.h"
#include "common/fem/linear/stage_progress.h"
#include "common/mesh/tetrahedral_mesh.h"
#include "services/simulator/analysis/analysis_report.h"
#include "services/simulator/analysis/case_outcome.h"

namespace mortise::simulator {

// Factors times load cases.
struct NamedCombination {
  struct Term {
    int load_case = 0;  // index
    double factor = 1;
  };
  std::string name;
  std::vector<Term> terms;
};

// A place where values are wanted.
struct Probe {
  std::string name;
  std::vector<Eigen::Vector3d> points;  // m
  std::vector<int> nodes;
};

// A mesh with all that is asked of it. Faces in conditions are of part 0, whatever they are on.
struct MeshModel {
  std::string title;
  std::string case_json;                   // the case itself, kept beside the results; or empty
  mesh::TetrahedralMesh mesh;              // a part for each material
  std::vector<std::int64_t> node_numbers;  // what its nodes are called in the file
  std::vector<Material> materials;         // one for each part
  std::vector<Support> supports;
  std::vector<std::vector<int>> support_nodes;  // of each support, ascending
  std::vector<NamedLoadCase> load_cases;
  std::vector<NamedCombination> combinations;
  SolverKind solver = SolverKind::kAutomatic;  // of the load cases
  std::optional<HeatCase> heat;
  double reference_temperature = 0;  // at which nothing is under thermal stress
  int modes = 0;                     // how many that deform are wanted
  std::vector<Probe> probes;
};

struct MeshAnalysisOptions {
  double memory_limit = 8e9;          // bytes
  int threads = 1;                    // the result is the same for any number
  bool pictures = true;               // each takes about a second
  std::stop_token stop = {};          // ends the analysis at its next step or iteration: CANCELLED
  StageProgress* progress = nullptr;  // told of stages, if it is there
};

// Returns how many stages an analysis has: what it tells MeshAnalysisOptions::progress of.
int StagesOf(const MeshModel& model);

struct ModeOutcome {
  double frequency = 0;  // Hz
  bool rigid = false;
};

struct MeshAnalysis {
  double mass = 0;    // kg
  double volume = 0;  // m³
  int nodes = 0, elements = 0;
  int unknowns = 0;  // of the displacements; of the temperatures where only those are asked for
  std::vector<CaseOutcome> cases;
  std::vector<ModeOutcome> modes;
  std::optional<HeatOutcome> heat;
  std::vector<std::string> notes;  // what one should know
  double seconds = 0;
};

// Takes a file as soon as it is made; its failure ends the analysis.
using KeepFile = std::function<absl::Status(AnalysisFile file)>;

// Analyses a mesh, and keeps files, none where the model is refused before anything is computed:
// case.json, first; heat.vtu and heat.png; for each load case and combination its number, from 1,
// and its name in plain letters, as in 1-weight.vtu and 1-weight.png; modes.vtu; probes.csv.
//
// Errors: INVALID_ARGUMENT with fields as in mortise.v1.MeshCase, below "case", or "mesh_file";
// FAILED_PRECONDITION, reasons RIGID_MOTION, SINGULAR, FREE_TEMPERATURE, NOT_CONVERGED;
// RESOURCE_EXHAUSTED, found before memory is taken, if the limit would be exceeded.
absl::StatusOr<MeshAnalysis> AnalyzeMesh(const MeshModel& model, const MeshAnalysisOptions& options,
                                         const KeepFile& keep);

// Fails with RESOURCE_EXHAUSTED if a mesh of this size, under so many load cases and with so many
// modes, needs more than the limit: bytes, the factor for the modes not included.
absl::Status CheckMemory(Eigen::Index nodes, Eigen::Index elements, std::size_t load_cases,
                         double memory_limit, int modes = 0);

}  // namespace mortise::simulator
