#include "common/rpc/connections/connection_places.h"

#include <netinet/in.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <string_view>

namespace mortise::rpc {
namespace {

constexpr std::size_t kV4InV6 = 12;  // where an IPv6 address has the IPv4 one that it stands for
constexpr std::size_t kNetwork = 64 / 8;

const in6_addr& SixOf(const SocketAddress& address) {
  return reinterpret_cast<const sockaddr_in6*>(address.get())->sin6_addr;
}

// The bytes of an IPv4 address, also of one that IPv6 stands for; of others the network's.
std::string_view ClientOf(const SocketAddress& address) {
  if (address.storage.ss_family == AF_INET) {
    const auto& four = reinterpret_cast<const sockaddr_in*>(address.get())->sin_addr;
    return {reinterpret_cast<const char*>(&four), sizeof(four)};
  }
  const char* six = reinterpret_cast<const char*>(SixOf(address).s6_addr);
  if (IN6_IS_ADDR_V4MAPPED(&SixOf(address))) return {six + kV4InV6, sizeof(in_addr)};
  return {six, kNetwork};
}

bool AreOfOne(const SocketAddress& one, const SocketAddress& other) {
  return ClientOf(one) == ClientOf(other);
}

bool IsThisMachine(const SocketAddress& address) {
  if (address.storage.ss_family == AF_INET6 && IN6_IS_ADDR_LOOPBACK(&SixOf(address))) return true;
  const std::string_view client = ClientOf(address);
  return client.size() == sizeof(in_addr) && client.front() == IN_LOOPBACKNET;
}

}  // namespace

bool ConnectionPlaces::Full(int taken) {
  if (static_cast<int>(places_.size()) + taken < most_) return false;
  ForgetClosed();
  return static_cast<int>(places_.size()) + taken >= most_;
}

bool ConnectionPlaces::HasHalf(const SocketAddress& from) {
  if (IsThisMachine(from)) return false;
  const auto has_half = [&] {
    const auto own = std::count_if(places_.begin(), places_.end(),
                                   [&](const Place& place) { return AreOfOne(place.from, from); });
    return 2 * own >= most_;
  };
  if (!has_half()) return false;
  ForgetClosed();
  return has_half();
}

void ConnectionPlaces::Enter(int descriptor, const SocketAddress& from) {
  struct stat status = {};
  if (fstat(descriptor, &status) == 0) places_.push_back({descriptor, status.st_ino, from});
}

void ConnectionPlaces::ForgetClosed() {
  std::erase_if(places_, [](const Place& place) {
    struct stat status = {};
    return fstat(place.descriptor, &status) != 0 || !S_ISSOCK(status.st_mode) ||
           status.st_ino != place.socket;
  });
}

}  // namespace mortise::rpc
