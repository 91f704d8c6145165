// From the methods of EvaluatorService to what answers them.
#include "services/simulator/service/evaluator_service.h"

#include <cstddef>

#include "common/rpc/method_overrides.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "services/simulator/service/evaluation_methods.h"
#include "services/simulator/service/evaluator_methods.h"

namespace mortise::simulator {
namespace {

constexpr std::size_t kCachedResults = 20000;

class EvaluatorAdapter final : public v1::EvaluatorService::CallbackService {
  using Contract = v1::EvaluatorService::CallbackService;

 public:
  explicit EvaluatorAdapter(const std::shared_ptr<SimulatorCore>& core)
      : evaluations_{core, std::make_shared<ResultCache>(kCachedResults),
                     std::make_shared<SerialExecutor>(core->dispatcher())},
        store_(*core->store()),
        endpoint_(core->dispatcher(), "mortise.v1.EvaluatorService") {}

  MORTISE_QUERY(DescribeDesignSpace, rpc::With(evaluations_, methods::DescribeDesignSpace))
  MORTISE_SERVER_STREAM(EvaluateBatch, rpc::With(evaluations_, methods::EvaluateBatch),
                        {.capacity = methods::kMaximumPoints + 8})

  MORTISE_MUTATION(CreateEvaluator, methods::CreateEvaluator)
  MORTISE_QUERY(GetEvaluator, rpc::With(store_, methods::GetEvaluator))
  MORTISE_QUERY(ListEvaluators, rpc::With(store_, methods::ListEvaluators))
  MORTISE_MUTATION(UpdateEvaluator, methods::UpdateEvaluator)
  MORTISE_MUTATION(DeleteEvaluator, methods::DeleteEvaluator)

 private:
  const methods::Evaluations evaluations_;
  store::Store& store_;
  rpc::Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeEvaluatorService(const std::shared_ptr<SimulatorCore>& core) {
  return std::make_shared<EvaluatorAdapter>(core);
}

}  // namespace mortise::simulator
