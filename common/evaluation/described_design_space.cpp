// One call, repeated while the evaluator is away.
#include "common/evaluation/described_design_space.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include "common/base/errors.h"
#include "mortise/v1/evaluator.grpc.pb.h"

namespace mortise::evaluation {

absl::StatusOr<std::unique_ptr<v1::DesignSpace>> DescribeDesignSpace(
    const std::shared_ptr<grpc::Channel>& channel, const v1::DescribeDesignSpaceRequest& request,
    const rpc::Origin& origin, const rpc::RetryOptions& retry) {
  const std::unique_ptr<v1::EvaluatorService::Stub> stub = v1::EvaluatorService::NewStub(channel);
  auto described = std::make_unique<v1::DesignSpace>();
  MORTISE_RETURN_IF_ERROR(rpc::CallWithRetry(origin, retry, [&](grpc::ClientContext* context) {
    described->Clear();
    return stub->DescribeDesignSpace(context, request, described.get());
  }));
  return described;
}

}  // namespace mortise::evaluation
