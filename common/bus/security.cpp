#include "common/bus/security.h"

#include <zmq.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::bus {
namespace {

constexpr std::size_t kKeyText = 40;

bool IsKey(const std::string& text) {
  std::array<uint8_t, 32> bytes = {};
  return text.size() == kKeyText && zmq_z85_decode(bytes.data(), text.c_str()) != nullptr;
}

absl::Status CheckPair(const CurveKeyPair& keys) {
  if (!IsKey(keys.secret_key)) {
    return InvalidField("security.keys.secret_key", "must be 40 characters of Z85");
  }
  std::array<char, kKeyText + 1> public_key = {};
  if (zmq_curve_public(public_key.data(), keys.secret_key.c_str()) != 0 ||
      keys.public_key != public_key.data()) {
    return InvalidField("security.keys.public_key", "does not belong to the secret key");
  }
  return absl::OkStatus();
}

absl::Status PlainOnlyOnLoopback(const std::string& endpoint) {
  if (IsLoopback(endpoint)) return absl::OkStatus();
  return InvalidField("endpoint",
                      absl::StrCat("'", endpoint, "' leaves this machine and needs CURVE keys"));
}

// "127.0.0.1" and its kin, but not "127.example.com".
bool IsLoopbackAddress(std::string_view host) {
  if (host == "localhost" || host == "[::1]") return true;
  const bool numeric = std::all_of(host.begin(), host.end(),
                                   [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
  return numeric && host.starts_with("127.");
}

}  // namespace

absl::StatusOr<CurveKeyPair> NewCurveKeyPair() {
  std::array<char, kKeyText + 1> public_key = {};
  std::array<char, kKeyText + 1> secret_key = {};
  if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    return absl::UnimplementedError("this ZeroMQ was built without CURVE");
  }
  return CurveKeyPair{.public_key = public_key.data(), .secret_key = secret_key.data()};
}

bool IsLoopback(const std::string& endpoint) {
  constexpr std::string_view kTcp = "tcp://";
  const std::string_view text = endpoint;
  if (text.starts_with("ipc://") || text.starts_with("inproc://")) return true;
  const std::size_t colon = text.rfind(':');
  if (!text.starts_with(kTcp) || colon == std::string_view::npos || colon < kTcp.size()) {
    return false;
  }
  return IsLoopbackAddress(text.substr(kTcp.size(), colon - kTcp.size()));
}

absl::Status CheckSecurity(const BrokerSecurity& security,
                           const std::vector<std::string>& endpoints) {
  if (!security.keys) {
    for (const std::string& endpoint : endpoints) {
      MORTISE_RETURN_IF_ERROR(PlainOnlyOnLoopback(endpoint));
    }
    return absl::OkStatus();
  }
  for (std::size_t i = 0; i < security.allowed_clients.size(); ++i) {
    if (!IsKey(security.allowed_clients[i])) {
      return InvalidField(absl::StrCat("security.allowed_clients[", i, "]"),
                          "must be 40 characters of Z85");
    }
  }
  return CheckPair(*security.keys);
}

absl::Status CheckSecurity(const ClientSecurity& security, const std::string& endpoint) {
  if (!security.keys) return PlainOnlyOnLoopback(endpoint);
  if (!IsKey(security.broker_key)) {
    return InvalidField("security.broker_key", "must be 40 characters of Z85");
  }
  return CheckPair(*security.keys);
}

}  // namespace mortise::bus
