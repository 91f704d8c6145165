#include "gateway/http/http_routes.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "gateway/contract/query.h"
#include "gateway/http/connect_handler.h"
#include "gateway/http/sse_handler.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
using boost::beast::http::verb;

constexpr int kNoContent = 204;
constexpr int kNotFound = 404;
constexpr int kMethodNotAllowed = 405;
constexpr int kHeadersTooLarge = 431;

// What is at a path.
enum class Resource { kNothing, kDocument, kEvents, kOperationWatch, kMethod };

struct Found {
  Resource resource = Resource::kNothing;
  std::string operation;  // of kOperationWatch: "operations/pareto/0198"
  const MethodRoute* method = nullptr;
};

bool IsDocument(std::string_view path) {
  return path == "/healthz" || path == "/version" || path == "/openapi.json" || path == "/metrics";
}

// "operations/pareto/0198" of "/operations/pareto/0198/watch"; empty for other paths.
std::string WatchedOperation(std::string_view path) {
  constexpr std::string_view kEnd = "/watch";
  if (!path.starts_with("/operations/") || !path.ends_with(kEnd)) return {};
  const std::string_view name = path.substr(1, path.size() - 1 - kEnd.size());
  return ServiceOfOperation(name).empty() ? std::string() : std::string(name);
}

Found Find(const HttpContext& context, const std::string& path) {
  if (IsDocument(path)) return {Resource::kDocument, {}, nullptr};
  if (path == "/events") return {Resource::kEvents, {}, nullptr};
  if (std::string operation = WatchedOperation(path); !operation.empty()) {
    return {Resource::kOperationWatch, std::move(operation), nullptr};
  }
  const MethodRoute* method = context.contract->Find(path);
  return {method == nullptr ? Resource::kNothing : Resource::kMethod, {}, method};
}

// The value of `Allow`.
const char* AllowedAt(Resource resource) {
  switch (resource) {
    case Resource::kDocument:
      return "GET, HEAD, OPTIONS";
    case Resource::kMethod:
      return "POST, OPTIONS";
    case Resource::kNothing:
      return "GET, HEAD, POST, OPTIONS";
    default:
      return "GET, OPTIONS";
  }
}

bool IsAllowed(Resource resource, verb method) {
  if (resource == Resource::kMethod) return method == verb::post;
  return method == verb::get || (resource == Resource::kDocument && method == verb::head);
}

asio::awaitable<bool> WritePlain(HttpConnection& connection, int status, const char* type,
                                 std::string body, bool keep_alive) {
  const HeaderList headers = {{"content-type", type}};
  co_return co_await connection.Write(status, headers, std::move(body), keep_alive) && keep_alive;
}

asio::awaitable<bool> WriteDocument(HttpConnection& connection, const HttpContext& context,
                                    const std::string& path, bool keep_alive) {
  if (path == "/version") {
    co_return co_await WritePlain(connection, 200, "application/json",
                                  absl::StrCat("{\"version\":\"", context.version, "\"}\n"),
                                  keep_alive);
  }
  if (path == "/openapi.json") {
    co_return co_await WritePlain(connection, 200, "application/json", context.openapi, keep_alive);
  }
  if (path == "/metrics") {
    co_return co_await WritePlain(connection, 200, "text/plain; version=0.0.4", context.metrics(),
                                  keep_alive);
  }
  const absl::Status health = context.health();
  std::string text = "ok\n";
  if (!health.ok()) text = absl::StrCat(health.message(), "\n");
  co_return co_await WritePlain(connection, health.ok() ? 200 : 503, "text/plain", std::move(text),
                                keep_alive);
}

// One Host, as HTTP/1.1 demands, and the right one. A target's own host counts more (RFC 9112).
absl::Status CheckHost(const HttpContext& context, const HttpRequest& request,
                       const Target& target) {
  const auto count = request.count(boost::beast::http::field::host);
  if (count > 1) return InvalidField("host", "is there more than once");
  if (count == 0 && request.version() >= 11) return InvalidField("host", "is needed");
  if (!context.loopback_names_only) return absl::OkStatus();
  std::vector<std::string_view> authorities;
  if (count == 1) authorities.push_back(HeaderOf(request, "host"));
  if (!target.authority.empty()) authorities.push_back(target.authority);
  for (const std::string_view authority : authorities) {
    if (IsLoopbackAuthority(authority)) continue;
    return WithDetail(absl::PermissionDeniedError(absl::StrCat(
                          "a house without tokens answers to localhost, 127.0.0.1 and [::1] only, "
                          "and was called ",
                          std::string(authority.substr(0, 256)))),
                      {"HOST_REFUSED", "host"});
  }
  return absl::OkStatus();
}

