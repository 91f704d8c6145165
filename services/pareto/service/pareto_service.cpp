// From the methods of ParetoService to what answers them.
#include "services/pareto/service/pareto_service.h"

#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/rpc/method_overrides.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "services/pareto/service/discovery_methods.h"
#include "services/pareto/service/discovery_operation.h"
#include "services/pareto/service/front_cache.h"
#include "services/pareto/service/front_methods.h"
#include "services/pareto/service/pareto.h"

namespace mortise::pareto {
namespace {

constexpr std::size_t kCachedFronts = 32;

class ParetoAdapter final : public v1::ParetoService::CallbackService {
  using Contract = v1::ParetoService::CallbackService;

 public:
  explicit ParetoAdapter(const rpc::ServiceEnvironment& environment)
      : pareto_{environment.store, environment.operations, environment.peers, &explored_},
        endpoint_(environment.dispatcher, "mortise.v1.ParetoService") {}

  MORTISE_PREPARED_MUTATION(DiscoverFront, rpc::With(pareto_, methods::SettleDiscovery),
                            rpc::With(pareto_, methods::DiscoverFront))
  MORTISE_QUERY(GetFront, rpc::With(pareto_, methods::GetFront))
  MORTISE_QUERY(ListFronts, rpc::With(pareto_, methods::ListFronts))
  MORTISE_MUTATION(UpdateFront, methods::UpdateFront)
  MORTISE_QUERY(PickPoint, rpc::With(pareto_, methods::PickPoint))
  MORTISE_QUERY(RestrictFront, rpc::With(pareto_, methods::RestrictFront))
  MORTISE_SERVER_STREAM(ExportFront, rpc::With(pareto_, methods::ExportFront))

 private:
  FrontCache explored_{kCachedFronts};
  const Pareto pareto_;
  rpc::Endpoint endpoint_;
};

}  // namespace

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment) {
  environment.operations->Register(operations::kDiscoveryOperation,
                                   [&environment](operations::OperationContext& context) {
                                     return RunDiscoveryOperation(environment, context);
                                   });
  return std::vector<std::shared_ptr<grpc::Service>>{std::make_shared<ParetoAdapter>(environment)};
}

}  // namespace mortise::pareto
