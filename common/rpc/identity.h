// Who calls: short-lived identities that one process signs and every other verifies.
//
// The gateway authenticates people and signs what it found; a service signs an identity of its own
// for work it does in the background. An identity is a serialised mortise.v1.Identity with an
// Ed25519 signature (mortise.v1.SignedIdentity), carried in the metadata `mortise-identity-bin`.
//
// A folder of keys holds `<issuer>.key` (PEM, mode 0600) for the processes that sign, and
// `<issuer>.pub` (PEM) for every issuer that is trusted. The issuer "gateway" may vouch for anyone;
// any other issuer only for its own service ("pareto" for "services/pareto").
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"

namespace mortise::rpc {

// What a caller may do; each role includes the ones before it. Numbers as in mortise.v1.Role.
enum class Role { kNone = 0, kViewer = 1, kDesigner = 2, kOperator = 3, kAdmin = 4 };

// "none", "viewer", "designer", "operator", "admin".
const char* RoleName(Role role);

// Returns the role of that name; INVALID_ARGUMENT naming `field` otherwise.
absl::StatusOr<Role> ParseRole(std::string_view name, std::string_view field);

struct Identity {
  std::string subject;      // "users/ada", "services/pareto"
  Role role = Role::kNone;  // the highest held
  std::string trace_id;     // the id of the outermost request, which every log line carries
  std::string issuer;       // who vouches: "gateway"
  absl::Time issued_at;
  absl::Time expires_at;
};

// The metadata key of a signed identity, and of the trace id where nobody signs (development).
inline constexpr char kIdentityMetadata[] = "mortise-identity-bin";
inline constexpr char kTraceMetadata[] = "mortise-trace-id";

// The issuer that may vouch for every subject, and the longest time an identity may live.
inline constexpr char kGatewayIssuer[] = "gateway";
inline constexpr absl::Duration kIdentityLifetime = absl::Seconds(300);

// Writes a new key pair `<issuer>.key` (mode 0600) and `<issuer>.pub` into `folder`, which is
// created if missing. ALREADY_EXISTS if there is one; INVALID_ARGUMENT if `issuer` is not a
// resource id.
absl::Status CreateIdentityKey(const std::filesystem::path& folder, std::string_view issuer);

// Signs identities as one issuer. Thread safe.
class IdentitySigner {
 public:
  using Clock = std::function<absl::Time()>;

  // Reads `<issuer>.key`. NOT_FOUND or INVALID_ARGUMENT naming the file.
  static absl::StatusOr<std::unique_ptr<IdentitySigner>> Load(const std::filesystem::path& folder,
                                                              std::string_view issuer,
                                                              Clock clock = absl::Now);
  virtual ~IdentitySigner() = default;

  // Returns a serialised SignedIdentity, valid from now for `lifetime` (at most kIdentityLifetime).
  virtual std::string Sign(std::string_view subject, Role role, std::string_view trace_id,
                           absl::Duration lifetime = kIdentityLifetime) const = 0;

  // The same for the service itself: subject "services/<issuer>".
  virtual std::string SignService(Role role, std::string_view trace_id) const = 0;

  virtual const std::string& issuer() const = 0;
};

struct VerifierOptions {
  std::filesystem::path folder;                  // where `<issuer>.pub` files are
  absl::Duration clock_skew = absl::Seconds(5);  // by which clocks of hosts may differ
  std::function<absl::Time()> clock = absl::Now;
};

// Verifies identities against the trusted issuers. Thread safe.
class IdentityVerifier {
 public:
  // Reads every `*.pub`. FAILED_PRECONDITION if the folder has none, INVALID_ARGUMENT naming a file
  // that is not an Ed25519 public key.
  static absl::StatusOr<std::unique_ptr<IdentityVerifier>> Load(const VerifierOptions& options);
  virtual ~IdentityVerifier() = default;

  // Returns the identity in a serialised SignedIdentity. UNAUTHENTICATED, IDENTITY_INVALID if it is
  // malformed, forged, expired, from the future, lives too long, its issuer is unknown or may not
  // vouch for its subject. The folder is read again when an unknown issuer appears (at most once a
  // second).
  virtual absl::StatusOr<Identity> Verify(std::string_view signed_identity) = 0;
};

}  // namespace mortise::rpc
