// Accepts the connections of a server, no more than there is room for.
//
// Servers do not accept themselves: gRPC's listener never accepts again once the process was out of
// descriptors, and knows no limit that would keep it from that. This one waits and goes on.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace mortise::rpc {

struct AcceptorOptions {
  std::string listen = "127.0.0.1:0";  // HOST:PORT; port 0 takes a free one
  // Connections at a time; more are closed at once. 0: what the process's limit of descriptors
  // leaves, at most kMaxConnections.
  int most_connections = 0;
  // One client's address (its /64 where it is of IPv6) gets half of the places at most, so that
  // others find some; this machine itself may have all.
  bool shares_places = false;
  // Who connects speaks first in all protocols spoken here. A connection that has said nothing for
  // so long is closed, and one that has said nothing yet makes room for another.
  absl::Duration silence = absl::Seconds(20);
  // Gets each connection that has spoken, as its owner: a connected socket that does not block.
  std::function<void(int descriptor)> take = {};
  // When no place is left: whether there is a connection that nobody would miss, and closing it
  // (false if there was none). Called from a thread of the acceptor's. May be unset.
  std::function<bool()> has_idle = nullptr;
  std::function<bool()> close_idle = nullptr;
};

inline constexpr int kMaxConnections = 4096;

class ConnectionAcceptor {
 public:
  // UNAVAILABLE, ADDRESS_IN_USE naming the address if it cannot be bound.
  static absl::StatusOr<std::unique_ptr<ConnectionAcceptor>> Start(AcceptorOptions options);

  // Ends as Stop does.
  virtual ~ConnectionAcceptor() = default;

  // Accepts no more; nothing is taken after it returns.
  virtual void Stop() = 0;

  // Whether a client that connects now would be served; found out by connecting. Blocks for two
  // seconds at most. UNAVAILABLE saying why not.
  virtual absl::Status Probe() = 0;

  // Returns the address bound, host:port.
  virtual const std::string& address() const = 0;
};

}  // namespace mortise::rpc
