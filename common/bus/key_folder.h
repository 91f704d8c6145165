// CURVE keys kept in a folder, beside the identity keys: `<name>.curve-secret` (the secret key,
// mode 0600) for each process that uses the bus, `<name>.curve-public` for everyone who may.
//
// A folder without curve keys gives plain security, which the bus accepts on loopback only.
#pragma once

#include <filesystem>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/bus/security.h"

namespace mortise::bus {

// Writes a new pair for `name`. ALREADY_EXISTS if there is one.
absl::Status CreateCurveKey(const std::filesystem::path& folder, std::string_view name);

// Returns the security of the broker `name`: every `*.curve-public` in the folder is allowed.
absl::StatusOr<BrokerSecurity> LoadBrokerSecurity(const std::filesystem::path& folder,
                                                  std::string_view name);

// Returns the security of the process `name` towards the broker `broker`.
absl::StatusOr<ClientSecurity> LoadClientSecurity(const std::filesystem::path& folder,
                                                  std::string_view name, std::string_view broker);

}  // namespace mortise::bus
