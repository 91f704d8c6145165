// Computes one task: F(q) or an uploaded mesh, solution, metrics, and the files where they are
// wanted.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "common/fem/linear/stage_progress.h"
#include "common/rpc/channel.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/analysis/analysis_report.h"
#include "services/simulator/worker/template_source.h"

namespace mortise::simulator {

// The reason of a failure for the worker's limit of time.
inline constexpr char kTimeLimit[] = "TIME_LIMIT";

// The things that a task needs from outside.
struct TaskContext {
  TemplateSource& templates;
  rpc::Origin origin;  // for the catalog

  // Stores a file of the analysis at once; it becomes one of the analysis's artifacts.
  std::function<absl::Status(const AnalysisFile& file)> keep;

  // Stores bytes, and returns their digest.
  std::function<absl::StatusOr<std::string>(const std::string& bytes)> upload;

  // Returns the bytes of an uploaded file; RESOURCE_EXHAUSTED past `limit`.
  std::function<absl::StatusOr<std::string>(const std::string& sha256, double limit)> fetch;

  double memory_limit = 8e9;  // bytes
  int threads = 1;
  StageProgress* progress = nullptr;  // told of stages, if it is there
  std::stop_token stop = {};          // ends the evaluation at its next step, as CANCELLED
};

// Returns metrics, gradients and analysis, or the error, without the task and the artifacts. It
// never fails: what goes wrong becomes the error of the report.
v1::ReportTaskRequest EvaluateTask(const v1::Task& task, const TaskContext& context);

}  // namespace mortise::simulator
