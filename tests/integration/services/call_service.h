// Calls of a service under test.
#pragma once

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <string>

#include "absl/status/statusor.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/types.pb.h"

namespace mortise::testing {

// For a call that may take a while, beside other tests.
inline void Prepare(grpc::ClientContext& context) {
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(200));
  context.set_wait_for_ready(true);
}

// What the service answers.
template <class Stub, class Request, class Response>
absl::StatusOr<Response> Call(Stub& stub,
                              grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                                           Response*),
                              const Request& request) {
  grpc::ClientContext context;
  Prepare(context);
  Response response;
  const grpc::Status status = (stub.*method)(&context, request, &response);
  if (!status.ok()) return rpc::FromGrpc(status);
  return response;
}

// All that an export sends.
template <class Reader>
absl::StatusOr<std::string> ReadChunks(Reader& reader) {
  std::string bytes;
  v1::Chunk chunk;
  while (reader.Read(&chunk)) bytes += chunk.data();
  const grpc::Status status = reader.Finish();
  if (!status.ok()) return rpc::FromGrpc(status);
  return bytes;
}

}  // namespace mortise::testing
