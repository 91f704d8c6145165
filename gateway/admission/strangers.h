// The connections of the gRPC door on which no call was admitted yet.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <list>
#include <mutex>
#include <string>
#include <unordered_map>

namespace mortise::gateway {

// They make room when the door is full: whoever connects and shows no token keeps nobody out.
// Thread safe.
class Strangers {
 public:
  // A connected socket that gRPC will own.
  void Enter(int descriptor);

  // Whether there may be any: asked for every call, so it costs next to nothing.
  bool MayBe() const { return count_ > 0; }

  // A call was admitted on the connection of this peer, as gRPC's server contexts name it.
  void Admit(const std::string& peer);

  // Whether there is one that could make room.
  bool Any();

  // Ends the connection of who has been a stranger for longest; false if there is none.
  bool CloseLongest();

 private:
  struct Connection {
    std::string peer;
    int descriptor;
    ino_t socket;  // its number in the system, for gRPC may have closed it
  };

  // The mutex is held.
  void ForgetClosed();
  void Forget(std::list<Connection>::iterator connection);

  std::mutex mutex_;
  std::list<Connection> connections_;  // the longest here first; guarded by mutex_
  std::unordered_map<std::string, std::list<Connection>::iterator> by_peer_;  // guarded by mutex_
  std::size_t look_again_ = 0;  // how many are worth a look for closed ones; guarded by mutex_
  std::atomic<std::size_t> count_{0};
};

// Returns a connected socket's peer as gRPC's server contexts name it: "ipv4:192.0.2.1:4711",
// "ipv6:%5B2001:db8::1%5D:4711". Empty if it is not connected any more.
std::string PeerOf(int descriptor);

}  // namespace mortise::gateway
