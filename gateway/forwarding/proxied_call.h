// What unary calls and streams through the proxy have in common. Private to the proxy.
#pragma once

#include <grpcpp/client_context.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/generic/generic_stub.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "gateway/admission/connection_patience.h"
#include "gateway/forwarding/proxy.h"
#include "gateway/forwarding/token_end.h"

namespace mortise::gateway {

// Whether it is worth letting go before its call ends.
inline bool IsLarge(const grpc::ByteBuffer& message) { return message.Length() > kSmallBodyBytes; }

// The client's side of a call: its context, and what was found out about it.
class ProxiedCall {
 public:
  ProxiedCall(const ProxyOptions& proxy, const MethodRoute* method,
              grpc::GenericCallbackServerContext* context);
  ProxiedCall(const ProxiedCall&) = delete;
  ProxiedCall& operator=(const ProxiedCall&) = delete;

  // Checks token, role, metadata and the number of calls. The request id is known, and promised to
  // the client, in any case.
  absl::Status Admit();

  // Expands a message of the client's if it is compressed. One that is large then has room taken
  // for it until the next one, LetGo or the end of the call; RESOURCE_EXHAUSTED, TOO_MANY_CALLS if
  // there is none.
  absl::Status Expand(grpc::ByteBuffer& message);

  // The room of a message that was passed on, with more to come.
  void LetGo() { room_.reset(); }

  // Finds the service and fills the context of the call to it: deadline, metadata, identity.
  // `first` is read only where the route depends on the message, or it is large: it need not be
  // kept for Conclude then. Null with `error` set if there is no such service, it has too many
  // calls, or it could not read the message.
  GenericStub* Prepare(const grpc::ByteBuffer* first, absl::Status& error);

  // Passes what the service sent before its first message on to the client.
  void CopyInitialMetadata();

  // Returns the status for the client, after the service's trailing metadata was passed on. A
  // service that could not be reached is named, and a request that it could not read is said to be
  // that: `request` is the only message of the client's, if it is small; null if there may be many.
  grpc::Status Conclude(const grpc::Status& upstream, const grpc::ByteBuffer* request);

  // Writes the log line. Once, when all is over.
  void Record(const grpc::Status& status);

  void Cancel() { upstream_.TryCancel(); }

  const MethodRoute& method() const { return *method_; }
  grpc::ClientContext& upstream() { return upstream_; }

 private:
  absl::Status CheckMetadata() const;
  bool ExpiredWith(const grpc::Status& upstream) const;

  const ProxyOptions& proxy_;
  const MethodRoute* method_;
  grpc::GenericCallbackServerContext* context_;
  grpc::ClientContext upstream_;
  std::shared_ptr<const Upstreams::Connection> connection_;
  std::optional<ConnectionPatience> patience_;
  std::shared_ptr<const Caller> caller_;
  std::unique_ptr<Budget::Share> room_;
  std::unique_ptr<OpenCalls::Place> place_;
  std::optional<CallTokenEnd> token_end_;  // of streams
  std::string request_id_;
  std::string service_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// Make the two kinds of reactor. Each deletes itself when its call is over.
grpc::ServerGenericBidiReactor* MakeUnaryForward(std::unique_ptr<ProxiedCall> call);
grpc::ServerGenericBidiReactor* MakeStreamForward(std::unique_ptr<ProxiedCall> call);

// Answers with a status at once.
grpc::ServerGenericBidiReactor* MakeRefusal(std::unique_ptr<ProxiedCall> call,
                                            const absl::Status& status);

}  // namespace mortise::gateway
