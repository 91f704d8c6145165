#include "gateway/http/http_routes.h"

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "gateway/contract/query.h"
#include "gateway/http/compression.h"
#include "gateway/http/connect_handler.h"
#include "gateway/http/file_handler.h"
#include "gateway/http/items_handler.h"
#include "gateway/http/sse_handler.h"
#include "gateway/http/upload_handler.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
using boost::beast::http::verb;

constexpr int kNoContent = 204;
constexpr int kNotFound = 404;
constexpr int kMethodNotAllowed = 405;
constexpr int kHeadersTooLarge = 431;

// What is at a path.
enum class Resource {
  kNothing,
  kDocument,
  kEvents,
  kOperationWatch,
  kItems,
  kMethod,
  kFile,    // a method that gives one
  kUpload,  // a method that takes one
};

struct Found {
  Resource resource = Resource::kNothing;
  std::string operation;                // of kOperationWatch: "operations/pareto/0198"
  const MethodRoute* method = nullptr;  // of kMethod, kFile and kUpload
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
  if (path == kItemsPath) return {Resource::kItems, {}, nullptr};
  const MethodRoute* method = context.contract->Find(path);
  if (method == nullptr) return {};
  if (GivesFile(*method)) return {Resource::kFile, {}, method};
  return {TakesFile(*method) ? Resource::kUpload : Resource::kMethod, {}, method};
}

// The value of `Allow`.
const char* AllowedAt(Resource resource) {
  switch (resource) {
    case Resource::kDocument:
      return "GET, HEAD, OPTIONS";
    case Resource::kMethod:
      return "POST, OPTIONS";
    case Resource::kUpload:
      return "POST, PUT, OPTIONS";
    case Resource::kFile:
    case Resource::kItems:
      return "GET, HEAD, POST, OPTIONS";
    case Resource::kNothing:
      return "GET, HEAD, POST, PUT, OPTIONS";
    default:
      return "GET, OPTIONS";
  }
}

bool IsAllowed(Resource resource, verb method) {
  switch (resource) {
    case Resource::kMethod:
      return method == verb::post;
    case Resource::kUpload:
      return method == verb::post || method == verb::put;
    case Resource::kFile:
    case Resource::kItems:
      return method == verb::get || method == verb::head || method == verb::post;
    case Resource::kDocument:
      return method == verb::get || method == verb::head;
    default:
      return method == verb::get;
  }
}

asio::awaitable<bool> WritePlain(HttpConnection& connection, const HttpRequest& request, int status,
                                 const char* type, std::string body) {
  const bool keep_alive = request.keep_alive();
  const HeaderList headers = {{"content-type", type}};
  co_return co_await WriteCompressed(connection, request, status, headers, std::move(body),
                                     keep_alive) &&
      keep_alive;
}

