// What the handlers of the HTTP door share, and small pieces of HTTP they have in common.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "gateway/admission/admission.h"
#include "gateway/admission/budget.h"
#include "gateway/admission/open_calls.h"
#include "gateway/contract/contract.h"
#include "gateway/contract/transcoder.h"
#include "gateway/forwarding/client_call.h"
#include "gateway/http/cross_origin.h"
#include "gateway/http/http_connection.h"

namespace mortise::gateway {

// Everything outlives the door.
struct HttpContext {
  const Contract* contract = nullptr;
  const Transcoder* transcoder = nullptr;
  Admission* admission = nullptr;
  GenericStub* stub = nullptr;  // of the gRPC door, in this process
  OpenCalls* open_calls = nullptr;
  Budget* bodies = nullptr;              // bytes of bodies, by subject; the gRPC door's too
  Budget* answers = nullptr;             // answers that may take long: streams, and calls that wait
  bool loopback_names_only = false;      // of `Host`: others are refused
  CrossOrigins cross_origins;            // whose pages may call
  std::string openapi;                   // the document
  std::string version;                   // of the gateway
  std::function<std::string()> metrics;  // in Prometheus' text format
  std::function<absl::Status()> health;  // why it does not serve, if it does not
};

// Returns the value of a header; empty if it is absent.
std::string_view HeaderOf(const HttpRequest& request, std::string_view name);

// Returns the header "x-request-id" of the answer: the client's own, or one made here.
std::pair<std::string, std::string> RequestIdOf(const HttpRequest& request);

// Returns who sends the request; fails as Admission::Authenticate does.
absl::StatusOr<std::shared_ptr<const Caller>> CallerOf(const HttpContext& context,
                                                       const HttpRequest& request);

// Returns RESOURCE_EXHAUSTED, METADATA_TOO_LARGE if these headers are more than a service takes.
absl::Status CheckPassedHeaders(const HeaderList& metadata);

// Returns the headers of a request that become metadata of the call: tokens, the request id (made
// here if the client gave none) and what is neither reserved nor the protocol's own; `-bin` ones
// decoded.
HeaderList MetadataOf(const HttpRequest& request);

// Metadata as HTTP headers, each name after `prefix`; `-bin` ones encoded.
void AppendMetadata(HeaderList& headers, const HeaderList& metadata, const char* prefix);

// Returns a unary error answer: {"code":…} with the HTTP status of its code.
boost::asio::awaitable<bool> WriteError(HttpConnection& connection, const ConnectError& error,
                                        HeaderList headers, bool keep_alive);

// The same with a status that says more than the code's. Where trying again later may help, the
// answer says so (Retry-After).
boost::asio::awaitable<bool> WriteErrorAs(int status, HttpConnection& connection,
                                          const ConnectError& error, HeaderList headers,
                                          bool keep_alive);

// A failure found in this door, as Connect clients see it.
ConnectError ToConnectError(const absl::Status& status);

}  // namespace mortise::gateway
