#include "cli/files/mesh_analysis.h"

#include <grpcpp/grpcpp.h>

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/client/field_sources.h"
#include "cli/client/json_input.h"
#include "cli/client/requests.h"
#include "cli/files/metric_report.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "common/base/units.h"
#include "common/design/metric_registry.h"
#include "common/rpc/chunk_calls.h"
#include "common/rpc/status_mapping.h"

namespace mortise::cli {
namespace {

using simulator::BuiltInMetric;

constexpr std::size_t kMaxCase = std::size_t{3} << 20;  // bytes

absl::StatusOr<v1::MeshCase> ReadCase(const std::filesystem::path& file) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file, kMaxCase));
  v1::MeshCase mesh_case;
  MORTISE_RETURN_IF_ERROR(ReadJson(text, file.string(), mesh_case));
  return mesh_case;
}

absl::StatusOr<std::string> Upload(const std::filesystem::path& file,
                                   v1::SimulatorService::Stub& stub, const GatewayClient& client) {
  constexpr double kSeconds = 600;
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(file));
  if (bytes.empty()) return InvalidField(file.string(), "is empty");
  v1::UploadBlobResponse response;
  MORTISE_RETURN_IF_ERROR(client.Call(
      [&](grpc::ClientContext& context) {
        const auto writer = stub.UploadBlob(&context, &response);
        rpc::SendChunks(bytes, *writer);
        return rpc::FromGrpc(writer->Finish());
      },
      kSeconds));
  return response.sha256();
}

double ValueOf(const v1::CaseResult& result, const std::string& name) {
  for (const v1::Metric& metric : result.metrics()) {
    if (metric.name() == name) return metric.value();
  }
  return 0;
}

double ValueOf(const v1::CaseResult& result, BuiltInMetric metric) {
  return ValueOf(result, simulator::DescriptionOf(metric).name);
}

// Without what is only rounding.
std::string Newtons(const v1::Vector3& force) {
  const double size = std::hypot(force.x(), force.y(), force.z());
  const auto text = [&](double x) {
    return absl::StrFormat("%.5g", std::abs(x) < 1e-9 * size ? 0 : x);
  };
  return absl::StrCat(text(force.x()), ", ", text(force.y()), ", ", text(force.z()));
}

}  // namespace

absl::StatusOr<std::optional<v1::Analysis>> AnalyzeMeshFiles(const MeshFiles& files,
                                                             const LongWork& work,
                                                             v1::SimulatorService::Stub& stub,
                                                             const GatewayClient& client,
                                                             Output& output) {
  FieldSources sources;
  sources.AddFile("case", files.case_file.string());
  sources.Add("mesh_file", files.mesh_file.string());
  v1::AnalyzeMeshRequest request;
  request.set_request_id(NewIdentifier());
  MORTISE_RETURN_IF_ERROR(AddTags(files.tags, &request));
  MORTISE_ASSIGN_OR_RETURN(*request.mutable_case_(), ReadCase(files.case_file));
  if (files.solver != v1::SOLVER_KIND_UNSPECIFIED) {
    request.mutable_case_()->set_solver(files.solver);
  }
  MORTISE_ASSIGN_OR_RETURN(*request.mutable_mesh_file(), Upload(files.mesh_file, stub, client));
  absl::StatusOr<std::optional<v1::Analysis>> analysis = RunTo<v1::Analysis>(
      client, work,
      [&](grpc::ClientContext& context, v1::Operation* operation) {
        return rpc::FromGrpc(stub.AnalyzeMesh(&context, request, operation));
      },
      output);
  if (!analysis.ok()) return sources.Name(analysis.status());
  return analysis;
}

void PrintCases(const v1::Analysis& analysis, const Output& output) {
  if (analysis.cases().empty()) return;
  std::vector<std::vector<std::string>> rows;
  for (const v1::CaseResult& result : analysis.cases()) {
    const double safety = ValueOf(result, "safety_factor");
    rows.push_back(
        {result.name(),
         absl::StrFormat("%.4g mm", ValueOf(result, BuiltInMetric::kMaxDisplacement) / kMillimetre),
         absl::StrFormat("%.4g MPa", ValueOf(result, BuiltInMetric::kMaxVonMises) / kMegapascal),
         absl::StrFormat("%.4g MPa", ValueOf(result, BuiltInMetric::kMaxPrincipal) / kMegapascal),
         safety > 0 ? absl::StrFormat("%.3g", safety) : "",
         absl::StrFormat("%.4g J", ValueOf(result, BuiltInMetric::kStrainEnergy)),
         absl::StrFormat("%.2g %%", 100 * ValueOf(result, BuiltInMetric::kRelativeError)),
         Newtons(result.total_reaction())});
  }
  output.Table({"load case", "displacement", "von Mises", "principal", "safety", "energy", "error",
                "reaction (N)"},
               rows);
}

void PrintSolvers(const v1::Analysis& analysis, const Output& output) {
  for (const v1::CaseResult& result : analysis.cases()) {
    if (!result.has_solver()) continue;
    const v1::SolverReport& solver = result.solver();
    output.Line(absl::StrFormat(
        "  %s: solved by %s, prepared in %.2g s, solved in %.2g s, residual %.1g", result.name(),
        solver.kind() == v1::DIRECT ? "a factor" : absl::StrCat(solver.iterations(), " iterations"),
        solver.preparation_seconds(), solver.solution_seconds(), solver.residual()));
  }
}

void PrintHeat(const v1::Analysis& analysis, const std::string& unit, const Output& output) {
  if (!analysis.has_heat()) return;
  double convected = 0;
  for (const double power : analysis.heat().convected()) convected += power;
  output.Line(absl::StrFormat(
      "temperatures from %.5g to %.5g%s, %.5g W of fluxes and sources, %.5g W from where "
      "temperatures are held, %.5g W to the surroundings",
      analysis.heat().minimum(), analysis.heat().maximum(), unit, analysis.heat().supplied(),
      analysis.heat().through_temperatures(), convected));
}

void PrintModes(const v1::Analysis& analysis, const Output& output) {
  if (analysis.modes().empty()) return;
  std::vector<std::vector<std::string>> rows;
  for (const v1::Mode& mode : analysis.modes()) {
    rows.push_back({absl::StrCat(rows.size() + 1), absl::StrFormat("%.5g Hz", mode.frequency()),
                    mode.rigid() ? "rigid" : ""});
  }
  output.Table({"mode", "frequency", ""}, rows);
}

void PrintMeshAnalysis(const v1::Analysis& analysis, const Output& output) {
  if (!analysis.title().empty()) output.Line(analysis.title());
  output.Line(absl::StrCat(analysis.name(), ": ", analysis.nodes(), " nodes, ", analysis.elements(),
                           " elements, ", analysis.unknowns(), " unknowns"));
  for (const v1::Metric& metric : analysis.metrics()) {
    output.Line(absl::StrCat("  ", metric.name(), " ", MetricReport(metric, analysis.metrics())));
  }
  PrintCases(analysis, output);
  PrintSolvers(analysis, output);
  PrintHeat(analysis, "", output);
  PrintModes(analysis, output);
  for (const std::string& note : analysis.notes()) output.Line("note: " + note);
  const std::string advice = AdviceOnError(analysis);
  if (!advice.empty()) output.Line("note: " + advice);
}

}  // namespace mortise::cli
