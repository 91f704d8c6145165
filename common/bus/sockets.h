// What the files of the bus that use ZeroMQ have in common.
#pragma once

#include <cstdint>
#include <string>
#include <zmq.hpp>

#include "absl/status/status.h"
#include "common/bus/security.h"

namespace mortise::bus {

// Notices dead peers, and finds them again.
void KeepAlive(zmq::socket_t& socket);

// Makes `socket` a CURVE client, if keys are given.
void SecureClient(const ClientSecurity& security, zmq::socket_t& socket);

// Makes `socket` a CURVE server whose clients the ZAP handler judges, if keys are given.
void SecureServer(const BrokerSecurity& security, zmq::socket_t& socket);

// Fails with UNAVAILABLE naming the endpoint.
absl::Status EndpointFailed(const std::string& endpoint, const zmq::error_t& error);

// A file descriptor that becomes readable when any thread rings it.
class WakeDescriptor {
 public:
  WakeDescriptor();
  ~WakeDescriptor();
  WakeDescriptor(const WakeDescriptor&) = delete;
  WakeDescriptor& operator=(const WakeDescriptor&) = delete;

  void Ring();
  bool Clear();  // whether it was rung
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

}  // namespace mortise::bus
