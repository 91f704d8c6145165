#include "common/bus/sockets.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include "common/base/errors.h"

namespace mortise::bus {

void KeepAlive(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::heartbeat_ivl, 2000);       // ms
  socket.set(zmq::sockopt::heartbeat_timeout, 10000);  // ms
  socket.set(zmq::sockopt::reconnect_ivl, 50);         // ms
  socket.set(zmq::sockopt::reconnect_ivl_max, 1000);   // ms
}

void SecureClient(const ClientSecurity& security, zmq::socket_t& socket) {
  if (!security.keys) return;
  socket.set(zmq::sockopt::curve_serverkey, security.broker_key);
  socket.set(zmq::sockopt::curve_publickey, security.keys->public_key);
  socket.set(zmq::sockopt::curve_secretkey, security.keys->secret_key);
}

void SecureServer(const BrokerSecurity& security, zmq::socket_t& socket) {
  if (!security.keys) return;
  socket.set(zmq::sockopt::zap_domain, "mortise");
  socket.set(zmq::sockopt::curve_server, true);
  socket.set(zmq::sockopt::curve_secretkey, security.keys->secret_key);
}

absl::Status EndpointFailed(const std::string& endpoint, const zmq::error_t& error) {
  return PeerUnavailable(endpoint, error.what());
}

WakeDescriptor::WakeDescriptor() : descriptor_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

WakeDescriptor::~WakeDescriptor() { ::close(descriptor_); }

void WakeDescriptor::Ring() {
  const uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(descriptor_, &one, sizeof(one));
}

bool WakeDescriptor::Clear() {
  uint64_t count = 0;
  return ::read(descriptor_, &count, sizeof(count)) == sizeof(count);
}

}  // namespace mortise::bus
