// TLS between processes; plain text never leaves the machine.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace grpc {
class ChannelCredentials;
class ServerCredentials;
}  // namespace grpc

namespace mortise::rpc {

// Files in PEM. All empty: plain text, on loopback only.
struct ChannelSecurity {
  std::filesystem::path certificate = {};  // chain of this process; of a client: for mutual TLS
  std::filesystem::path key = {};          // its private key
  std::filesystem::path authority =
      {};  // whom to trust. Servers then ask clients for certificates.
};

// Whether `address` stays on this machine: 127.0.0.0/8, [::1], localhost, unix:PATH.
bool IsLocalAddress(std::string_view address);

// Returns the credentials of a server listening on `address`; certificates are read again when
// their files change. INVALID_ARGUMENT naming the flag if plain text would leave the machine or a
// key has no certificate; NOT_FOUND for a missing file.
absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MakeServerCredentials(
    const std::string& address, const ChannelSecurity& security);

// Returns the credentials of a client of `address`: TLS if `authority` is given, else plain and
// local.
absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> MakeClientCredentials(
    const std::string& address, const ChannelSecurity& security);

}  // namespace mortise::rpc
