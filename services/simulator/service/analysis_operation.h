// The operation that AnalyzeDesign and AnalyzeMesh start: one task with fields and pictures.
#pragma once

#include <memory>

namespace mortise::operations {
class Operations;
}

namespace mortise::simulator {

class SimulatorCore;

// What the keys of their tasks begin with.
inline constexpr char kAnalysisTaskPrefix[] = "analysis-";

// Names the handler: it queues the task that is the operation's request, waits for a worker, and
// keeps the Analysis, with the external ids and labels of the task and who started the operation as
// its creator.
void RegisterAnalysis(operations::Operations& operations,
                      const std::shared_ptr<SimulatorCore>& core);

}  // namespace mortise::simulator
