#include "gateway/http/file_handler.h"

#include <google/protobuf/descriptor.h>
#include <grpcpp/support/status.h>

#include <algorithm>
#include <boost/asio/this_coro.hpp>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "gateway/contract/query_message.h"
#include "gateway/http/compression.h"
#include "gateway/http/connection_token_end.h"
#include "gateway/http/file_conditions.h"
#include "mortise/v1/types.pb.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
using boost::beast::http::verb;

constexpr int kOk = 200;
constexpr int kPartialContent = 206;
constexpr int kNotModified = 304;
constexpr int kRangeNotSatisfiable = 416;
constexpr unsigned kHttp11 = 11;  // as Beast counts versions

// What the first piece of a file and the request come to.
struct FileAnswer {
  int status = kOk;
  HeaderList headers;
  ByteRange range;  // what is sent; of a file whose length is not known, from 0 without end
  bool sized = true;
  bool compressed = false;
};

bool IsRead(const FileAnswer& answer) {
  return answer.status == kOk || answer.status == kPartialContent;
}

// Whether the service says how long the file is: one that is longer than that does not.
bool KnowsSize(const v1::Chunk& first) {
  return first.total_size() >= static_cast<int64_t>(first.data().size());
}

// Digests are hexadecimal; anything else is no tag that could be compared.
std::string TagOf(const v1::Chunk& first, bool compressed) {
  const std::string& digest = first.sha256();
  const bool plain = std::all_of(digest.begin(), digest.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
  });
  if (digest.empty() || !plain) return {};
  return absl::StrCat("\"", digest, compressed ? "-gzip\"" : "\"");
}

// HEAD tells of the file as it is.
bool IsToBeCompressed(const v1::Chunk& first, const HttpRequest& request) {
  return request.method() == verb::get && request.version() >= kHttp11 &&
         HeaderOf(request, "range").empty() &&
         first.total_size() > static_cast<int64_t>(kSmallestCompressed) &&
         IsCompressible(first.media_type()) && AcceptsGzip(HeaderOf(request, "accept-encoding"));
}

// Ranges are of the file as it is, never of a compressed one.
void ChooseBytes(const v1::Chunk& first, const HttpRequest& request, FileAnswer& answer) {
  answer.sized = KnowsSize(first);
  if (!answer.sized) {
    answer.range = {0, INT64_MAX - 1};
    return;
  }
  const int64_t size = first.total_size();
  answer.range = {0, size - 1};
  answer.headers.emplace_back("accept-ranges", "bytes");
  const std::string tag = TagOf(first, false);
  const std::string_view range = HeaderOf(request, "range");
  if (range.empty() || request.method() != verb::get ||
      !AllowsRange(HeaderOf(request, "if-range"), tag)) {
    return;
  }
  const RangeChoice choice = ChooseRange(range, size);
  if (!choice.satisfiable) {
    answer.status = kRangeNotSatisfiable;
    answer.headers.emplace_back("content-range", absl::StrCat("bytes */", size));
  } else if (choice.range) {
    answer.status = kPartialContent;
    answer.range = *choice.range;
    answer.headers.emplace_back("content-range", absl::StrCat("bytes ", answer.range.first, "-",
                                                              answer.range.last, "/", size));
  }
}

FileAnswer PlanAnswer(const v1::Chunk& first, const HttpRequest& request) {
  FileAnswer answer;
  answer.compressed = KnowsSize(first) && IsToBeCompressed(first, request);
  // Who shares a cache has other tokens; and whoever has a file asks whether it still is that.
  answer.headers = {{"cache-control", "private, no-cache"}, {"vary", "Accept-Encoding"}};
  const std::string tag = TagOf(first, answer.compressed);
  if (!tag.empty()) answer.headers.emplace_back("etag", tag);
  const std::string_view known = HeaderOf(request, "if-none-match");
  if (!tag.empty() && NamesTag(known, tag)) {
    answer.status = kNotModified;
    return answer;
  }
  ChooseBytes(first, request, answer);
  if (!IsRead(answer)) return answer;
  answer.headers.emplace_back("content-type", SafeMediaType(first.media_type()));
  answer.headers.emplace_back("content-disposition", AttachmentNamed(first.file_name()));
  // A file that is a page must not speak for this gateway in a browser.
  answer.headers.emplace_back("x-content-type-options", "nosniff");
  answer.headers.emplace_back("content-security-policy", "sandbox");
  if (answer.compressed) answer.headers.emplace_back("content-encoding", "gzip");
  return answer;
}

// Sends the wanted bytes of the pieces that come, compressed or as they are.
class FileSender {
 public:
  FileSender(HttpConnection& connection, const FileAnswer& answer)
      : connection_(connection),
        range_(answer.range),
        chunked_(!answer.sized || answer.compressed) {
    if (answer.compressed) gzip_ = std::make_unique<GzipWriter>();
  }

  // Whether all has been sent.
  bool done() const { return position_ > range_.last; }

  // False if the client is gone.
  asio::awaitable<bool> Send(const std::string& data) {
    const int64_t begin = std::clamp<int64_t>(range_.first - position_, 0, Size(data));
    const int64_t end = std::clamp<int64_t>(range_.last + 1 - position_, begin, Size(data));
    position_ += Size(data);
    const auto wanted = std::string_view(data).substr(static_cast<std::size_t>(begin),
                                                      static_cast<std::size_t>(end - begin));
    co_return co_await Put(wanted, false);
  }

