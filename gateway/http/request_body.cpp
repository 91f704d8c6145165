#include "gateway/http/request_body.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "gateway/http/compression.h"

namespace mortise::gateway {
namespace {

constexpr int kRequestTimeout = 408;
constexpr char kBodyTooSlow[] = "BODY_TOO_SLOW";

// OK for gzip, of which `compressed` tells.
absl::Status ReadEncoding(const HttpRequest& request, bool& compressed) {
  const std::string_view encoding = HeaderOf(request, "content-encoding");
  compressed = encoding == "gzip" || encoding == "x-gzip";
  if (compressed || encoding.empty() || encoding == "identity") return absl::OkStatus();
  return NotBuilt("compression of requests other than gzip");
}

}  // namespace

absl::Status BodyFailure(HttpReadResult result) {
  switch (result) {
    case HttpReadResult::kTooLarge:
      return TooLarge("the request's body",
                      absl::StrCat(kMaximalBodyBytes,
                                   " bytes, which hold all messages of a stream, too, and bytes "
                                   "as base64; a larger file is sent as it is, by PUT"));
    case HttpReadResult::kMalformed:
      return InvalidField("request", "has a body that is not as its headers say");
    case HttpReadResult::kTooSlow:
      return WithDetail(absl::DeadlineExceededError("the request's body came too slowly"),
                        {kBodyTooSlow, ""});
    case HttpReadResult::kNoRoom:
      return TooManyAtATime("large bodies");
    default:
      return absl::OkStatus();
  }
}

boost::asio::awaitable<void> WriteBodyFailure(HttpConnection& connection, HttpReadResult result) {
  const absl::Status failure = BodyFailure(result);
  if (failure.ok()) co_return;
  const int status =
      result == HttpReadResult::kTooSlow ? kRequestTimeout : HttpStatusOf(failure.code());
  co_await WriteErrorAs(status, connection, ToConnectError(failure), {}, false);
}

absl::StatusOr<RequestBody> RequestBody::Expect(const HttpConnection& connection,
                                                const HttpContext& context,
                                                const HttpRequest& request,
                                                const std::string& subject) {
  bool compressed = false;
  MORTISE_RETURN_IF_ERROR(ReadEncoding(request, compressed));
  RequestBody body(context.bodies, subject, compressed);
  // Of a body whose length is not told, room is taken once it is not small.
  const uint64_t bytes = connection.BodyBytes().value_or(0);
  if (bytes > kMaximalBodyBytes) return BodyFailure(HttpReadResult::kTooLarge);
  if (!body.HasRoom(bytes, bytes)) return TooManyAtATime("large bodies");
  return body;
}

bool RequestBody::HasRoom(std::size_t bytes, std::size_t wanted) {
  if (bytes <= kSmallBodyBytes || share_ != nullptr) return true;
  share_ = bodies_->Take(subject_, static_cast<int64_t>(wanted));
  return share_ != nullptr;
}

boost::asio::awaitable<HttpReadResult> RequestBody::Read(HttpConnection& connection,
                                                         HttpRequest& request) {
  const HttpConnection::HasRoom has_room = [this](std::size_t received) {
    return HasRoom(received, kMaximalBodyBytes);
  };
  co_return co_await connection.ReadBody(request, has_room);
}

absl::StatusOr<std::string> RequestBody::Take(HttpRequest& request) {
  std::string body = std::exchange(request.body(), std::string());
  if (!compressed_) return body;
  // A small body may become a large one: room for the largest that is expanded.
  const std::unique_ptr<Budget::Share> counted = std::move(share_);
  share_ = bodies_->Take(subject_, static_cast<int64_t>(kMaximalBodyBytes));
  if (share_ == nullptr) return TooManyAtATime("large bodies");
  MORTISE_ASSIGN_OR_RETURN(std::string expanded, ExpandGzip(std::move(body), kMaximalBodyBytes));
  if (expanded.size() <= kSmallBodyBytes) share_.reset();
  return expanded;
}

}  // namespace mortise::gateway
