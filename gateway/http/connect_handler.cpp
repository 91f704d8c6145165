#include "gateway/http/connect_handler.h"

#include <google/protobuf/descriptor.h>
#include <grpcpp/support/status.h>

#include <boost/asio/this_coro.hpp>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "gateway/http/compression.h"
#include "gateway/http/connection_token_end.h"
#include "gateway/http/request_body.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;

constexpr int kUnsupportedMediaType = 415;
constexpr int kVersionNotSupported = 505;

// A call as its HTTP request describes it.
struct ConnectCall {
  ConnectCodec codec;
  CallHead head;
  std::vector<std::string> requests;  // serialised
};

bool IsStreaming(const MethodRoute& method) {
  return method.client_streaming || method.server_streaming;
}

absl::Status CheckHeaders(const HttpRequest& request) {
  const std::string_view version = HeaderOf(request, "connect-protocol-version");
  if (!version.empty() && version != "1") {
    return InvalidField("connect-protocol-version", "only version 1 is spoken here");
  }
  const std::string_view encoding = HeaderOf(request, "connect-content-encoding");
  if (encoding.empty() || encoding == "identity") return absl::OkStatus();
  return NotBuilt("compression of messages in envelopes");
}

// The messages of the body, each as a serialised message of the method's request type.
absl::StatusOr<std::vector<std::string>> ReadMessages(const HttpContext& context,
                                                      const MethodRoute& method,
                                                      const ConnectCodec& codec,
                                                      std::string_view body) {
  std::vector<std::string_view> payloads = {body};
  if (codec.streaming) {
    MORTISE_ASSIGN_OR_RETURN(payloads, SplitEnvelopes(body, kMaximalBodyBytes));
    if (!method.client_streaming && payloads.size() != 1) {
      return InvalidField("request", "the method takes exactly one message");
    }
  }
  std::vector<std::string> messages;
  for (const std::string_view payload : payloads) {
    if (!codec.json) {
      messages.emplace_back(payload);
      continue;
    }
    MORTISE_ASSIGN_OR_RETURN(std::string message, context.transcoder->ToBinary(
                                                      *method.descriptor->input_type(), payload));
    messages.push_back(std::move(message));
  }
  return messages;
}

// All that can be known before the body is read: strangers shall not keep this gateway busy with
// large bodies.
absl::StatusOr<std::shared_ptr<const Caller>> ReadCallHead(const HttpContext& context,
                                                           const MethodRoute& method,
                                                           const HttpRequest& request,
                                                           CallHead& head) {
  MORTISE_RETURN_IF_ERROR(CheckHeaders(request));
  MORTISE_ASSIGN_OR_RETURN(auto caller, CallerOf(context, request));
  MORTISE_RETURN_IF_ERROR(context.admission->Authorize(method, *caller));
  const std::string_view timeout = HeaderOf(request, "connect-timeout-ms");
  if (!timeout.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const absl::Duration duration, ParseTimeout(timeout));
    if (duration == absl::ZeroDuration()) {
      return absl::DeadlineExceededError("connect-timeout-ms gives no time");
    }
    head.deadline = std::chrono::system_clock::now() + absl::ToChronoMilliseconds(duration);
  }
  head.path = method.path;
  return caller;
}

absl::StatusOr<std::string> WriteMessage(const HttpContext& context, const MethodRoute& method,
                                         const ConnectCodec& codec, std::string message) {
  if (!codec.json) return message;
  return context.transcoder->ToJson(*method.descriptor->output_type(), message);
}

asio::awaitable<bool> AnswerUnary(HttpConnection& connection, const HttpContext& context,
                                  const MethodRoute& method, const HttpRequest& request,
                                  ConnectCall call) {
  const bool keep_alive = request.keep_alive();
  const auto running = ClientCall::StartUnary(*context.stub, call.head, call.requests.front());
  connection.WatchForLeaving([running] { running->Cancel(); });
  std::optional<std::string> message = co_await running->Read();
  connection.EndWatch();

  HeaderList headers;
  AppendMetadata(headers, running->leading(), "");
  AppendMetadata(headers, running->trailing(), "trailer-");
  std::optional<ConnectError> error = ToConnectError(running->status());
  std::string body;
  if (message) {
    auto text = WriteMessage(context, method, call.codec, *std::move(message));
    if (text.ok()) {
      body = *std::move(text);
    } else {
      error = ToConnectError(text.status());
    }
  }
  if (error) co_return co_await WriteError(connection, *error, std::move(headers), keep_alive);
  headers.emplace_back("content-type", ContentTypeOf(call.codec));
  co_return co_await WriteCompressed(connection, request, 200, std::move(headers), std::move(body),
                                     keep_alive);
}

asio::awaitable<bool> EndStream(HttpConnection& connection,
                                const std::optional<ConnectError>& error,
                                const HeaderList& trailers) {
  HeaderList encoded;
  AppendMetadata(encoded, trailers, "");
  if (!co_await connection.WriteChunk(Envelope(kEndStreamFlag, EndStreamJson(error, encoded)))) {
    co_return false;
  }
  co_return co_await connection.EndChunks();
}

asio::awaitable<bool> AnswerStream(HttpConnection& connection, const HttpContext& context,
                                   const MethodRoute& method, const Caller& caller,
                                   ConnectCall call, bool keep_alive) {
  const ConnectionTokenEnd token_end(co_await asio::this_coro::executor, connection, caller);
  const auto running = ClientCall::StartStreaming(*context.stub, call.head, call.requests);
  connection.WatchForLeaving([running] { running->Cancel(); });
  std::optional<std::string> message = co_await running->Read();

  HeaderList headers = {{"content-type", std::string(ContentTypeOf(call.codec))}};
  AppendMetadata(headers, running->leading(), "");
  bool listening = co_await connection.BeginChunks(200, headers, keep_alive);
  while (listening && message) {
    auto text = WriteMessage(context, method, call.codec, *std::move(message));
    if (!text.ok()) {
      running->Cancel();
      connection.EndWatch();
      co_return co_await EndStream(connection, ToConnectError(text.status()), {});
    }
    listening = co_await connection.WriteChunk(Envelope(0, *text));
    if (listening) message = co_await running->Read();
  }
  connection.EndWatch();
  if (!listening) {
    running->Cancel();
    co_return false;
  }
  co_return co_await EndStream(connection, ToConnectError(running->status()), running->trailing());
}

