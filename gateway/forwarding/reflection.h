// The reflection service of the front door: describes every method of the contract, wherever it is
// answered, so that tools such as grpcurl and `mortise call` need no proto files.
#pragma once

#include <grpcpp/generic/async_generic_service.h>

#include <chrono>
#include <memory>
#include <string_view>

#include "gateway/admission/open_calls.h"

namespace mortise::gateway {

class Contract;

// Whether a path is the one method of grpc.reflection.v1alpha.ServerReflection, or of v1.
bool IsReflection(std::string_view path);

// Answers one reflection stream, which keeps its place and has so much time; deletes itself.
// `contract` must outlive it.
grpc::ServerGenericBidiReactor* MakeReflection(const Contract& contract,
                                               grpc::CallbackServerContext& call,
                                               std::unique_ptr<OpenCalls::Place> place,
                                               std::chrono::milliseconds time);

}  // namespace mortise::gateway
