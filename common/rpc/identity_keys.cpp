#include "common/rpc/identity_keys.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/freed_by.h"
#include "common/base/identifiers.h"
#include "common/rpc/identity.h"

namespace mortise::rpc {
namespace {

constexpr std::size_t kMaxKeyFile = 64 * 1024;
constexpr std::size_t kSignatureBytes = 64;

using Key = std::unique_ptr<EVP_PKEY, FreedBy<EVP_PKEY_free>>;
using Bio = std::unique_ptr<BIO, FreedBy<BIO_free_all>>;
using DigestContext = std::unique_ptr<EVP_MD_CTX, FreedBy<EVP_MD_CTX_free>>;

const unsigned char* Bytes(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

class Ed25519Key : public IdentityKey {
 public:
  explicit Ed25519Key(Key key) : key_(std::move(key)) {}

  std::string Sign(std::string_view bytes) const override {
    DigestContext context(EVP_MD_CTX_new());
    std::string signature(kSignatureBytes, '\0');
    std::size_t length = signature.size();
    const bool signed_ok =
        EVP_DigestSignInit(context.get(), nullptr, nullptr, nullptr, key_.get()) == 1 &&
        EVP_DigestSign(context.get(), reinterpret_cast<unsigned char*>(signature.data()), &length,
                       Bytes(bytes), bytes.size()) == 1;
    return signed_ok ? signature : std::string();
  }

  bool Verify(std::string_view bytes, std::string_view signature) const override {
    if (signature.size() != kSignatureBytes) return false;
    DigestContext context(EVP_MD_CTX_new());
    return EVP_DigestVerifyInit(context.get(), nullptr, nullptr, nullptr, key_.get()) == 1 &&
           EVP_DigestVerify(context.get(), Bytes(signature), signature.size(), Bytes(bytes),
                            bytes.size()) == 1;
  }

 private:
  Key key_;
};

template <class Read>
absl::StatusOr<std::shared_ptr<const IdentityKey>> ReadKey(const std::filesystem::path& path,
                                                           const char* what, Read read) {
  MORTISE_ASSIGN_OR_RETURN(const std::string pem, ReadFile(path, kMaxKeyFile));
  Bio bio(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  Key key(read(bio.get(), nullptr, nullptr, nullptr));
  if (!key || EVP_PKEY_id(key.get()) != EVP_PKEY_ED25519) {
    return InvalidField(path.string(), absl::StrCat("is not an Ed25519 ", what, " key in PEM"));
  }
  return std::make_shared<const Ed25519Key>(std::move(key));
}

std::string TextOf(BIO* bio) {
  char* data = nullptr;
  const long length = BIO_get_mem_data(bio, &data);
  return std::string(data, static_cast<std::size_t>(length));
}

// Nobody but the owner may ever read the file, so it is created with its mode.
absl::Status WritePrivateFile(const std::filesystem::path& path, const std::string& bytes) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) {
    return errno == EEXIST ? ResourceExists(path.string())
                           : StorageFailed(path.string(), std::strerror(errno));
  }
  const bool written = write(file, bytes.data(), bytes.size()) == ssize_t(bytes.size());
  const bool closed = close(file) == 0;
  if (!written || !closed) return StorageFailed(path.string(), std::strerror(errno));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::shared_ptr<const IdentityKey>> IdentityKey::ReadPrivate(
    const std::filesystem::path& path) {
  return ReadKey(path, "private", PEM_read_bio_PrivateKey);
}

absl::StatusOr<std::shared_ptr<const IdentityKey>> IdentityKey::ReadPublic(
    const std::filesystem::path& path) {
  return ReadKey(path, "public", PEM_read_bio_PUBKEY);
}

absl::Status CreateIdentityKey(const std::filesystem::path& folder, std::string_view issuer) {
  if (!IsResourceId(issuer)) {
    return InvalidField("issuer", "must be lower-case letters, digits and hyphens");
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return StorageFailed(folder.string(), error.message());

  Key key(EVP_PKEY_Q_keygen(nullptr, nullptr, "ED25519"));
  Bio private_pem(BIO_new(BIO_s_mem()));
  Bio public_pem(BIO_new(BIO_s_mem()));
  if (!key ||
      PEM_write_bio_PrivateKey(private_pem.get(), key.get(), nullptr, nullptr, 0, nullptr,
                               nullptr) != 1 ||
      PEM_write_bio_PUBKEY(public_pem.get(), key.get()) != 1) {
    return absl::InternalError("OpenSSL cannot make an Ed25519 key");
  }
  const std::string name(issuer);
  MORTISE_RETURN_IF_ERROR(WritePrivateFile(folder / (name + ".key"), TextOf(private_pem.get())));
  return WriteFile(folder / (name + ".pub"), TextOf(public_pem.get()));
}

}  // namespace mortise::rpc
