// Ed25519 keys in PEM files, over OpenSSL.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace mortise::rpc {

// A private or public key. Immutable; thread safe.
class IdentityKey {
 public:
  // NOT_FOUND, or INVALID_ARGUMENT naming the file if it holds no Ed25519 key of that kind.
  static absl::StatusOr<std::shared_ptr<const IdentityKey>> ReadPrivate(
      const std::filesystem::path& path);
  static absl::StatusOr<std::shared_ptr<const IdentityKey>> ReadPublic(
      const std::filesystem::path& path);

  virtual ~IdentityKey() = default;

  // 64 bytes. Only with a private key.
  virtual std::string Sign(std::string_view bytes) const = 0;

  virtual bool Verify(std::string_view bytes, std::string_view signature) const = 0;
};

}  // namespace mortise::rpc
