#include "gateway/sse_handler.h"

#include <google/protobuf/descriptor.h>
#include <grpcpp/support/status.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <deque>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "gateway/event_hub.h"
#include "mortise/v1/events.pb.h"
#include "mortise/v1/operations.pb.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::seconds kHeartbeat(15);
constexpr std::size_t kMaximalWaitingMessages = 64;
constexpr char kListStreams[] = "/mortise.v1.EventService/ListStreams";
constexpr char kFollowEvents[] = "/mortise.v1.EventService/FollowEvents";
constexpr char kWatchOperation[] = "/mortise.v1.OperationService/WatchOperation";

// Messages of several calls, for one coroutine that also wants to know when nothing comes. All on
// the connection's strand.
class Feed : public std::enable_shared_from_this<Feed> {
 public:
  explicit Feed(asio::any_io_executor executor)
      : executor_(executor), arrived_(executor), room_(executor) {}

  void Add(std::shared_ptr<ClientCall> call) {
    calls_.push_back(call);
    ++reading_;
    auto self = shared_from_this();
    asio::co_spawn(
        executor_, [self, call]() { return self->ReadAll(call); }, asio::detached);
  }

  void Put(std::string message) { messages_.push_back(std::move(message)); }

  // The next message, or nothing when a heartbeat is due or all has ended.
  asio::awaitable<std::optional<std::string>> Next() {
    if (messages_.empty() && !ended()) co_await Wait(arrived_, kHeartbeat);
    if (messages_.empty()) co_return std::nullopt;
    std::string message = std::move(messages_.front());
    messages_.pop_front();
    room_.cancel();
    co_return message;
  }

  // No more messages will come: every call has ended, or one of them failed.
  bool ended() const { return messages_.empty() && (reading_ == 0 || error_.has_value()); }
  const std::optional<ConnectError>& error() const { return error_; }

  void Cancel() {
    cancelled_ = true;
    for (const auto& call : calls_) call->Cancel();
    arrived_.cancel();
    room_.cancel();
  }

 private:
  asio::awaitable<void> ReadAll(std::shared_ptr<ClientCall> call) {
    while (std::optional<std::string> message = co_await call->Read()) {
      messages_.push_back(*std::move(message));
      arrived_.cancel();
      while (messages_.size() >= kMaximalWaitingMessages && !cancelled_) {
        co_await Wait(room_, std::chrono::hours(24));
      }
    }
    --reading_;
    if (!error_) error_ = ToConnectError(call->status());
    arrived_.cancel();
  }

  static asio::awaitable<void> Wait(asio::steady_timer& timer, std::chrono::seconds time) {
    boost::system::error_code ignored;
    timer.expires_after(time);
    co_await timer.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
  }

  asio::any_io_executor executor_;
  asio::steady_timer arrived_;
  asio::steady_timer room_;
  std::vector<std::shared_ptr<ClientCall>> calls_;
  std::deque<std::string> messages_;
  std::optional<ConnectError> error_;
  int reading_ = 0;
  bool cancelled_ = false;
};

// Sends what the feed brings until it ends or the client leaves; `format` makes a message an event.
template <class Format>
asio::awaitable<void> SendFeed(HttpConnection& connection, const std::shared_ptr<Feed>& feed,
                               const std::string& request_id, const Format& format) {
  connection.WatchForLeaving([feed] { feed->Cancel(); });
  const HeaderList headers = {{"content-type", "text/event-stream"},
                              {"cache-control", "no-cache"},
                              {"x-accel-buffering", "no"},
                              {"x-request-id", request_id}};
  bool listening = co_await connection.BeginChunks(200, headers, false);
  // A first comment tells clients, and proxies that wait for a byte, that the stream is open.
  if (listening) listening = co_await connection.WriteChunk(": open\n\n");
  while (listening && !feed->ended()) {
    const std::optional<std::string> message = co_await feed->Next();
    if (message) {
      listening = co_await connection.WriteChunk(format(*message));
    } else if (!feed->ended()) {
      listening = co_await connection.WriteChunk(": still here\n\n");
    }
  }
  connection.EndWatch();
  feed->Cancel();
  if (!listening) co_return;
  if (feed->error()) {
    co_await connection.WriteChunk(
        absl::StrCat("event: error\ndata: ", ErrorJson(*feed->error()), "\n\n"));
  }
  co_await connection.EndChunks();
}

absl::Status Admit(const HttpContext& context, const char* path, const HttpRequest& request) {
  MORTISE_ASSIGN_OR_RETURN(const auto caller,
                           context.admission->Authenticate(HeaderOf(request, "authorization")));
  return context.admission->Authorize(*context.contract->Find(path), *caller);
}

// What a client asks of /events.
struct EventsQuery {
  std::vector<std::string> streams;
  std::vector<std::string> types;
  int64_t after = -1;
  std::optional<EventPosition> position;
};

