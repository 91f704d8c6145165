#include "common/host/operation_service.h"

#include "common/host/operation_methods.h"
#include "common/rpc/method_overrides.h"
#include "mortise/v1/operations.grpc.pb.h"

namespace mortise::rpc {
namespace {

class OperationAdapter final : public v1::OperationService::CallbackService {
  using Contract = v1::OperationService::CallbackService;

 public:
  explicit OperationAdapter(const HostedOperations& host)
      : host_(host), endpoint_(host.dispatcher, "mortise.v1.OperationService") {}

  MORTISE_QUERY(GetOperation, With(host_, methods::GetOperation))
  MORTISE_QUERY(ListOperations, With(host_, methods::ListOperations))
  MORTISE_PREPARED_MUTATION(CancelOperation, With(host_, methods::StopOperation),
                            With(host_, methods::CancelOperation))
  MORTISE_ASYNC_QUERY(WaitOperation, With(host_, methods::WaitOperation))
  MORTISE_SERVER_STREAM(WatchOperation, With(host_, methods::WatchOperation), {.endless = true})

 private:
  const HostedOperations host_;
  Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeOperationService(Dispatcher* dispatcher,
                                                    operations::Operations* operations) {
  return std::make_shared<OperationAdapter>(HostedOperations{dispatcher, operations});
}

}  // namespace mortise::rpc
