// Cases and meshes from files, for `mortise analyze CASE.json --mesh FILE`, and what came of them
// as tables.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/client/gateway_client.h"
#include "cli/client/long_work.h"
#include "cli/client/output.h"
#include "cli/client/tag_options.h"
#include "mortise/v1/simulator.grpc.pb.h"

namespace mortise::cli {

// The files and settings that an analysis is asked for with.
struct MeshFiles {
  std::filesystem::path case_file;
  std::filesystem::path mesh_file;
  v1::SolverKind solver;  // instead of the case's own, unless it is unspecified
  TagOptions tags = {};   // of the analysis
};

// Uploads the mesh, analyses the case and waits for the result, unless it is to run detached. What
// is wrong with either is said with the file's name: INVALID_ARGUMENT, also for fields that a case
// does not have.
absl::StatusOr<std::optional<v1::Analysis>> AnalyzeMeshFiles(const MeshFiles& files,
                                                             const LongWork& work,
                                                             v1::SimulatorService::Stub& stub,
                                                             const GatewayClient& client,
                                                             Output& output);

// Tables of load cases, temperatures and frequencies, and what of the mesh file was not used.
void PrintMeshAnalysis(const v1::Analysis& analysis, const Output& output);

// A table of load cases and combinations, if there are any.
void PrintCases(const v1::Analysis& analysis, const Output& output);

// A line on how each load case was solved.
void PrintSolvers(const v1::Analysis& analysis, const Output& output);

// A line on the temperatures, if heat was asked for; in this unit, which may be empty.
void PrintHeat(const v1::Analysis& analysis, const std::string& unit, const Output& output);

// A table of natural frequencies, if there are any.
void PrintModes(const v1::Analysis& analysis, const Output& output);

}  // namespace mortise::cli
