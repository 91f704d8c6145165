// EvaluatorService for templates: design spaces described, batches of points evaluated by workers.
#pragma once

#include <memory>

namespace grpc {
class Service;
}
namespace mortise::simulator {

class SimulatorCore;

std::shared_ptr<grpc::Service> MakeEvaluatorService(const std::shared_ptr<SimulatorCore>& core);

}  // namespace mortise::simulator
