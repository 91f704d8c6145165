#include "services/simulator/mesh_task.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/grouped_mesh.h"
#include "common/rpc/message_check.h"
#include "services/simulator/mesh_analysis.h"
#include "services/simulator/mesh_model.h"

namespace mortise::simulator {
namespace {

// The memory a mesh file may take while it is read, as a multiple of its size. Ordinary ones take
// 3, the worst a dozen.
constexpr double kMemoryOfFile = 12;

template <typename Message>
void AddMetric(const char* name, const char* unit, double value, Message& message) {
  v1::Metric& metric = *message.add_metrics();
  metric.set_name(name);
  metric.set_unit(unit);
  metric.set_value(value);
}

void Fill(const CaseOutcome& outcome, const std::vector<std::string>& parts,
          v1::CaseResult& message) {
  message.set_name(outcome.name);
  const ElasticitySummary& summary = outcome.summary;
  AddMetric("max_displacement", "m", summary.maximum_displacement, message);
  AddMetric("max_von_mises", "Pa", outcome.maximum_von_mises, message);
  AddMetric("max_principal", "Pa", outcome.maximum_principal, message);
  AddMetric("strain_energy", "J", summary.strain_energy, message);
  AddMetric("compliance", "J", summary.compliance, message);
  AddMetric("relative_error", "1", outcome.relative_error, message);
  const double safety = outcome.part_safety_factor.minCoeff();
  if (std::isfinite(safety)) AddMetric("safety_factor", "1", safety, message);
  *message.mutable_total_load() = ToProto(summary.total_load);
  *message.mutable_total_reaction() = ToProto(summary.total_reaction);
  for (const Eigen::Vector3d& reaction : outcome.reactions) {
    *message.add_reactions() = ToProto(reaction);
  }
  *message.mutable_max_displacement_at() = ToProto(outcome.maximum_displacement_at);
  *message.mutable_max_von_mises_at() = ToProto(outcome.maximum_von_mises_at);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    v1::CaseResult::PartResult& part = *message.add_parts();
    part.set_name(parts[p]);
    part.set_max_von_mises(outcome.part_maximum_von_mises[p]);
    if (std::isfinite(outcome.part_safety_factor[p])) {
      part.set_safety_factor(outcome.part_safety_factor[p]);
    }
  }
}

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
  if (!analysis.heat) return;
  v1::HeatResult& heat = *message.mutable_heat();
  heat.set_minimum(analysis.heat->minimum);
  heat.set_maximum(analysis.heat->maximum);
  heat.set_supplied(analysis.heat->supplied);
  heat.set_through_temperatures(analysis.heat->through_temperatures);
  for (const double power : analysis.heat->convected) heat.add_convected(power);
}

}  // namespace

v1::Vector3 ToProto(const Eigen::Vector3d& vector) {
  v1::Vector3 message;
  message.set_x(vector.x());
  message.set_y(vector.y());
  message.set_z(vector.z());
  return message;
}

absl::Status EvaluateMeshTask(const v1::Task& task, const TaskSurroundings& surroundings,
                              v1::ReportTaskRequest& report) {
  StageProgress* const progress = surroundings.progress;
  if (progress != nullptr) progress->Begin("mesh");
  MeshModel model;
  {
    // File and groups are not needed any more once the model is made.
    MORTISE_ASSIGN_OR_RETURN(
        const std::string bytes,
        surroundings.fetch(task.mesh_file(), surroundings.memory_limit / kMemoryOfFile));
    MORTISE_ASSIGN_OR_RETURN(const mesh::GroupedMesh grouped, mesh::ReadGroupedMesh(bytes));
    MORTISE_RETURN_IF_ERROR(CheckMemory(grouped.nodes.cols(), grouped.tetrahedra.cols(),
                                        static_cast<std::size_t>(task.case_().load_cases_size()),
                                        surroundings.memory_limit));
    MORTISE_ASSIGN_OR_RETURN(model, MakeMeshModel(grouped, task.case_()));
    for (const std::string& note : grouped.notes) report.mutable_analysis()->add_notes(note);
  }
  if (progress != nullptr) progress->Expect(1 + StagesOf(model));
  MORTISE_ASSIGN_OR_RETURN(const MeshAnalysis analysis,
                           AnalyzeMesh(model,
                                       {.memory_limit = surroundings.memory_limit,
                                        .threads = surroundings.threads,
                                        .stop = surroundings.stop,
                                        .progress = progress},
                                       surroundings.keep));
  AddMetric("mass", "kg", analysis.mass, *report.mutable_result());
  AddMetric("volume", "m^3", analysis.volume, *report.mutable_result());
  Fill(analysis, model, *report.mutable_analysis());
  // A report that is not finite would be refused, and the task tried again and again.
  const absl::Status finite = rpc::CheckMessage(report);
  if (finite.ok()) return absl::OkStatus();
  return InvalidField("case",
                      absl::StrCat("leads to results that are not finite: ", finite.message()));
}

}  // namespace mortise::simulator
