// Sockets that listen, and sockets that connect to them.
#pragma once

#include <sys/socket.h>

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::rpc {

// A descriptor that is closed with its owner; -1 for none.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.Release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor();

  int number() const { return number_; }
  int Release();

 private:
  int number_ = -1;
};

// The address of a socket.
struct SocketAddress {
  sockaddr_storage storage = {};
  socklen_t size = sizeof(sockaddr_storage);

  sockaddr* get() { return reinterpret_cast<sockaddr*>(&storage); }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
  int port() const;
  void set_port(int port);
  bool operator==(const SocketAddress& other) const;
};

struct ListeningSocket {
  Descriptor descriptor;
  SocketAddress address;  // as bound
};

// Listens on every address of `address` (HOST:PORT), all on one port. A host of 0.0.0.0 or [::] is
// every address of the machine, of both kinds where it has both. UNAVAILABLE, ADDRESS_IN_USE naming
// the address; INVALID_ARGUMENT naming `listen` if it is not of that form.
absl::StatusOr<std::vector<ListeningSocket>> ListenOn(const std::string& address);

// A socket that can connect to `listening` from this machine, with the address that it will be seen
// to come from; an address that is every one of the machine is replaced by loopback. Does not
// block.
struct ConnectingSocket {
  Descriptor descriptor;
  SocketAddress own;
  SocketAddress peer;
};
absl::StatusOr<ConnectingSocket> MakeConnectingSocket(const SocketAddress& listening);

}  // namespace mortise::rpc
