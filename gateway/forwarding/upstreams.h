// The services behind the gateway: where they are, and the channels to them.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/rpc/channel_security.h"
#include "gateway/contract/contract.h"

namespace grpc {
class ByteBuffer;
class Channel;
template <class Request, class Response>
class TemplatedGenericStub;
}  // namespace grpc

namespace mortise::gateway {

using GenericStub = grpc::TemplatedGenericStub<grpc::ByteBuffer, grpc::ByteBuffer>;

struct UpstreamOptions {
  // Connections to each service for calls. One HTTP/2 connection is one lock and one socket, so
  // several let calls on several cores pass side by side.
  int channels = 2;
  // Connections to each service for streams and calls that wait. They are used one after the other,
  // so that most are never made.
  int stream_channels = 4;
  // How long a call waits for a service that is not there; see ConnectionPatience.
  absl::Duration patience = absl::Seconds(5);
};

// Filled before the doors open, then only read: thread safe from then on.
//
// A service takes so many streams of HTTP/2 a connection; what is begun beyond waits, without a
// word, until others end. So calls that may stay open for long have connections of their own, as
// have urgent ones; and none waits if no more are begun than MostOpen says (OpenCalls sees to it).
class Upstreams {
 public:
  explicit Upstreams(UpstreamOptions options);
  ~Upstreams();
  Upstreams(const Upstreams&) = delete;
  Upstreams& operator=(const Upstreams&) = delete;

  // Connects lazily, and again by itself. ALREADY_EXISTS for a name given twice; fails as
  // rpc::MakeClientCredentials does.
  absl::Status Add(const std::string& name, const std::string& address,
                   const rpc::ChannelSecurity& security);

  // A connection to a service, and the stub that calls on it.
  struct Connection {
    std::shared_ptr<grpc::Channel> channel;
    std::unique_ptr<GenericStub> stub;
  };

  // Returns a connection for one call, which keeps it until it is over; null for a name that was
  // not added.
  std::shared_ptr<const Connection> Take(std::string_view name, CallKind kind) const;

  // Returns how many calls of a kind may be open to one service, where waits and streams share.
  int MostOpen(CallKind kind) const;

  // Returns one channel of the service, for typed stubs; null for a name that was not added.
  std::shared_ptr<grpc::Channel> Channel(std::string_view name) const;

  const UpstreamOptions& options() const { return options_; }

  // Returns every service added, with its address.
  const std::map<std::string, std::string, std::less<>>& addresses() const { return addresses_; }

  // Whether the service's standard health check says SERVING within `timeout`. Blocks.
  bool Healthy(std::string_view name, absl::Duration timeout) const;

 private:
  struct Lane;
  struct Service;

  UpstreamOptions options_;
  std::map<std::string, std::string, std::less<>> addresses_;
  std::map<std::string, std::unique_ptr<Service>, std::less<>> services_;
};

}  // namespace mortise::gateway
