#include "gateway/http/upload_handler.h"

#include <google/protobuf/descriptor.h>
#include <grpcpp/support/status.h>

#include <algorithm>
#include <array>
#include <boost/asio/this_coro.hpp>
#include <limits>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "gateway/http/connection_token_end.h"
#include "gateway/http/file_conditions.h"
#include "gateway/http/request_body.h"
#include "mortise/v1/types.pb.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;

constexpr int kUploaded = 200;
constexpr int kLengthRequired = 411;
constexpr int kUnsupportedMediaType = 415;
constexpr std::size_t kPieceBytes = 256 * 1024;
constexpr std::string_view kDigestPrefix = "sha-256=:";

// The SHA-256 that `Content-Digest` states, in hexadecimal; empty if it states none.
absl::StatusOr<std::string> StatedDigest(std::string_view header) {
  const auto begin = header.find(kDigestPrefix);
  if (begin == std::string_view::npos) return std::string();
  const std::string_view rest = header.substr(begin + kDigestPrefix.size());
  const std::string_view text = rest.substr(0, rest.find(':'));
  std::string digest;
  if (text.size() == rest.size() ||
      !absl::Base64Unescape(absl::string_view(text.data(), text.size()), &digest) ||
      digest.size() != 32) {
    return InvalidField("content-digest", "is not sha-256=:BASE64:");
  }
  return absl::BytesToHexString(digest);
}

// An upload that may begin.
struct UploadStart {
  std::shared_ptr<const Caller> caller;
  std::unique_ptr<Budget::Share> answer;
  int64_t size = 0;
  std::string digest;
};

absl::StatusOr<UploadStart> BeginUpload(const HttpContext& context, const MethodRoute& method,
                                        const HttpRequest& request, uint64_t size) {
  UploadStart start;
  MORTISE_ASSIGN_OR_RETURN(start.caller, CallerOf(context, request));
  MORTISE_RETURN_IF_ERROR(context.admission->Authorize(method, *start.caller));
  if (size > static_cast<uint64_t>(std::numeric_limits<int64_t>::max())) {
    return TooLarge("the file", "what can be counted");
  }
  start.size = static_cast<int64_t>(size);
  MORTISE_ASSIGN_OR_RETURN(start.digest, StatedDigest(HeaderOf(request, "content-digest")));
  start.answer = context.answers->Take(start.caller->subject, 1);
  if (start.answer == nullptr) return TooManyAtATime("streams and waiting calls over HTTP");
  return start;
}

// The first piece says what the whole is.
v1::Chunk FirstPiece(const UploadStart& start, const HttpRequest& request) {
  v1::Chunk chunk;
  chunk.set_total_size(start.size);
  chunk.set_sha256(start.digest);
  chunk.set_media_type(SafeMediaType(HeaderOf(request, "content-type")));
  return chunk;
}

// Passes the body on until it ends, or one side does. What the client did; kRead, too, if the
// service wants no more.
asio::awaitable<HttpReadResult> PassOn(HttpConnection& connection, UploadCall& call,
                                       v1::Chunk chunk) {
  std::string piece;
  bool first = true;
  for (int64_t offset = 0;; offset += static_cast<int64_t>(piece.size())) {
    const HttpReadResult read = co_await connection.ReadPiece(piece, kPieceBytes);
    if (read != HttpReadResult::kRead) co_return read;
    // A file of no bytes is one piece of none.
    if (piece.empty() && !first) co_return HttpReadResult::kRead;
    chunk.set_offset(offset);
    chunk.set_data(piece);
    if (!co_await call.Write(chunk.SerializeAsString())) co_return HttpReadResult::kRead;
    if (first) chunk = {};
    first = false;
  }
}

asio::awaitable<bool> AnswerUpload(HttpConnection& connection, const HttpContext& context,
                                   const MethodRoute& method, UploadCall& call, bool keep_alive) {
  const std::optional<std::string> message = co_await call.Finish();
  if (!message) {
    const auto error = ToConnectError(call.status());
    const absl::Status none = absl::InternalError("the service gave no answer");
    co_return co_await WriteError(connection, error.value_or(ToConnectError(none)), {}, keep_alive);
  }
  auto json = context.transcoder->ToJson(*method.descriptor->output_type(), *message);
  if (!json.ok()) {
    co_return co_await WriteError(connection, ToConnectError(json.status()), {}, keep_alive);
  }
  const HeaderList headers = {{"content-type", "application/json"}};
  co_return co_await connection.Write(kUploaded, headers, *std::move(json), keep_alive);
}

asio::awaitable<bool> RefuseLength(HttpConnection& connection, bool keep_alive) {
  const ConnectError error = ToConnectError(InvalidField(
      "content-length", "is needed for a file: how large it is, before its bytes come"));
  co_return co_await WriteErrorAs(kLengthRequired, connection, error, {}, keep_alive);
}

asio::awaitable<bool> RefuseEncoding(HttpConnection& connection, bool keep_alive) {
  const ConnectError error =
      ToConnectError(InvalidField("content-encoding", "files are sent as they are"));
  const HeaderList headers = {{"accept-encoding", "identity"}};
  co_return co_await WriteErrorAs(kUnsupportedMediaType, connection, error, headers, keep_alive);
}

}  // namespace

bool IsFileItself(std::string_view content_type) {
  std::string type(content_type.substr(0, content_type.find(';')));
  absl::StripAsciiWhitespace(&type);
  absl::AsciiStrToLower(&type);
  constexpr std::array<std::string_view, 4> kOthers = {"application/json", "application/proto",
                                                       "application/x-www-form-urlencoded",
                                                       "multipart/form-data"};
  return !type.empty() && !type.starts_with("application/connect+") &&
         std::find(kOthers.begin(), kOthers.end(), type) == kOthers.end();
}

asio::awaitable<bool> HandleUpload(HttpConnection& connection, const HttpContext& context,
                                   const MethodRoute& method, const HttpRequest& request) {
  const bool keep_alive = request.keep_alive();
  const std::string_view encoding = HeaderOf(request, "content-encoding");
  const std::optional<uint64_t> size = connection.BodyBytes();
  auto start = BeginUpload(context, method, request, size.value_or(0));
  if (!start.ok()) {
    co_return co_await WriteError(connection, ToConnectError(start.status()), {}, keep_alive) &&
        keep_alive;
  }
  if (!encoding.empty() && encoding != "identity") {
    co_return co_await RefuseEncoding(connection, keep_alive) && keep_alive;
  }
  if (!size) co_return co_await RefuseLength(connection, keep_alive) && keep_alive;
  const ConnectionTokenEnd token_end(co_await asio::this_coro::executor, connection,
                                     *start->caller);
  const auto call = UploadCall::Start(
      *context.stub, {method.path, MetadataOf(request), std::nullopt}, connection.PieceStopper());
  const HttpReadResult read = co_await PassOn(connection, *call, FirstPiece(*start, request));
  if (read != HttpReadResult::kRead) {
    call->Cancel();
    co_await WriteBodyFailure(connection, read);
    co_return false;
  }
  connection.WatchForLeaving([call] { call->Cancel(); });
  const bool open = co_await AnswerUpload(connection, context, method, *call, keep_alive);
  connection.EndWatch();
  co_return open&& keep_alive;
}

}  // namespace mortise::gateway
