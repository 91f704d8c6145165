#include "common/bus/key_folder.h"

#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "common/base/errors.h"
#include "common/base/files.h"

namespace mortise::bus {
namespace {

constexpr std::size_t kMaxKeyFile = 1024;

std::filesystem::path SecretFile(const std::filesystem::path& folder, std::string_view name) {
  return folder / (std::string(name) + ".curve-secret");
}

std::filesystem::path PublicFile(const std::filesystem::path& folder, std::string_view name) {
  return folder / (std::string(name) + ".curve-public");
}

absl::StatusOr<std::string> ReadKey(const std::filesystem::path& path) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxKeyFile));
  return std::string(absl::StripAsciiWhitespace(text));
}

absl::StatusOr<std::optional<CurveKeyPair>> ReadPair(const std::filesystem::path& folder,
                                                     std::string_view name) {
  std::error_code ignored;
  if (folder.empty() || !std::filesystem::exists(SecretFile(folder, name), ignored)) {
    return std::optional<CurveKeyPair>();
  }
  CurveKeyPair pair;
  MORTISE_ASSIGN_OR_RETURN(pair.secret_key, ReadKey(SecretFile(folder, name)));
  MORTISE_ASSIGN_OR_RETURN(pair.public_key, ReadKey(PublicFile(folder, name)));
  return std::optional<CurveKeyPair>(pair);
}

}  // namespace

absl::Status CreateCurveKey(const std::filesystem::path& folder, std::string_view name) {
  std::error_code ignored;
  if (std::filesystem::exists(SecretFile(folder, name), ignored)) {
    return ResourceExists(SecretFile(folder, name).string());
  }
  MORTISE_ASSIGN_OR_RETURN(const CurveKeyPair pair, NewCurveKeyPair());
  MORTISE_RETURN_IF_ERROR(WriteFile(PublicFile(folder, name), pair.public_key + "\n"));
  // The public key comes first: a secret key without it would be of no use to anyone.
  MORTISE_RETURN_IF_ERROR(WriteFile(SecretFile(folder, name), pair.secret_key + "\n"));
  std::filesystem::permissions(
      SecretFile(folder, name),
      std::filesystem::perms::owner_read | std::filesystem::perms::owner_write, ignored);
  return absl::OkStatus();
}

absl::StatusOr<BrokerSecurity> LoadBrokerSecurity(const std::filesystem::path& folder,
                                                  std::string_view name) {
  BrokerSecurity security;
  MORTISE_ASSIGN_OR_RETURN(security.keys, ReadPair(folder, name));
  if (!security.keys) return security;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (!absl::EndsWith(entry.path().filename().string(), ".curve-public")) continue;
    MORTISE_ASSIGN_OR_RETURN(security.allowed_clients.emplace_back(), ReadKey(entry.path()));
  }
  return security;
}

absl::StatusOr<ClientSecurity> LoadClientSecurity(const std::filesystem::path& folder,
                                                  std::string_view name, std::string_view broker) {
  ClientSecurity security;
  MORTISE_ASSIGN_OR_RETURN(security.keys, ReadPair(folder, name));
  if (!security.keys) return security;
  MORTISE_ASSIGN_OR_RETURN(security.broker_key, ReadKey(PublicFile(folder, broker)));
  return security;
}

}  // namespace mortise::bus
