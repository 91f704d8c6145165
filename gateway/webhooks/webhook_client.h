// Posts one event to a webhook's address.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "gateway/contract/connect_protocol.h"
#include "gateway/forwarding/awaitable.h"
#include "gateway/webhooks/name_resolver.h"
#include "gateway/webhooks/webhook_address.h"

namespace mortise::gateway {

// Returns the value of `Mortise-Signature`: "t=<seconds>,v1=<hex>", where hex is the HMAC-SHA256
// with the secret over "<seconds>.<body>"; with several secrets, of which none is empty,
// ",v1=<hex>" for each.
std::string SignWebhook(const std::vector<std::string>& secrets, int64_t seconds,
                        std::string_view body);

// INVALID_ARGUMENT naming `certificate_authority`: no certificates as PEM, or more than 64 KiB. OK
// if empty.
absl::Status CheckCertificateAuthority(std::string_view pem);

struct WebhookClientOptions {
  bool allow_loopback = false;
  absl::Duration timeout = absl::Seconds(10);         // for one delivery, within which
  absl::Duration resolve_timeout = absl::Seconds(5);  // the host's addresses are found,
  absl::Duration connect_timeout = absl::Seconds(5);  // one of them is connected to,
  absl::Duration tls_timeout = absl::Seconds(5);      // and TLS agreed on
  std::string name_servers = {};  // "ADDRESS:PORT,…" to ask; the system's if empty
};

// Any number of deliveries at once: none waits for another.
class WebhookClient {
 public:
  // Fails as NameResolver::Start.
  static absl::StatusOr<std::unique_ptr<WebhookClient>> Create(const WebhookClientOptions& options);

  // Ends the resolver; coroutines that wait for it are resumed by their executor if that still
  // runs.
  ~WebhookClient();

  // What can be said before the first delivery. INVALID_ARGUMENT naming `url` if every address that
  // the host has now is one that events may not be posted to. A host that is not known (yet) is
  // fine. Waits for the name servers, for `resolve_timeout` at most. Thread safe.
  absl::Status CheckHost(const WebhookUrl& url);

  // Posts `body` and waits for the answer's status. OK for one of 200 to 299; UNAVAILABLE, with
  // what went wrong, for everything else. Redirects are not followed. The address checked is the
  // one connected to, so a name that changes its address gains nothing. `authority` has the
  // certificates, as PEM, of whom to trust in place of those whom the system trusts, if it is not
  // empty. The arguments must outlive the call.
  boost::asio::awaitable<absl::Status> Post(const WebhookUrl& url, const std::string& authority,
                                            const HeaderList& headers, const std::string& body);

 private:
  class Transport;
  explicit WebhookClient(std::unique_ptr<Transport> transport);
  std::unique_ptr<Transport> transport_;
};

}  // namespace mortise::gateway
