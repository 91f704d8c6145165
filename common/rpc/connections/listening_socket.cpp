#include "common/rpc/connections/listening_socket.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::rpc {
namespace {

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

absl::Status CannotListen(const std::string& address, const std::string& why) {
  return WithDetail(absl::UnavailableError(absl::StrCat("cannot listen on ", address, ": ", why)),
                    {"ADDRESS_IN_USE", address});
}

struct HostAndPort {
  std::string host;
  std::string port;
};

absl::StatusOr<HostAndPort> Split(const std::string& address) {
  const auto colon = address.rfind(':');
  uint32_t port = 0;
  if (colon == std::string::npos || !absl::SimpleAtoi(address.substr(colon + 1), &port) ||
      port > 65535) {
    return InvalidField("listen", "must have the form HOST:PORT");
  }
  std::string host = address.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  return HostAndPort{std::move(host), address.substr(colon + 1)};
}

absl::StatusOr<Addresses> Resolve(const std::string& address, const HostAndPort& parts) {
  addrinfo hints = {};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(parts.host.c_str(), parts.port.c_str(), &hints, &found);
  if (error != 0) return CannotListen(address, gai_strerror(error));
  return Addresses(found, &freeaddrinfo);
}

void Set(int descriptor, int level, int name, int value) {
  setsockopt(descriptor, level, name, &value, sizeof(value));
}

bool IsEveryAddress(const SocketAddress& address) {
  if (address.storage.ss_family == AF_INET6) {
    const auto* six = reinterpret_cast<const sockaddr_in6*>(address.get());
    return IN6_IS_ADDR_UNSPECIFIED(&six->sin6_addr);
  }
  return reinterpret_cast<const sockaddr_in*>(address.get())->sin_addr.s_addr == INADDR_ANY;
}

SocketAddress EveryAddressOfBothKinds(int port) {
  SocketAddress address;
  auto* six = reinterpret_cast<sockaddr_in6*>(address.get());
  six->sin6_family = AF_INET6;
  six->sin6_addr = in6addr_any;
  address.size = sizeof(sockaddr_in6);
  address.set_port(port);
  return address;
}

// Nothing, with errno set, if the system refuses.
ListeningSocket Listen(const SocketAddress& address) {
  ListeningSocket result;
  const int family = address.storage.ss_family;
  Descriptor listener(socket(family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (listener.number() < 0) return result;
  // Otherwise a port could not be bound again for a minute after its server has ended.
  Set(listener.number(), SOL_SOCKET, SO_REUSEADDR, 1);
  if (family == AF_INET6) {
    Set(listener.number(), IPPROTO_IPV6, IPV6_V6ONLY, IsEveryAddress(address) ? 0 : 1);
  }
  if (bind(listener.number(), address.get(), address.size) != 0 ||
      listen(listener.number(), SOMAXCONN) != 0 ||
      getsockname(listener.number(), result.address.get(), &result.address.size) != 0) {
    return result;
  }
  result.descriptor = std::move(listener);
  return result;
}

SocketAddress AddressOf(const addrinfo& info, int port) {
  SocketAddress address;
  std::memcpy(&address.storage, info.ai_addr, info.ai_addrlen);
  address.size = info.ai_addrlen;
  if (port != 0) address.set_port(port);
  return address;
}

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(number_, other.number_);
  return *this;
}

Descriptor::~Descriptor() {
  if (number_ >= 0) close(number_);
}

int Descriptor::Release() { return std::exchange(number_, -1); }

int SocketAddress::port() const {
  if (storage.ss_family == AF_INET6) {
    return ntohs(reinterpret_cast<const sockaddr_in6*>(get())->sin6_port);
  }
  return ntohs(reinterpret_cast<const sockaddr_in*>(get())->sin_port);
}

void SocketAddress::set_port(int port) {
  const auto network = htons(static_cast<uint16_t>(port));
  if (storage.ss_family == AF_INET6) {
    reinterpret_cast<sockaddr_in6*>(get())->sin6_port = network;
  } else {
    reinterpret_cast<sockaddr_in*>(get())->sin_port = network;
  }
}

bool SocketAddress::operator==(const SocketAddress& other) const {
  if (storage.ss_family != other.storage.ss_family || port() != other.port()) return false;
  if (storage.ss_family == AF_INET6) {
    return std::memcmp(&reinterpret_cast<const sockaddr_in6*>(get())->sin6_addr,
                       &reinterpret_cast<const sockaddr_in6*>(other.get())->sin6_addr,
                       sizeof(in6_addr)) == 0;
  }
  return reinterpret_cast<const sockaddr_in*>(get())->sin_addr.s_addr ==
         reinterpret_cast<const sockaddr_in*>(other.get())->sin_addr.s_addr;
}

absl::StatusOr<std::vector<ListeningSocket>> ListenOn(const std::string& address) {
  MORTISE_ASSIGN_OR_RETURN(const HostAndPort parts, Split(address));
  MORTISE_ASSIGN_OR_RETURN(const Addresses found, Resolve(address, parts));
  std::vector<ListeningSocket> sockets;
  int port = 0;
  std::string why;
  for (const addrinfo* info = found.get(); info != nullptr; info = info->ai_next) {
    const SocketAddress wanted = AddressOf(*info, port);
    ListeningSocket listening;
    bool in_use = false;
    if (IsEveryAddress(wanted)) {
      listening = Listen(EveryAddressOfBothKinds(wanted.port()));
      in_use = listening.descriptor.number() < 0 && errno == EADDRINUSE;
    }
    // A machine may have no addresses of the newer kind.
    if (listening.descriptor.number() < 0 && !in_use) listening = Listen(wanted);
    if (listening.descriptor.number() < 0) {
      why = std::strerror(errno);
      // A name may stand for an address of a kind that the machine does not have, or for which the
      // port that was free for the first is not.
      if (errno == EADDRNOTAVAIL || errno == EAFNOSUPPORT) continue;
      if (parts.port == "0" && !sockets.empty()) continue;
      return CannotListen(address, why);
    }
    port = listening.address.port();
    sockets.push_back(std::move(listening));
  }
  if (sockets.empty()) return CannotListen(address, why);
  return sockets;
}

absl::StatusOr<ConnectingSocket> MakeConnectingSocket(const SocketAddress& listening) {
  ConnectingSocket result;
  result.peer = listening;
  if (IsEveryAddress(listening)) {
    if (listening.storage.ss_family == AF_INET6) {
      // 127.0.0.1 as seen by a socket for both kinds, for not every machine has an address ::1.
      in6_addr& address = reinterpret_cast<sockaddr_in6*>(result.peer.get())->sin6_addr;
      inet_pton(AF_INET6, "::ffff:127.0.0.1", &address);
    } else {
      auto* four = reinterpret_cast<sockaddr_in*>(result.peer.get());
      four->sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    }
  }
  result.descriptor = Descriptor(
      socket(listening.storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  result.own = result.peer;
  result.own.set_port(0);
  if (result.descriptor.number() < 0 ||
      bind(result.descriptor.number(), result.own.get(), result.own.size) != 0 ||
      getsockname(result.descriptor.number(), result.own.get(), &result.own.size) != 0) {
    return absl::UnavailableError(absl::StrCat("no socket to be had: ", std::strerror(errno)));
  }
  return result;
}

}  // namespace mortise::rpc
