// Posts one event to a webhook's address.
#pragma once

#include <boost/asio/ip/address.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "gateway/awaitable.h"
#include "gateway/connect_protocol.h"

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

// Whether events may be posted to this address: not to link-local ones (where cloud machines find
// their own credentials), multicast or unspecified ones, and to this machine only with
// `allow_loopback`. Private networks are fine: that is where PLM systems are.
bool IsAllowedAddress(const boost::asio::ip::address& address, bool allow_loopback);

// What can be said before the first delivery. INVALID_ARGUMENT naming `url` if every address that
// the host has now is one that events may not be posted to. A host that is not known (yet) is fine.
// Asks the system's resolver, which may take seconds.
absl::Status CheckWebhookHost(const WebhookUrl& url, bool allow_loopback);

// The value of `Mortise-Signature`: "t=<seconds>,v1=<hex>", where hex is the HMAC-SHA256 with the
// secret over "<seconds>.<body>".
std::string SignWebhook(std::string_view secret, int64_t seconds, std::string_view body);

struct WebhookClientOptions {
  bool allow_loopback = false;
  absl::Duration timeout = absl::Seconds(10);  // for one delivery
};

// Posts `body` and waits for the answer. OK for a status of 200 to 299; UNAVAILABLE, with what went
// wrong, for everything else. Redirects are not followed. The address checked is the one connected
// to, so a name that changes its address gains nothing.
boost::asio::awaitable<absl::Status> PostWebhook(const WebhookUrl& url, const HeaderList& headers,
                                                 const std::string& body,
                                                 const WebhookClientOptions& options);

}  // namespace mortise::gateway
