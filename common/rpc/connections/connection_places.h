// How many connections a server holds, though others close them.
#pragma once

#include <sys/types.h>

#include <vector>

#include "common/rpc/connections/listening_socket.h"

namespace mortise::rpc {

// Remembers sockets that were given away. Which of them are still open is seen by asking the system
// for the descriptor: one that was closed, or closed and given to another file, is not the socket
// any more. Used by one thread.
class ConnectionPlaces {
 public:
  explicit ConnectionPlaces(int most) : most_(most) {}

  // Whether `taken` further connections and all that are open leave no place.
  bool Full(int taken);

  // Whether all that are open from where `from` is take half of the places: from its address, of
  // IPv6 from its network (/64), which one client has for itself. Never for this machine.
  bool HasHalf(const SocketAddress& from);

  // A connected socket takes a place until it is closed.
  void Enter(int descriptor, const SocketAddress& from);

  int most() const { return most_; }

 private:
  struct Place {
    int descriptor;
    ino_t socket;  // its number in the system
    SocketAddress from;
  };
  void ForgetClosed();

  const int most_;
  std::vector<Place> places_;
};

}  // namespace mortise::rpc
