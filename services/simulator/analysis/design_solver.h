// Solves a design on meshes: its temperatures, and its load cases over one factor.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/tetrahedral_mesh.h"
#include "services/simulator/analysis/design_analysis.h"

namespace mortise::simulator {

struct SolvedDesign {
  std::optional<HeatSolution> heat;
  std::vector<SolvedCase> cases;
  // The gradients of those metrics and calls that were asked for, and have one, by name or text of
  // the call.
  std::map<std::string, Eigen::VectorXd> gradients = {};
};

// Returns what every load case of a model is: what acts in all, and its own.
std::vector<NamedLoadCase> LoadCasesOf(const DesignModel& model);

// What is found of each load case besides its solution.
struct CaseDetails {
  bool error = false;   // an estimate of how far off it is
  bool spread = false;  // how the stress is spread over the volume
};

class DesignSolver {
 public:
  // `model` and `options` must outlive it. Where a refinement is wanted, errors are estimated in
  // any case. Gradients are those of the metrics `gradients`, where the options say how the design
  // moves.
  DesignSolver(const DesignModel& model, const DesignAnalysisOptions& options, CaseDetails details,
               std::vector<std::string> gradients = {});

  // Returns the temperatures of a model that has heat; fails as SolveHeat.
  absl::StatusOr<HeatSolution> Heat(const mesh::TetrahedralMesh& mesh) const;

  // Returns all load cases; the temperatures where they act, or are wanted. Fails as Heat and
  // ElasticSystem do; RESOURCE_EXHAUSTED if the solutions would not fit into the memory.
  absl::StatusOr<SolvedDesign> Solve(const mesh::TetrahedralMesh& mesh, bool heat_wanted) const;

 private:
  void AddDetails(const mesh::TetrahedralMesh& mesh, ThreadTeam& team, SolvedCase& of) const;
  void Begin(std::string stage) const;
  std::string StageOf(std::size_t index) const;

  const DesignModel& model_;
  const DesignAnalysisOptions& options_;
  const std::vector<NamedLoadCase> load_cases_;
  CaseDetails details_;
  const std::vector<std::string> gradients_;
};

}  // namespace mortise::simulator
