// Calls from the HTTP door to the gRPC door in the same process, awaited by coroutines.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gateway/awaitable.h"
#include "gateway/connect_protocol.h"
#include "gateway/upstreams.h"

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

// One call of any kind: all its requests are known when it starts, its answers are read one by one,
// and the next is only asked for when Read is called again, so a slow reader slows the sender.
// Used by one coroutine, apart from Cancel.
class ClientCall {
 public:
  // Begins the call. It goes on until its end even if this handle goes away before; call Cancel.
  static std::shared_ptr<ClientCall> Start(GenericStub& stub, CallHead head,
                                           std::vector<std::string> requests);
  virtual ~ClientCall() = default;

  // The next answer; nothing at the end, when status() is known. Do not call again after that.
  virtual boost::asio::awaitable<std::optional<std::string>> Read() = 0;

  // How the call ended. After the last Read.
  virtual const grpc::Status& status() const = 0;

  // Metadata that came first (after the first Read) and last (after the last Read); without
  // reserved entries.
  virtual HeaderList leading() const = 0;
  virtual HeaderList trailing() const = 0;

  // From any thread: the pending and every later Read ends.
  virtual void Cancel() = 0;
};

// A failure of a call as Connect clients see it; nothing if it is OK.
std::optional<ConnectError> ToConnectError(const grpc::Status& status);

}  // namespace mortise::gateway
