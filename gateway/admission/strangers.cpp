#include "gateway/admission/strangers.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/rpc/connections/listening_socket.h"

namespace mortise::gateway {
namespace {

constexpr std::size_t kFewEnough = 1024;

std::optional<ino_t> SocketOf(int descriptor) {
  struct stat status = {};
  if (fstat(descriptor, &status) != 0 || !S_ISSOCK(status.st_mode)) return std::nullopt;
  return status.st_ino;
}

// Ends the connection if the descriptor still is this socket, which cannot change while it is
// looked at by a descriptor of our own. Whoever owns it notices, and closes it.
bool Shut(int descriptor, ino_t socket) {
  const rpc::Descriptor own(fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
  if (own.number() < 0 || SocketOf(own.number()) != socket) return false;
  return shutdown(own.number(), SHUT_RDWR) == 0;
}

}  // namespace

void Strangers::Enter(int descriptor) {
  const std::optional<ino_t> socket = SocketOf(descriptor);
  std::string peer = PeerOf(descriptor);
  if (!socket || peer.empty()) return;
  const std::lock_guard lock(mutex_);
  const auto former = by_peer_.find(peer);
  if (former != by_peer_.end()) Forget(former->second);
  if (connections_.size() >= std::max(look_again_, kFewEnough)) {
    ForgetClosed();
    look_again_ = 2 * connections_.size();
  }
  const auto entered = connections_.insert(connections_.end(), {peer, descriptor, *socket});
  by_peer_.emplace(std::move(peer), entered);
  count_ = connections_.size();
}

void Strangers::Admit(const std::string& peer) {
  const std::lock_guard lock(mutex_);
  const auto found = by_peer_.find(peer);
  if (found != by_peer_.end()) Forget(found->second);
}

bool Strangers::Any() {
  const std::lock_guard lock(mutex_);
  ForgetClosed();
  return !connections_.empty();
}

bool Strangers::CloseLongest() {
  const std::lock_guard lock(mutex_);
  bool closed = false;
  while (!closed && !connections_.empty()) {
    closed = Shut(connections_.front().descriptor, connections_.front().socket);
    Forget(connections_.begin());
  }
  return closed;
}

void Strangers::ForgetClosed() {
  for (auto next = connections_.begin(); next != connections_.end();) {
    const auto connection = next++;
    if (SocketOf(connection->descriptor) != connection->socket) Forget(connection);
  }
}

void Strangers::Forget(std::list<Connection>::iterator connection) {
  by_peer_.erase(connection->peer);
  connections_.erase(connection);
  count_ = connections_.size();
}

std::string PeerOf(int descriptor) {
  rpc::SocketAddress peer;
  if (getpeername(descriptor, peer.get(), &peer.size) != 0) return {};
  char text[INET6_ADDRSTRLEN] = {};
  if (peer.storage.ss_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(peer.get())->sin_addr, text,
              sizeof(text));
    return absl::StrCat("ipv4:", text, ":", peer.port());
  }
  if (peer.storage.ss_family != AF_INET6) return {};
  const auto& six = *reinterpret_cast<const sockaddr_in6*>(peer.get());
  if (IN6_IS_ADDR_V4MAPPED(&six.sin6_addr)) {
    constexpr std::size_t kV4 = 12;
    inet_ntop(AF_INET, six.sin6_addr.s6_addr + kV4, text, sizeof(text));
    return absl::StrCat("ipv4:", text, ":", peer.port());
  }
  inet_ntop(AF_INET6, &six.sin6_addr, text, sizeof(text));
  const std::string zone = six.sin6_scope_id == 0 ? "" : absl::StrCat("%25", six.sin6_scope_id);
  return absl::StrCat("ipv6:%5B", text, zone, "%5D:", peer.port());
}

}  // namespace mortise::gateway