// What a call takes of what there is for all.
struct Places {
  RequestBody body;
  std::unique_ptr<Budget::Share> answer;
};

absl::StatusOr<Places> TakePlaces(const HttpConnection& connection, const HttpContext& context,
                                  const MethodRoute& method, const HttpRequest& request,
                                  const std::string& subject) {
  MORTISE_ASSIGN_OR_RETURN(RequestBody body,
                           RequestBody::Expect(connection, context, request, subject));
  Places places{std::move(body), nullptr};
  if (method.kind == CallKind::kStream || method.kind == CallKind::kWait) {
    places.answer = context.answers->Take(subject, 1);
    if (places.answer == nullptr) return TooManyAtATime("streams and waiting calls over HTTP");
  }
  return places;
}

// Failures before the call began, in the form that the client's protocol expects.
asio::awaitable<bool> Refuse(HttpConnection& connection, const ConnectCodec& codec,
                             const absl::Status& status, bool keep_alive) {
  if (!codec.streaming) {
    co_return co_await WriteError(connection, ToConnectError(status), {}, keep_alive);
  }
  const HeaderList headers = {{"content-type", std::string(ContentTypeOf(codec))}};
  if (!co_await connection.BeginChunks(200, headers, keep_alive)) co_return false;
  co_return co_await EndStream(connection, ToConnectError(status), {});
}

asio::awaitable<bool> RefuseContentType(HttpConnection& connection, const MethodRoute& method,
                                        bool keep_alive) {
  const char* accepted = IsStreaming(method) ? "application/connect+json, application/connect+proto"
                                             : "application/json, application/proto";
  const HeaderList headers = {{"accept-post", accepted}};
  const ConnectError error = ToConnectError(
      InvalidField("content-type", absl::StrCat(method.full_name, " takes ", accepted)));
  co_return co_await WriteErrorAs(kUnsupportedMediaType, connection, error, headers, keep_alive);
}

// HTTP/1.1 cannot speak both ways at once; the protocol names this status.
asio::awaitable<bool> RefuseBothWays(HttpConnection& connection, const MethodRoute& method) {
  const HeaderList headers = {{"connection", "close"}};
  const ConnectError error = {absl::StatusCode::kUnimplemented,
                              method.full_name + " streams both ways: call it over gRPC",
                              {}};
  co_return co_await WriteErrorAs(kVersionNotSupported, connection, error, headers, false);
}

// Whether the body came. Where it did not, a client that is still there has been told why.
asio::awaitable<bool> ReceiveBody(HttpConnection& connection, const ConnectCodec& codec,
                                  RequestBody& body, HttpRequest& request) {
  const HttpReadResult read = co_await body.Read(connection, request);
  if (read == HttpReadResult::kRead) co_return true;
  if (read == HttpReadResult::kTooSlow) {
    co_await WriteBodyFailure(connection, read);
  } else if (const absl::Status failure = BodyFailure(read); !failure.ok()) {
    co_await Refuse(connection, codec, failure, false);
  }
  co_return false;
}

// The serialised messages of a body that has come.
absl::StatusOr<std::vector<std::string>> ReadRequests(const HttpContext& context,
                                                      const MethodRoute& method,
                                                      const ConnectCodec& codec, RequestBody& body,
                                                      HttpRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, body.Take(request));
  return ReadMessages(context, method, codec, bytes);
}

}  // namespace

asio::awaitable<bool> HandleConnect(HttpConnection& connection, const HttpContext& context,
                                    const MethodRoute& method, HttpRequest& request) {
  const bool keep_alive = request.keep_alive();
  const auto codec = ParseContentType(HeaderOf(request, "content-type"));
  if (!codec || codec->streaming != IsStreaming(method)) {
    co_return co_await RefuseContentType(connection, method, keep_alive) && keep_alive;
  }
  if (method.client_streaming && method.server_streaming) {
    co_await RefuseBothWays(connection, method);
    co_return false;
  }
  ConnectCall call;
  call.codec = *codec;
  call.head.metadata = MetadataOf(request);
  const auto caller = ReadCallHead(context, method, request, call.head);
  if (!caller.ok()) {
    co_return co_await Refuse(connection, *codec, caller.status(), keep_alive) && keep_alive;
  }
  const std::string& subject = (*caller)->subject;
  auto places = TakePlaces(connection, context, method, request, subject);
  if (!places.ok()) {
    co_return co_await Refuse(connection, *codec, places.status(), keep_alive) && keep_alive;
  }
  if (!co_await ReceiveBody(connection, *codec, places->body, request)) co_return false;
  auto requests = ReadRequests(context, method, *codec, places->body, request);
  if (!requests.ok()) {
    co_return co_await Refuse(connection, *codec, requests.status(), keep_alive) && keep_alive;
  }
  call.requests = *std::move(requests);
  bool open = false;
  if (codec->streaming) {
    open =
        co_await AnswerStream(connection, context, method, **caller, std::move(call), keep_alive);
  } else {
    open = co_await AnswerUnary(connection, context, method, request, std::move(call));
  }
  co_return open&& keep_alive;
}

}  // namespace mortise::gateway
