#include "common/rpc/channel_security.h"

#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "common/base/errors.h"

namespace mortise::rpc {
namespace {

using grpc::experimental::CertificateProviderInterface;

constexpr unsigned kReloadSeconds = 60;

absl::Status CheckFile(const std::filesystem::path& path) {
  std::error_code error;
  if (path.empty() || std::filesystem::is_regular_file(path, error)) return absl::OkStatus();
  return ResourceNotFound(path.string());
}

absl::Status CheckFiles(const ChannelSecurity& security) {
  if (security.certificate.empty() != security.key.empty()) {
    return InvalidField(security.key.empty() ? "tls-key" : "tls-certificate",
                        "certificate and key belong together");
  }
  MORTISE_RETURN_IF_ERROR(CheckFile(security.certificate));
  MORTISE_RETURN_IF_ERROR(CheckFile(security.key));
  return CheckFile(security.authority);
}

// Reads the files again as they change.
std::shared_ptr<CertificateProviderInterface> WatchFiles(const ChannelSecurity& security) {
  return std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(
      security.key.string(), security.certificate.string(), security.authority.string(),
      kReloadSeconds);
}

}  // namespace

bool IsLocalAddress(std::string_view address) {
  absl::string_view rest(address.data(), address.size());
  if (absl::StartsWith(rest, "unix:")) return true;
  absl::ConsumePrefix(&rest, "dns:///");
  absl::ConsumePrefix(&rest, "ipv4:");
  absl::ConsumePrefix(&rest, "ipv6:");
  const absl::string_view host = rest.substr(0, rest.rfind(':'));
  if (host == "localhost" || host == "[::1]") return true;
  // 127.0.0.0/8 as a literal, not a name such as 127.example.com.
  return absl::StartsWith(host, "127.") &&
         host.find_first_not_of("0123456789.") == absl::string_view::npos;
}

absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MakeServerCredentials(
    const std::string& address, const ChannelSecurity& security) {
  MORTISE_RETURN_IF_ERROR(CheckFiles(security));
  if (security.certificate.empty()) {
    if (!IsLocalAddress(address)) {
      return InvalidField("listen", absl::StrCat("listening on ", address,
                                                 ", which leaves this machine, needs a certificate"
                                                 " and key (--tls-certificate, --tls-key)"));
    }
    return grpc::InsecureServerCredentials();
  }
  grpc::experimental::TlsServerCredentialsOptions options(WatchFiles(security));
  options.watch_identity_key_cert_pairs();
  if (!security.authority.empty()) {
    options.watch_root_certs();
    options.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  }
  return grpc::experimental::TlsServerCredentials(options);
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> MakeClientCredentials(
    const std::string& address, const ChannelSecurity& security) {
  MORTISE_RETURN_IF_ERROR(CheckFiles(security));
  if (security.authority.empty()) {
    if (!IsLocalAddress(address)) {
      return InvalidField("peer", absl::StrCat("calling ", address,
                                               ", which leaves this machine, needs a certificate "
                                               "authority (--tls-authority)"));
    }
    return grpc::InsecureChannelCredentials();
  }
  grpc::experimental::TlsChannelCredentialsOptions options;
  options.set_certificate_provider(WatchFiles(security));
  options.watch_root_certs();
  if (!security.certificate.empty()) options.watch_identity_key_cert_pairs();
  return grpc::experimental::TlsCredentials(options);
}

}  // namespace mortise::rpc
