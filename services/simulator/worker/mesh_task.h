// Reads and computes one task on an uploaded mesh, and tells of it as mortise.v1.Analysis.
#pragma once

#include "absl/status/status.h"
#include "services/simulator/worker/task_evaluation.h"

namespace mortise::simulator {

// Fills the report's metrics (mass and volume) and its analysis. Fails as ReadGroupedMesh,
// MakeMeshModel and AnalyzeMesh do.
absl::Status EvaluateMeshTask(const v1::Task& task, const TaskContext& context,
                              v1::ReportTaskRequest& report);

}  // namespace mortise::simulator
