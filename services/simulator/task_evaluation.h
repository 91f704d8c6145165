// One task computed: F(q), mesh, solution, metrics, and the files where they are wanted.
#pragma once

#include <string>
#include <vector>

#include "common/rpc/channel.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/template_source.h"

namespace mortise::simulator {

// A file that belongs to a result.
struct TaskFile {
  std::string name;        // "stress.png"
  std::string media_type;  // "image/png"
  std::string bytes;
};

struct TaskOutcome {
  v1::ReportTaskRequest report;  // metrics, gradients and analysis, or the error; without the task
  std::vector<TaskFile> files;   // not yet among the analysis's artifacts
};

// Never fails: what goes wrong becomes the error of the report. `origin` is for the catalog.
TaskOutcome EvaluateTask(TemplateSource& templates, const v1::Task& task,
                         const rpc::Origin& origin);

}  // namespace mortise::simulator