absl::StatusOr<EventsQuery> ReadEventsQuery(const Target& target, const HttpRequest& request) {
  EventsQuery query;
  for (const auto& [name, value] : target.parameters) {
    if (name == "streams") {
      query.streams = SplitList(value);
    } else if (name == "types") {
      query.types = SplitList(value);
    } else if (name == "after") {
      MORTISE_ASSIGN_OR_RETURN(query.after, ParseNumber(value, "after"));
    } else {
      return InvalidField(name, "the parameters are streams, types and after");
    }
  }
  if (const std::string_view id = HeaderOf(request, "last-event-id"); !id.empty()) {
    MORTISE_ASSIGN_OR_RETURN(query.position, ParsePosition(id));
  }
  return query;
}

// Where each stream that is followed begins.
absl::StatusOr<EventPosition> FirstPosition(const EventsQuery& query,
                                            const v1::ListStreamsResponse& streams) {
  EventPosition latest;
  for (const auto& stream : streams.streams()) latest[stream.name()] = stream.latest_number();
  EventPosition first;
  auto begin = [&](const std::string& stream) {
    if (query.position) {
      const auto found = query.position->find(stream);
      return found == query.position->end() ? 0 : found->second;
    }
    return query.after < 0 ? latest[stream] : query.after;
  };
  for (const auto& stream : query.streams) {
    if (latest.count(stream) == 0) return NoSuchStream(stream);
    first[stream] = begin(stream);
  }
  if (query.streams.empty()) {
    for (const auto& stream : streams.streams()) first[stream.name()] = begin(stream.name());
  }
  return first;
}

}  // namespace

asio::awaitable<bool> HandleEvents(HttpConnection& connection, const HttpContext& context,
                                   const Target& target, const HttpRequest& request) {
  const HeaderList metadata = MetadataOf(request);
  const HeaderList id = {metadata.front()};
  absl::Status status = Admit(context, kFollowEvents, request);
  const auto query = ReadEventsQuery(target, request);
  if (status.ok()) status = query.status();
  if (!status.ok()) co_return co_await WriteError(connection, ToConnectError(status), id, true);

  const auto listing =
      ClientCall::StartUnary(*context.stub, {kListStreams, metadata, std::nullopt}, "");
  const std::optional<std::string> listed = co_await listing->Read();
  if (!listed) {
    co_return co_await WriteError(connection, *ToConnectError(listing->status()), id, true);
  }
  v1::ListStreamsResponse streams;
  streams.ParseFromString(*listed);
  auto first = FirstPosition(*query, streams);
  if (!first.ok()) {
    co_return co_await WriteError(connection, ToConnectError(first.status()), id, true);
  }
  EventPosition position = *std::move(first);

  const auto feed = std::make_shared<Feed>(co_await asio::this_coro::executor);
  for (const auto& [stream, after] : position) {
    v1::FollowEventsRequest follow;
    follow.add_streams(stream);
    follow.set_after_number(after);
    for (const std::string& type : query->types) follow.add_type_prefixes(type);
    feed->Add(ClientCall::StartStreaming(*context.stub, {kFollowEvents, metadata, std::nullopt},
                                         {follow.SerializeAsString()}));
  }
  const auto& type = *context.contract->Find(kFollowEvents)->descriptor->output_type();
  co_await SendFeed(connection, feed, id.front().second, [&](const std::string& message) {
    v1::Event event;
    event.ParseFromString(message);
    position[event.stream()] = event.number();
    return absl::StrCat("id: ", FormatPosition(position), "\nevent: ", event.type(),
                        "\ndata: ", context.transcoder->ToJson(type, message).value_or("{}"),
                        "\n\n");
  });
  co_return false;
}

asio::awaitable<bool> HandleOperationWatch(HttpConnection& connection, const HttpContext& context,
                                           const std::string& operation,
                                           const HttpRequest& request) {
  const HeaderList metadata = MetadataOf(request);
  const HeaderList id = {metadata.front()};
  if (const absl::Status status = Admit(context, kWatchOperation, request); !status.ok()) {
    co_return co_await WriteError(connection, ToConnectError(status), id, true);
  }
  v1::WatchOperationRequest watch;
  watch.set_name(operation);
  const auto call = ClientCall::StartStreaming(
      *context.stub, {kWatchOperation, metadata, std::nullopt}, {watch.SerializeAsString()});
  // The first state comes at once, or a failure that deserves an HTTP status.
  const std::optional<std::string> now = co_await call->Read();
  if (!now) {
    const auto error = ToConnectError(call->status());
    co_return co_await WriteError(
        connection, error.value_or(ToConnectError(ResourceNotFound(operation))), id, true);
  }
  const auto& type = *context.contract->Find(kWatchOperation)->descriptor->output_type();
  const auto format = [&](const std::string& message) {
    return absl::StrCat("event: operation\ndata: ",
                        context.transcoder->ToJson(type, message).value_or("{}"), "\n\n");
  };
  const auto feed = std::make_shared<Feed>(co_await asio::this_coro::executor);
  feed->Put(*now);
  feed->Add(call);
  co_await SendFeed(connection, feed, id.front().second, format);
  co_return false;
}

}  // namespace mortise::gateway
