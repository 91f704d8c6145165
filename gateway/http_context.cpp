#include "gateway/http_context.h"

#include <grpcpp/support/status.h>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "gateway/wire.h"

namespace mortise::gateway {
namespace {

constexpr char kRequestIdHeader[] = "x-request-id";

// Headers that speak of this HTTP exchange and mean nothing to a service.
bool IsOfTheExchange(std::string_view name) {
  return name.starts_with("accept") || name.starts_with("connect-") ||
         name.starts_with("content-") || name.starts_with("if-") || name.starts_with("sec-") ||
         name.starts_with("access-control-") || name == "origin" || name == "referer" ||
         name == "expect" || name == "cache-control" || name == "pragma" ||
         name == "last-event-id" || name == "priority" || name == "upgrade-insecure-requests";
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
  co_return co_await connection.Write(status, headers, ErrorJson(error), keep_alive);
}

ConnectError ToConnectError(const absl::Status& status) {
  return *ToConnectError(rpc::ToGrpc(status));
}

}  // namespace mortise::gateway
