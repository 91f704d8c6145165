// The client's side of the gateway: where it is, how to call it, how to follow what it started.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace grpc {
class Channel;
class ClientContext;
}  // namespace grpc

namespace mortise::v1 {
class Chunk;
class Operation;
}  // namespace mortise::v1

namespace mortise::cli {

class BearerToken;

// How to reach the gateway. What is empty is taken from the environment (MORTISE_GATEWAY,
// MORTISE_TOKEN, MORTISE_CA) or from the house that runs on the state folder.
struct GatewayOptions {
  std::string address;                       // host:port of its gRPC door
  std::string token_file;                    // file with a bearer token
  std::string authority;                     // PEM file of the certificate authority to trust
  double patience = 60;                      // s, to wait for a gateway that is not there yet
  std::filesystem::path state = ".mortise";  // state folder of a house on this machine
};

// Returns the gateway that MORTISE_GATEWAY names; empty if it names none.
std::string GatewayOfEnvironment();

class GatewayClient {
 public:
  // NOT_FOUND with what to do if no gateway is named and no house runs here; UNAVAILABLE with the
  // reason if none answers in time, or what answers does not speak as this client does (TLS against
  // plain text, a certificate that is not trusted) or ends connections at once.
  static absl::StatusOr<GatewayClient> Connect(const GatewayOptions& options);

  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }
  const std::string& address() const { return address_; }

  // Metadata and deadline of one call; `seconds` 0 for no deadline.
  void Prepare(grpc::ClientContext& context, double seconds = 60) const;

  // Makes a call with a context that is prepared; again, three times in all, while it ends
  // UNAVAILABLE: its answer was lost with a gateway or service that died; or UNAUTHENTICATED where
  // the token file has another token by now. What changes something must carry a request id, and
  // has its effect once.
  absl::Status Call(const std::function<absl::Status(grpc::ClientContext&)>& call,
                    double seconds = 60) const;

  // Follows an operation to its end, telling of each change; reconnects to a gateway or service
  // that restarts, goes on with the token that its file has by then, and asks now and then where
  // the gateway has no stream to spare. Gives the operation as it ended, whatever came of it;
  // CANCELLED if a stop is requested before.
  absl::StatusOr<v1::Operation> Follow(const std::string& operation,
                                       const std::function<void(const v1::Operation&)>& changed,
                                       const std::stop_token& stop = {}) const;

  // "mortise", with the flags that lead other commands to the same gateway.
  const std::string& command() const { return command_; }

 private:
  absl::Status AwaitConnection(std::chrono::duration<double> patience, bool plain_text) const;

  GatewayClient(std::shared_ptr<grpc::Channel> channel, std::string address,
                std::shared_ptr<BearerToken> token, std::string command);

  std::shared_ptr<grpc::Channel> channel_;
  std::string address_;
  std::shared_ptr<BearerToken> token_;
  std::string command_;
};

// Tells whether the operation has ended: succeeded, failed or cancelled.
bool HasEnded(const v1::Operation& operation);

// What an operation that has ended failed with: its error, CANCELLED; OK where it succeeded.
absl::Status ErrorOf(const v1::Operation& operation);

}  // namespace mortise::cli
