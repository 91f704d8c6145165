#include "services/simulator/service/analysis_methods.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/design/parameter_values.h"
#include "common/files/evaluation_settings.h"
#include "common/files/template_codec.h"
#include "common/host/call_author.h"
#include "common/host/chunk_stream.h"
#include "common/host/operation_codec.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/resources/resource_tags.h"
#include "common/rpc/channel.h"
#include "services/simulator/analysis/design_analysis.h"
#include "services/simulator/service/analysis_records.h"
#include "services/simulator/service/file_upkeep.h"
#include "services/simulator/service/simulator_core.h"
#include "services/simulator/worker/analysis_setup.h"
#include "services/simulator/worker/design_conditions.h"
#include "services/simulator/worker/mesh_case.h"
#include "services/simulator/worker/subject_metrics.h"
#include "services/simulator/worker/template_model.h"

namespace mortise::simulator::methods {
namespace {

constexpr int kMaximumModes = 100;

// What is computed of a design, of all that could be.
struct Physics {
  bool loads = false;
  bool heat = false;
  bool modes = false;
  bool airflow = false;

  bool Provides(MetricSource source) const {
    switch (source) {
      case MetricSource::kLoads:
        return loads;
      case MetricSource::kHeat:
        return heat;
      case MetricSource::kModes:
        return modes;
      case MetricSource::kAirflow:
        return airflow;
      default:
        return true;
    }
  }

  bool Meets(const MetricDemands& demands) const {
    return (!demands.loads || loads) && (!demands.heat || heat) && (!demands.modes || modes) &&
           (!demands.airflow || airflow);
  }
};

absl::Status CheckModes(int modes) {
  if (modes >= 0 && modes <= kMaximumModes) return absl::OkStatus();
  return InvalidField("modes", absl::StrCat("must be 0 to ", kMaximumModes));
}

// What can be said of a request before its template is there.
absl::Status CheckRequest(const v1::AnalyzeDesignRequest& asked) {
  return CombineViolations(
      CombineViolations(parametric::CheckMeshSettings(asked.mesh()),
                        parametric::ReadAirflow(asked.airflow()).status()),
      CombineViolations(CheckModes(asked.modes()), resources::ValidateTags(asked)));
}

// Touches the file, so that it stays until the operation, which names it, is there.
absl::Status CheckMeshFile(store::BlobFolder& blobs, const std::string& mesh_file) {
  const absl::Status there = KeepYoung(blobs, mesh_file);
  if (there.ok()) return there;
  return InvalidField("mesh_file", absl::IsNotFound(there)
                                       ? "has not been uploaded"
                                       : "must be 64 lower-case hexadecimal digits");
}

absl::StatusOr<std::shared_ptr<const EvaluatedTemplate>> FindTemplate(
    const Simulator& simulator, const rpc::Call& call, const v1::AnalyzeDesignRequest& asked) {
  absl::StatusOr<std::shared_ptr<const EvaluatedTemplate>> compiled =
      simulator.core->templates().Get(asked.template_(), asked.template_revision(),
                                      rpc::ForwardedFrom(call));
  if (!compiled.ok() && DetailOf(compiled.status()).field == "subject") {
    return InvalidField("template", std::string(compiled.status().message()));
  }
  return compiled;
}

// What of a design can be computed and is asked for; fails where nothing holds it.
absl::StatusOr<Physics> PhysicsOf(const parametric::EvaluatedDesign& design,
                                  const v1::AnalyzeDesignRequest& asked) {
  Physics physics{.heat = HasHeat(design), .modes = asked.modes() > 0};
  physics.airflow = asked.has_airflow();
  physics.loads = IsLoaded(design) || (!physics.heat && !physics.airflow);
  if (physics.loads) MORTISE_RETURN_IF_ERROR(CheckSupported(design));
  if (physics.heat) MORTISE_RETURN_IF_ERROR(CheckHeated(design));
  return physics;
}

// Asks for every metric that this physics gives.
absl::Status AddMetrics(const EvaluatedTemplate& compiled, const Physics& physics, v1::Task& task) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::MetricExpressions own, CustomMetricsOf(compiled, {}));
  for (const MetricDescription& metric : OfferedMetrics()) {
    const bool is_own = own.Find(metric.name) >= 0;  // of an older template
    if (physics.Provides(metric.source) && !is_own) task.add_metrics(metric.name);
  }
  for (const parametric::MetricDefinition& metric : own.metrics()) {
    if (physics.Meets(DemandsOf({metric.name}, own))) task.add_metrics(metric.name);
  }
  return absl::OkStatus();
}

absl::StatusOr<v1::Operation> Start(const Simulator& simulator, const rpc::Call& call,
                                    v1::Task& task, store::Transaction& transaction) {
  task.set_trace_id(call.identity().trace_id);
  MORTISE_ASSIGN_OR_RETURN(const operations::Operation operation,
                           simulator.operations->Start(
                               transaction, rpc::OperationOf(call, operations::kAnalysisOperation,
                                                             task.subject(), task)));
  return rpc::ToProto(operation);
}

// Whether a list can be of the analyses of this subject.
absl::Status CheckSubject(const std::string& subject) {
  if (subject.empty()) return absl::OkStatus();
  return ParseResourceName(subject, "templates", "subject").status();
}

}  // namespace

