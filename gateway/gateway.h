// The whole gateway: both doors, what is behind them, and the event bus.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/rpc/channel_security.h"
#include "gateway/admission/open_calls.h"
#include "gateway/contract/token.h"
#include "gateway/http/http_connection.h"
#include "gateway/token_keys/key_address.h"
#include "gateway/webhooks/webhook_delivery.h"

namespace mortise::gateway {

struct GatewayOptions {
  std::string grpc = "127.0.0.1:0";  // HOST:PORT of the gRPC door; port 0 is any free one
  std::string http = "127.0.0.1:0";  // HOST:PORT of the HTTP door
  std::filesystem::path port_file;   // where the addresses are written as JSON; none if empty
  std::map<std::string, std::string> services;    // "catalog" → "127.0.0.1:4711"
  std::string store = "sqlite:state/gateway.db";  // webhooks and audit records
  std::filesystem::path keys;                     // folder of identity keys, with gateway.key
  std::filesystem::path jwt_keys;  // public keys of bearer tokens: JSON Web Key Set or PEM
  KeyAddressOptions jwks;          // where more of them are fetched; nowhere if its url is empty
  TokenOptions token;
  rpc::ChannelSecurity security;           // certificate and key of both doors
  rpc::ChannelSecurity services_security;  // of the channels to services
  bool insecure_development = false;  // plain text and no tokens needed; both doors on loopback
  std::string bus_publish = "tcp://127.0.0.1:*";
  std::string bus_subscribe = "tcp://127.0.0.1:*";
  absl::Duration drain_time = absl::Seconds(10);
  bool log_calls = true;
  int channels = 2;                            // connections to each service
  absl::Duration patience = absl::Seconds(5);  // with a service that is not there, of calls unsent
  int http_threads = 2;                        // that serve the HTTP door
  // Connections of clients at a time, for each door; 0: half of what the process's limit of
  // descriptors leaves.
  int most_connections = 0;
  OpenCallLimits open_calls;  // what is more than the services' connections carry is cut
  // Of large bodies at a time, over HTTP, and of large messages that came compressed, over gRPC.
  int64_t body_bytes = int64_t{256} << 20;
  HttpPatience http_patience;
  std::vector<std::string> cors_origins;             // of pages that may call over HTTP
  std::chrono::milliseconds reflection_time{60000};  // of one stream of reflection
  WebhookDeliveryOptions webhooks;
};

// Where a running gateway is reached.
struct GatewayAddresses {
  std::string grpc;
  std::string http;
  std::string bus_publish;
  std::string bus_subscribe;
};

class Gateway {
 public:
  // INVALID_ARGUMENT naming the option at fault; UNAVAILABLE for an address in use; INTERNAL,
  // STORAGE_FAILED if the store cannot be opened. Services need not run yet.
  static absl::StatusOr<std::unique_ptr<Gateway>> Start(const GatewayOptions& options);

  // Drains and ends.
  virtual ~Gateway() = default;

  virtual const GatewayAddresses& addresses() const = 0;
};

// Returns the version that /version and GetHouse tell.
const char* GatewayVersion();

}  // namespace mortise::gateway
