#include "common/rpc/token_channel.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/rpc/connection_arguments.h"

namespace mortise::rpc {
namespace {

constexpr int64_t kMaxTokenLength = 65536;  // bytes

class TokenFile : public grpc::MetadataCredentialsPlugin {
 public:
  explicit TokenFile(std::filesystem::path path) : path_(std::move(path)) {}

  const char* GetType() const override { return "bearer token"; }

  grpc::Status GetMetadata(grpc::string_ref, grpc::string_ref, const grpc::AuthContext&,
                           std::multimap<std::string, std::string>* metadata) override {
    const absl::StatusOr<std::string> text = ReadFile(path_, kMaxTokenLength);
    if (!text.ok()) {
      return {grpc::StatusCode::UNAVAILABLE,
              absl::StrCat("the token in ", path_.string(),
                           " cannot be read: ", text.status().message())};
    }
    const absl::string_view token = absl::StripAsciiWhitespace(*text);
    if (token.empty() || !std::all_of(token.begin(), token.end(), absl::ascii_isgraph)) {
      return {grpc::StatusCode::UNAVAILABLE, absl::StrCat(path_.string(), " has no token")};
    }
    metadata->emplace("authorization", absl::StrCat("Bearer ", token));
    return grpc::Status::OK;
  }

 private:
  const std::filesystem::path path_;
};

}  // namespace

absl::StatusOr<std::shared_ptr<grpc::Channel>> MakeTokenChannel(
    const std::string& address, const ChannelSecurity& security,
    const std::filesystem::path& token_file) {
  if (security.authority.empty()) {
    return InvalidField("tls-authority",
                        "must be given with --token-file, for tokens travel in TLS only");
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(token_file, error)) {
    return ResourceNotFound(token_file.string());
  }
  MORTISE_ASSIGN_OR_RETURN(const auto credentials, MakeClientCredentials(address, security));
  return grpc::CreateCustomChannel(
      address,
      grpc::CompositeChannelCredentials(credentials, grpc::MetadataCredentialsFromPlugin(
                                                         std::make_unique<TokenFile>(token_file))),
      ConnectionArguments());
}

}  // namespace mortise::rpc