asio::awaitable<bool> WriteDocument(HttpConnection& connection, const HttpContext& context,
                                    const std::string& path, const HttpRequest& request) {
  if (path == "/version") {
    co_return co_await WritePlain(connection, request, 200, "application/json",
                                  absl::StrCat("{\"version\":\"", context.version, "\"}\n"));
  }
  if (path == "/openapi.json") {
    co_return co_await WritePlain(connection, request, 200, "application/json", context.openapi);
  }
  if (path == "/metrics") {
    co_return co_await WritePlain(connection, request, 200, "text/plain; version=0.0.4",
                                  context.metrics());
  }
  const absl::Status health = context.health();
  std::string text = "ok\n";
  if (!health.ok()) text = absl::StrCat(health.message(), "\n");
  co_return co_await WritePlain(connection, request, health.ok() ? 200 : 503, "text/plain",
                                std::move(text));
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

// Offers the method of the same service that is nearest.
std::string MethodOffered(const Contract& contract, const std::string& path) {
  const std::string service = path.substr(0, path.rfind('/') + 1);
  std::vector<std::string> names;
  for (const MethodRoute& method : contract.methods()) {
    if (method.path.starts_with(service)) names.push_back(method.path.substr(service.size()));
  }
  return NearestOffered(path.substr(service.size()), names);
}

asio::awaitable<bool> RefuseMethod(HttpConnection& connection, const HttpContext& context,
                                   const Found& found, const Target& target,
                                   const HttpRequest& request) {
  const bool nothing = found.resource == Resource::kNothing;
  std::string message = absl::StrCat("there is nothing at ", target.path);
  if (nothing && request.method() == verb::post) {
    message = absl::StrCat("there is no method ", target.path,
                           MethodOffered(*context.contract, target.path));
  } else if (found.resource == Resource::kMethod) {
    message = "calls are made by POST";
  } else if (found.resource == Resource::kUpload) {
    message = "files are sent by PUT or POST";
  } else if (!nothing) {
    message = absl::StrCat(target.path, " is read by GET");
  }
  const ConnectError error = {absl::StatusCode::kUnimplemented, message, {}};
  const HeaderList headers = {{"allow", AllowedAt(found.resource)}};
  co_return co_await WriteErrorAs(nothing ? kNotFound : kMethodNotAllowed, connection, error,
                                  headers, request.keep_alive()) &&
      request.keep_alive();
}

// Tells which methods there are, and gives a page of an origin that was stated leave to call them.
asio::awaitable<bool> TellMethods(HttpConnection& connection, const HttpContext& context,
                                  Resource resource, const HttpRequest& request) {
  HeaderList headers = {{"allow", AllowedAt(resource)}};
  if (!HeaderOf(request, "access-control-request-method").empty()) {
    const HeaderList leave = context.cross_origins.PreflightHeaders(
        HeaderOf(request, "origin"), HeaderOf(request, "access-control-request-headers"));
    headers.insert(headers.end(), leave.begin(), leave.end());
  }
  co_return co_await connection.Write(kNoContent, headers, "", request.keep_alive()) &&
      request.keep_alive();
}

// What is at a method's path: a call, or a file that goes one way.
asio::awaitable<bool> AnswerMethod(HttpConnection& connection, const HttpContext& context,
                                   const Found& found, const Target& target, HttpRequest& request) {
  const bool posted = request.method() == verb::post;
  if (found.resource == Resource::kFile && !posted) {
    co_return co_await HandleFile(connection, context, *found.method, target, request);
  }
  if (found.resource == Resource::kUpload &&
      (!posted || IsFileItself(HeaderOf(request, "content-type")))) {
    co_return co_await HandleUpload(connection, context, *found.method, request);
  }
  co_return co_await HandleConnect(connection, context, *found.method, request);
}

asio::awaitable<bool> Answer(HttpConnection& connection, const HttpContext& context,
                             const Target& target, HttpRequest& request) {
  const bool keep_alive = request.keep_alive();
  const Found found = Find(context, target.path);
  if (request.method() == verb::options && found.resource != Resource::kNothing) {
    co_return co_await TellMethods(connection, context, found.resource, request);
  }
  if (found.resource == Resource::kNothing || !IsAllowed(found.resource, request.method())) {
    co_return co_await RefuseMethod(connection, context, found, target, request);
  }
  if (found.resource == Resource::kDocument) {
    co_return co_await WriteDocument(connection, context, target.path, request);
  }
  if (const absl::Status fit = CheckPassedHeaders(MetadataOf(request)); !fit.ok()) {
    co_return co_await WriteErrorAs(kHeadersTooLarge, connection, ToConnectError(fit), {},
                                    keep_alive) &&
        keep_alive;
  }
  if (found.method != nullptr) {
    co_return co_await AnswerMethod(connection, context, found, target, request);
  }
  if (found.resource == Resource::kItems) {
    if (request.method() == verb::post) {
      co_return co_await HandleItemsImport(connection, context, request);
    }
    co_return co_await HandleItems(connection, context, target, request);
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
  connection.SetAnswerHeaders(context.cross_origins.HeadersFor(HeaderOf(request, "origin")));
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
    co_return co_await TellMethods(connection, context, Resource::kNothing, request);
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
