// Calls from the HTTP door to the gRPC door in the same process, awaited by coroutines.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gateway/contract/connect_protocol.h"
#include "gateway/forwarding/awaitable.h"
#include "gateway/forwarding/upstreams.h"

namespace grpc {
class Status;
}

namespace mortise::gateway {

// What a call needs besides its messages.
struct CallHead {
  std::string path;     // "/mortise.v1.CatalogService/GetItem"
  HeaderList metadata;  // legal metadata only (IsLegalMetadata)
  std::optional<std::chrono::system_clock::time_point> deadline;
};

// One call, whose requests are known when it starts. Used by one coroutine, apart from Cancel.
// Dropping the handle cancels what is left of the call.
class ClientCall {
 public:
  // Begins a call of a unary method. Its answer comes from the first Read, unless it failed.
  static std::shared_ptr<ClientCall> StartUnary(GenericStub& stub, const CallHead& head,
                                                std::string_view request);

  // Begins a call of a method that streams one way or both. The next answer is only asked for when
  // Read is called, so a slow reader slows the sender.
  static std::shared_ptr<ClientCall> StartStreaming(GenericStub& stub, const CallHead& head,
                                                    const std::vector<std::string>& requests);
  virtual ~ClientCall() = default;

  // Returns the next answer; nothing at the end, when status() is known. Do not call again after
  // that.
  virtual boost::asio::awaitable<std::optional<std::string>> Read() = 0;

  // Returns how the call ended. After the last Read.
  virtual const grpc::Status& status() const = 0;

  // Returns metadata that came first (after the first Read) and last (after the last Read); without
  // reserved entries.
  virtual HeaderList leading() const = 0;
  virtual HeaderList trailing() const = 0;

  // From any thread: the pending and every later Read ends.
  virtual void Cancel() = 0;
};

// One call of a method that takes a stream and gives one answer, whose requests come by and by.
// Used by one coroutine, apart from Cancel. Dropping the handle cancels what is left of the call.
class UploadCall {
 public:
  // `answered` is called once, from another thread, as soon as the service has answered or the call
  // is over: it wants no more then.
  static std::shared_ptr<UploadCall> Start(GenericStub& stub, const CallHead& head,
                                           std::function<void()> answered);
  virtual ~UploadCall() = default;

  // Sends a message, and waits until there is room for the next one. False if the call is over,
  // which Finish then tells more of.
  virtual boost::asio::awaitable<bool> Write(std::string_view message) = 0;

  // Says that there are no more messages. Returns the answer; nothing if the call failed. Once.
  virtual boost::asio::awaitable<std::optional<std::string>> Finish() = 0;

  // Returns how the call ended. After Finish.
  virtual const grpc::Status& status() const = 0;

  // From any thread: a pending and every later Write and Finish ends.
  virtual void Cancel() = 0;
};

// Returns a failure of a call as Connect clients see it; nothing if it is OK.
std::optional<ConnectError> ToConnectError(const grpc::Status& status);

}  // namespace mortise::gateway