asio::awaitable<bool> RefuseMethod(HttpConnection& connection, const Found& found,
                                   const Target& target, const HttpRequest& request) {
  const bool nothing = found.resource == Resource::kNothing;
  std::string message = absl::StrCat("there is nothing at ", target.path);
  if (nothing && request.method() == verb::post) {
    message = absl::StrCat("there is no method ", target.path);
  } else if (found.resource == Resource::kMethod) {
    message = "calls are made by POST";
  } else if (!nothing) {
    message = absl::StrCat(target.path, " is read by GET");
  }
  const ConnectError error = {absl::StatusCode::kUnimplemented, message, {}};
  const HeaderList headers = {{"allow", AllowedAt(found.resource)}};
  co_return co_await WriteErrorAs(nothing ? kNotFound : kMethodNotAllowed, connection, error,
                                  headers, request.keep_alive()) &&
      request.keep_alive();
}

// Tells which methods there are. No page of another origin gets leave to call any.
asio::awaitable<bool> TellMethods(HttpConnection& connection, Resource resource, bool keep_alive) {
  const HeaderList headers = {{"allow", AllowedAt(resource)}};
  co_return co_await connection.Write(kNoContent, headers, "", keep_alive) && keep_alive;
}

asio::awaitable<bool> Answer(HttpConnection& connection, const HttpContext& context,
                             const Target& target, HttpRequest& request) {
  const bool keep_alive = request.keep_alive();
  const Found found = Find(context, target.path);
  if (request.method() == verb::options && found.resource != Resource::kNothing) {
    co_return co_await TellMethods(connection, found.resource, keep_alive);
  }
  if (found.resource == Resource::kNothing || !IsAllowed(found.resource, request.method())) {
    co_return co_await RefuseMethod(connection, found, target, request);
  }
  if (found.resource == Resource::kDocument) {
    co_return co_await WriteDocument(connection, context, target.path, keep_alive);
  }
  if (const absl::Status fit = CheckPassedHeaders(MetadataOf(request)); !fit.ok()) {
    co_return co_await WriteErrorAs(kHeadersTooLarge, connection, ToConnectError(fit), {},
                                    keep_alive) &&
        keep_alive;
  }
  if (found.resource == Resource::kMethod) {
    co_return co_await HandleConnect(connection, context, *found.method, request);
  }
  if (found.resource == Resource::kEvents) {
    co_return co_await HandleEvents(connection, context, target, request) && keep_alive;
  }
  co_return co_await HandleOperationWatch(connection, context, found.operation, request) &&
      keep_alive;
}

}  // namespace

asio::awaitable<bool> HandleRequest(HttpConnection& connection, const HttpContext& context,
                                    HttpRequest& request) {
  const bool whole_server = request.method() == verb::options && request.target() == "*";
  const auto target = ParseTarget(
      whole_server ? "/" : std::string_view(request.target().data(), request.target().size()));
  absl::Status status = target.status();
  if (status.ok()) status = CheckHost(context, request, *target);
  if (!status.ok()) {
    co_return co_await WriteError(connection, ToConnectError(status), {}, request.keep_alive()) &&
        request.keep_alive();
  }
  if (whole_server) {
    co_return co_await TellMethods(connection, Resource::kNothing, request.keep_alive());
  }
  co_return co_await Answer(connection, context, *target, request);
}

asio::awaitable<void> RefuseHead(HttpConnection& connection, HttpReadResult result) {
  if (result == HttpReadResult::kTooLarge) {
    const absl::Status status = TooLarge("the block of headers", "64 KiB");
    co_await WriteErrorAs(kHeadersTooLarge, connection, ToConnectError(status), {}, false);
  } else {
    const absl::Status status = InvalidField("request", "is not one of HTTP/1.1");
    co_await WriteError(connection, ToConnectError(status), {}, false);
  }
}

}  // namespace mortise::gateway
