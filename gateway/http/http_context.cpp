#include "gateway/http/http_context.h"

#include <grpcpp/support/status.h>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "gateway/forwarding/wire.h"
#include "google/rpc/status.pb.h"

namespace mortise::gateway {
namespace {

constexpr char kRequestIdHeader[] = "x-request-id";
constexpr char kRetrySeconds[] = "1";

// Headers that speak of this HTTP exchange and mean nothing to a service.
bool IsOfTheExchange(std::string_view name) {
  return name.starts_with("accept") || name.starts_with("connect-") ||
         name.starts_with("content-") || name.starts_with("if-") || name.starts_with("sec-") ||
         name.starts_with("access-control-") || name == "origin" || name == "referer" ||
         name == "expect" || name == "range" || name == "cache-control" || name == "pragma" ||
         name == "last-event-id" || name == "priority" || name == "upgrade-insecure-requests";
}

// Whether the refusal is for what others do at the moment.
bool IsForNow(const ConnectError& error) {
  for (const ErrorDetailBytes& detail : error.details) {
    google::rpc::ErrorInfo info;
    if (detail.type == info.GetTypeName() && info.ParseFromString(detail.value) &&
        (absl::StartsWith(info.reason(), "TOO_MANY_") || info.reason() == kKeysBeingFetched)) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::string_view HeaderOf(const HttpRequest& request, std::string_view name) {
  const auto found = request.find(boost::beast::string_view(name.data(), name.size()));
  if (found == request.end()) return {};
  return {found->value().data(), found->value().size()};
}

std::pair<std::string, std::string> RequestIdOf(const HttpRequest& request) {
  const std::string_view id = HeaderOf(request, kRequestIdHeader);
  return {kRequestIdHeader, IsRequestId(id) ? std::string(id) : NewIdentifier()};
}

HeaderList MetadataOf(const HttpRequest& request) {
  HeaderList metadata = {RequestIdOf(request)};
  for (const auto& field : request) {
    const auto raw_name = field.name_string();
    const std::string name = absl::AsciiStrToLower({raw_name.data(), raw_name.size()});
    std::string value(field.value().data(), field.value().size());
    if (name != "authorization" && (IsReservedMetadata(name) || IsOfTheExchange(name))) continue;
    if (name.ends_with("-bin")) {
      std::string bytes;
      if (!absl::Base64Unescape(value, &bytes)) continue;
      value = std::move(bytes);
    }
    if (IsLegalMetadata(name, value)) metadata.emplace_back(name, std::move(value));
  }
  return metadata;
}

void AppendMetadata(HeaderList& headers, const HeaderList& metadata, const char* prefix) {
  for (const auto& [name, value] : metadata) {
    const bool binary = std::string_view(name).ends_with("-bin");
    headers.emplace_back(absl::StrCat(prefix, name), binary ? absl::Base64Escape(value) : value);
  }
}

absl::StatusOr<std::shared_ptr<const Caller>> CallerOf(const HttpContext& context,
                                                       const HttpRequest& request) {
  if (request.count(boost::beast::http::field::authorization) > 1) return SeveralTokens();
  return context.admission->Authenticate(HeaderOf(request, "authorization"));
}

absl::Status CheckPassedHeaders(const HeaderList& metadata) {
  PassedMetadata passed;
  for (const auto& [name, value] : metadata) {
    if (!IsReservedMetadata(name)) passed.Add(name, value);
  }
  return passed.Check("headers");
}

boost::asio::awaitable<bool> WriteError(HttpConnection& connection, const ConnectError& error,
                                        HeaderList headers, bool keep_alive) {
  const int status = HttpStatusOf(error.code);
  co_return co_await WriteErrorAs(status, connection, error, std::move(headers), keep_alive);
}

boost::asio::awaitable<bool> WriteErrorAs(int status, HttpConnection& connection,
                                          const ConnectError& error, HeaderList headers,
                                          bool keep_alive) {
  headers.emplace_back("content-type", "application/json");
  if (error.code == absl::StatusCode::kUnauthenticated) {
    headers.emplace_back("www-authenticate", "Bearer");
  }
  if (IsForNow(error)) headers.emplace_back("retry-after", kRetrySeconds);
  co_return co_await connection.Write(status, headers, ErrorJson(error), keep_alive);
}

ConnectError ToConnectError(const absl::Status& status) {
  return *ToConnectError(rpc::ToGrpc(status));
}

}  // namespace mortise::gateway
