// How the commands of `mortise compose` call the composer.
#pragma once

#include <grpcpp/client_context.h>

#include "absl/status/statusor.h"
#include "cli/client/gateway_client.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/composer.grpc.pb.h"

namespace mortise::cli {

// s, that a call may take: opening a model parametrises it, which lasts for hundreds of parts.
inline constexpr double kMaxSecondsOfComposing = 600;

// Calls a method of the composer, and returns its answer. Fails as the method does.
template <typename Request, typename Response>
absl::StatusOr<Response> AskComposer(const GatewayClient& client,
                                     grpc::Status (v1::ComposerService::Stub::*method)(
                                         grpc::ClientContext*, const Request&, Response*),
                                     const Request& request) {
  const auto stub = v1::ComposerService::NewStub(client.channel());
  Response response;
  MORTISE_RETURN_IF_ERROR(client.Call(
      [&](grpc::ClientContext& context) {
        return rpc::FromGrpc(((*stub).*method)(&context, request, &response));
      },
      kMaxSecondsOfComposing));
  return response;
}

}  // namespace mortise::cli
