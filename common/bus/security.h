// Who may use the bus: CURVE keys with an allow-list between hosts, plain text on loopback only.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::bus {

// A CURVE key pair, each key as 40 characters of Z85 text.
struct CurveKeyPair {
  std::string public_key = {};
  std::string secret_key = {};
};

// Returns a new random pair.
absl::StatusOr<CurveKeyPair> NewCurveKeyPair();

// What the broker needs. Without keys it is plain, and may bind loopback endpoints only.
struct BrokerSecurity {
  std::optional<CurveKeyPair> keys = {};
  std::vector<std::string> allowed_clients = {};  // public keys; everyone else is refused
};

// What a publisher or subscriber needs. Without keys it is plain, and may connect to loopback
// endpoints only.
struct ClientSecurity {
  std::optional<CurveKeyPair> keys = {};
  std::string broker_key = {};  // the broker's public key
};

// Whether an endpoint never leaves this machine: ipc://, inproc://, tcp on 127.0.0.0/8, [::1] or
// localhost.
bool IsLoopback(const std::string& endpoint);

// Fails with INVALID_ARGUMENT, naming the field, if a key is malformed or a plain endpoint leaves
// the machine.
absl::Status CheckSecurity(const BrokerSecurity& security,
                           const std::vector<std::string>& endpoints);
absl::Status CheckSecurity(const ClientSecurity& security, const std::string& endpoint);

}  // namespace mortise::bus
