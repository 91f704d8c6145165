// The addresses of webhooks: which may be, and which the gateway may call.
#pragma once

#include <boost/asio/ip/address.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace mortise::gateway {

// The parts of an http or https address.
struct WebhookUrl {
  bool secure = false;
  std::string host;    // without brackets
  std::string port;    // "443" by default for https, "80" for http
  std::string target;  // path and query, at least "/"
};

// INVALID_ARGUMENT naming `url`: another scheme, a user name, no host, a port beyond 1 to 65535,
// control characters, more than 2048 bytes.
absl::StatusOr<WebhookUrl> ParseWebhookUrl(std::string_view url);

// Returns the address that `host` is without asking anybody: also in the older spellings of IPv4
// (127.1, 2130706433, 0x7f000001, 0177.0.0.1). Nothing for a name.
std::optional<boost::asio::ip::address> LiteralAddress(std::string host);

// Whether events may be posted to this address: not to link-local ones and the few others where
// cloud machines find their own credentials, nor to multicast, reserved or unspecified ones; to
// this machine, which is loopback and every address that one of its interfaces has now, only with
// `allow_loopback`. An IPv6 address that stands for an IPv4 one is judged as that. Private networks
// are fine: that is where PLM systems are.
bool IsAllowedAddress(const boost::asio::ip::address& address, bool allow_loopback);

}  // namespace mortise::gateway