  asio::awaitable<bool> End() {
    // Each wait stands by itself: g++ 12 makes a trap of one that is made or not within a term.
    if (gzip_ != nullptr) {
      const bool put = co_await Put({}, true);
      if (!put) co_return false;
    }
    if (!chunked_) co_return true;
    const bool ended = co_await connection_.EndChunks();
    co_return ended;
  }

 private:
  static int64_t Size(const std::string& data) { return static_cast<int64_t>(data.size()); }

  asio::awaitable<bool> Put(std::string_view bytes, bool end) {
    if (gzip_ == nullptr) co_return co_await PutPlain(bytes);
    const std::string compressed = gzip_->Add(bytes, end);
    co_return co_await PutPlain(compressed);
  }

  asio::awaitable<bool> PutPlain(std::string_view bytes) {
    if (bytes.empty()) co_return true;  // which would end an answer in chunks
    if (chunked_) co_return co_await connection_.WriteChunk(bytes);
    co_return co_await connection_.WriteBytes(bytes);
  }

  HttpConnection& connection_;
  const ByteRange range_;
  const bool chunked_;
  std::unique_ptr<GzipWriter> gzip_;
  int64_t position_ = 0;  // of the file, behind what has come
};

// False if the answer did not come to its end.
asio::awaitable<bool> SendFile(HttpConnection& connection, ClientCall& call, v1::Chunk chunk,
                               const FileAnswer& answer) {
  FileSender sender(connection, answer);
  for (;;) {
    if (!co_await sender.Send(chunk.data())) co_return false;
    // The rest behind a range is not waited for.
    if (answer.status == kPartialContent && sender.done()) break;
    const std::optional<std::string> message = co_await call.Read();
    if (!message) {
      const bool whole = call.status().ok() && (sender.done() || !answer.sized);
      if (!whole) co_return false;
      break;
    }
    if (!chunk.ParseFromString(*message)) co_return false;
  }
  co_return co_await sender.End();
}

asio::awaitable<bool> AnswerFile(HttpConnection& connection, const HttpRequest& request,
                                 ClientCall& call, v1::Chunk first) {
  const bool keep_alive = request.keep_alive();
  const FileAnswer answer = PlanAnswer(first, request);
  if (answer.status == kRangeNotSatisfiable) {
    const ConnectError error = {
        absl::StatusCode::kOutOfRange,
        absl::StrCat("the file has ", first.total_size(), " bytes, and none of the range"),
        {}};
    co_return co_await WriteErrorAs(kRangeNotSatisfiable, connection, error, answer.headers,
                                    keep_alive);
  }
  if (answer.status == kNotModified) {
    co_return co_await connection.Write(kNotModified, answer.headers, "", keep_alive);
  }
  const bool chunked = !answer.sized || answer.compressed;
  bool begun = false;
  if (chunked) {
    begun = co_await connection.BeginChunks(answer.status, answer.headers, keep_alive);
  } else {
    begun = co_await connection.BeginBytes(answer.status, answer.headers, answer.range.size(),
                                           keep_alive);
  }
  if (!begun || request.method() == verb::head) co_return begun;
  co_return co_await SendFile(connection, call, std::move(first), answer);
}

// A call that may be made, and what it takes of what there is for all.
struct FileCall {
  std::shared_ptr<const Caller> caller;
  std::unique_ptr<Budget::Share> answer;
  std::string request;  // serialised
};

absl::StatusOr<FileCall> PrepareCall(const HttpContext& context, const MethodRoute& method,
                                     const Target& target, const HttpRequest& request) {
  FileCall call;
  MORTISE_ASSIGN_OR_RETURN(call.caller, CallerOf(context, request));
  MORTISE_RETURN_IF_ERROR(context.admission->Authorize(method, *call.caller));
  const auto& type = *method.descriptor->input_type();
  MORTISE_ASSIGN_OR_RETURN(const std::string json, JsonOfQuery(type, target.parameters));
  MORTISE_ASSIGN_OR_RETURN(call.request, context.transcoder->ToBinary(type, json));
  call.answer = context.answers->Take(call.caller->subject, 1);
  if (call.answer == nullptr) return TooManyAtATime("streams and waiting calls over HTTP");
  return call;
}

}  // namespace

asio::awaitable<bool> HandleFile(HttpConnection& connection, const HttpContext& context,
                                 const MethodRoute& method, const Target& target,
                                 const HttpRequest& request) {
  const bool keep_alive = request.keep_alive();
  const auto prepared = PrepareCall(context, method, target, request);
  if (!prepared.ok()) {
    co_return co_await WriteError(connection, ToConnectError(prepared.status()), {}, keep_alive) &&
        keep_alive;
  }
  const ConnectionTokenEnd token_end(co_await asio::this_coro::executor, connection,
                                     *prepared->caller);
  const auto call = ClientCall::StartStreaming(
      *context.stub, {method.path, MetadataOf(request), std::nullopt}, {prepared->request});
  connection.WatchForLeaving([call] { call->Cancel(); });
  const std::optional<std::string> message = co_await call->Read();
  connection.EndWatch();
  v1::Chunk first;
  if (!message || !first.ParseFromString(*message)) {
    const auto error = ToConnectError(call->status());
    const absl::Status none = absl::InternalError("the service sent no file");
    co_return co_await WriteError(connection, error.value_or(ToConnectError(none)), {},
                                  keep_alive) &&
        keep_alive;
  }
  co_return co_await AnswerFile(connection, request, *call, std::move(first)) && keep_alive;
}

}  // namespace mortise::gateway
