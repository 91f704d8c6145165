#include "services/simulator/worker/mesh_task.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/metric_registry.h"
#include "common/mesh/files/grouped_mesh.h"
#include "common/rpc/message_check.h"
#include "services/simulator/analysis/mesh_analysis.h"
#include "services/simulator/worker/analysis_codec.h"
#include "services/simulator/worker/mesh_model.h"

namespace mortise::simulator {
namespace {

// The memory a mesh file may take while it is read, as a multiple of its size. Ordinary ones take
// 3, the worst a dozen.
constexpr double kMemoryOfFile = 12;

void Fill(const MeshAnalysis& analysis, const MeshModel& model, v1::Analysis& message) {
  message.set_title(model.title);
  message.set_nodes(analysis.nodes);
  message.set_elements(analysis.elements);
  message.set_unknowns(analysis.unknowns);
  message.set_seconds(analysis.seconds);
  for (const CaseOutcome& outcome : analysis.cases) {
    Fill(outcome, model.mesh.part_names, *message.add_cases());
  }
  for (const ModeOutcome& mode : analysis.modes) {
    v1::Mode& to = *message.add_modes();
    to.set_frequency(mode.frequency);
    to.set_rigid(mode.rigid);
  }
  if (analysis.heat) Fill(*analysis.heat, *message.mutable_heat());
  for (const std::string& note : analysis.notes) message.add_notes(note);
}

}  // namespace

absl::Status EvaluateMeshTask(const v1::Task& task, const TaskContext& context,
                              v1::ReportTaskRequest& report) {
  StageProgress* const progress = context.progress;
  if (progress != nullptr) progress->Begin("mesh");
  MeshModel model;
  {
    // File and groups are not needed any more once the model is made.
    MORTISE_ASSIGN_OR_RETURN(const std::string bytes,
                             context.fetch(task.mesh_file(), context.memory_limit / kMemoryOfFile));
    MORTISE_ASSIGN_OR_RETURN(const mesh::GroupedMesh grouped, mesh::ReadGroupedMesh(bytes));
    MORTISE_RETURN_IF_ERROR(CheckMemory(grouped.nodes.cols(), grouped.tetrahedra.cols(),
                                        static_cast<std::size_t>(task.case_().load_cases_size()),
                                        context.memory_limit));
    MORTISE_ASSIGN_OR_RETURN(model, MakeMeshModel(grouped, task.case_()));
    for (const std::string& note : grouped.notes) report.mutable_analysis()->add_notes(note);
  }
  if (progress != nullptr) progress->Expect(1 + StagesOf(model));
  MORTISE_ASSIGN_OR_RETURN(const MeshAnalysis analysis,
                           AnalyzeMesh(model,
                                       {.memory_limit = context.memory_limit,
                                        .threads = context.threads,
                                        .stop = context.stop,
                                        .progress = progress},
                                       context.keep));
  *report.mutable_result()->add_metrics() = ToProto(MetricOf(BuiltInMetric::kMass, analysis.mass));
  *report.mutable_result()->add_metrics() =
      ToProto(MetricOf(BuiltInMetric::kVolume, analysis.volume));
  Fill(analysis, model, *report.mutable_analysis());
  // A report that is not finite would be refused, and the task tried again and again.
  const absl::Status finite = rpc::CheckMessage(report);
  if (finite.ok()) return absl::OkStatus();
  return InvalidField("case",
                      absl::StrCat("leads to results that are not finite: ", finite.message()));
}

}  // namespace mortise::simulator