absl::StatusOr<v1::Task> PrepareDesign(const Simulator& simulator, const rpc::Call& call,
                                       const v1::AnalyzeDesignRequest& asked) {
  MORTISE_RETURN_IF_ERROR(CheckRequest(asked));
  MORTISE_ASSIGN_OR_RETURN(const auto compiled, FindTemplate(simulator, call, asked));
  MORTISE_ASSIGN_OR_RETURN(
      const Eigen::VectorXd parameters,
      parametric::CompleteParameters(compiled->design_template->parameters(),
                                     parametric::FromProto(asked.parameters())));
  MORTISE_ASSIGN_OR_RETURN(parametric::EvaluatedDesign design,
                           compiled->design_template->Evaluate(parameters));
  v1::Task task;
  if (asked.has_setup()) {
    *task.mutable_setup() = asked.setup();
    MORTISE_RETURN_IF_ERROR(AddSetup(*task.mutable_setup(), design));
  }
  MORTISE_ASSIGN_OR_RETURN(const Physics physics, PhysicsOf(design, asked));
  task.set_evaluator(kSimulatorQueue);
  task.set_subject(compiled->name);
  task.set_revision(compiled->revision);
  task.set_digest(compiled->digest);
  for (const double value : parameters) task.mutable_point()->add_parameters(value);
  MORTISE_RETURN_IF_ERROR(AddMetrics(*compiled, physics, task));
  task.set_modes(asked.modes());
  task.set_fields(true);
  task.set_solver(asked.solver());
  *task.mutable_mesh() = asked.mesh();
  if (asked.has_airflow()) *task.mutable_airflow() = asked.airflow();
  resources::CopyTags(asked, &task);
  return task;
}

absl::StatusOr<v1::Operation> AnalyzeDesign(const Simulator& simulator, const rpc::Call& call,
                                            const v1::AnalyzeDesignRequest&, v1::Task& task,
                                            store::Transaction& transaction) {
  return Start(simulator, call, task, transaction);
}

absl::StatusOr<v1::Task> PrepareMesh(const Simulator& simulator, const rpc::Call& call,
                                     const v1::AnalyzeMeshRequest& asked) {
  MORTISE_RETURN_IF_ERROR(
      CombineViolations(CombineViolations(CheckMeshCase(asked.case_(), "case"),
                                          CheckMeshFile(*simulator.blobs, asked.mesh_file())),
                        resources::ValidateTags(asked)));
  v1::Task task;
  task.set_evaluator(kSimulatorQueue);
  task.set_fields(true);
  task.set_mesh_file(asked.mesh_file());
  v1::MeshCase& mesh_case = *task.mutable_case_();
  mesh_case = asked.case_();
  for (int i = 0; i < mesh_case.materials_size(); ++i) {
    v1::MeshMaterial& use = *mesh_case.mutable_materials(i);
    if (!use.has_material()) continue;
    MORTISE_ASSIGN_OR_RETURN(const v1::Material material,
                             simulator.core->GetMaterial(use.material(), rpc::ForwardedFrom(call)));
    UseCatalogMaterial(material, use);
  }
  MORTISE_RETURN_IF_ERROR(CheckMeshCase(mesh_case, "case"));
  resources::CopyTags(asked, &task);
  return task;
}

absl::StatusOr<v1::Operation> AnalyzeMesh(const Simulator& simulator, const rpc::Call& call,
                                          const v1::AnalyzeMeshRequest&, v1::Task& task,
                                          store::Transaction& transaction) {
  return Start(simulator, call, task, transaction);
}

absl::StatusOr<v1::Analysis> GetAnalysis(const Simulator& simulator, const rpc::Call&,
                                         const v1::GetAnalysisRequest& asked) {
  return kAnalyses.Get(*simulator.core->store(), asked.name());
}

absl::StatusOr<v1::ListAnalysesResponse> ListAnalyses(const Simulator& simulator, const rpc::Call&,
                                                      const v1::ListAnalysesRequest& asked) {
  MORTISE_RETURN_IF_ERROR(CombineViolations(
      CombineViolations(resources::ReadPageQuery(asked).status(), CheckSubject(asked.subject())),
      resources::ResourceFilter::Of(asked).status()));
  const auto is_of_subject = [&asked](const v1::Analysis& analysis) {
    return asked.subject().empty() || analysis.template_() == asked.subject();
  };
  MORTISE_ASSIGN_OR_RETURN(auto page,
                           kAnalyses.List(*simulator.core->store(), asked, is_of_subject));
  return resources::ToResponse(std::move(page), &v1::ListAnalysesResponse::mutable_analyses);
}

absl::StatusOr<v1::Analysis> UpdateAnalysis(const rpc::Call& call,
                                            const v1::UpdateAnalysisRequest& asked,
                                            store::Transaction& transaction) {
  return kAnalyses.UpdateTags(transaction, asked.analysis(), asked.update_mask(), "analysis",
                              rpc::AuthorOf(call));
}

absl::Status DownloadArtifact(const Simulator& simulator, const rpc::Call&,
                              const v1::DownloadArtifactRequest& asked,
                              const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
  MORTISE_ASSIGN_OR_RETURN(const v1::Analysis analysis,
                           kAnalyses.Get(*simulator.core->store(), asked.name()));
  return rpc::StreamArtifact(simulator.blobs, asked.name(), analysis.artifacts(), asked.file_name(),
                             writer);
}

}  // namespace mortise::simulator::methods
