#include "gateway/http/sse_handler.h"

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
#include "gateway/forwarding/event_hub.h"
#include "gateway/http/connection_token_end.h"
#include "mortise/v1/events.pb.h"
#include "mortise/v1/operations.pb.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::seconds kHeartbeat(15);
constexpr std::size_t kMaximalWaitingMessages = 64;
constexpr char kGateway[] = "gateway";  // the service that brings all events together
constexpr char kListStreams[] = "/mortise.v1.EventService/ListStreams";
constexpr char kFollowEvents[] = "/mortise.v1.EventService/FollowEvents";
constexpr char kWatchOperation[] = "/mortise.v1.OperationService/WatchOperation";

// Messages of a call, for a coroutine that also wants to know when nothing comes. All on the
// connection's strand.
class Feed : public std::enable_shared_from_this<Feed> {
 public:
  explicit Feed(asio::any_io_executor executor)
      : executor_(executor), arrived_(executor), room_(executor) {}

  void Begin(std::shared_ptr<ClientCall> call) {
    call_ = call;
    reading_ = true;
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

  // No more messages will come.
  bool ended() const { return messages_.empty() && !reading_; }
  const std::optional<ConnectError>& error() const { return error_; }

  void Cancel() {
    cancelled_ = true;
    if (call_) call_->Cancel();
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
    reading_ = false;
    error_ = ToConnectError(call->status());
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
  std::shared_ptr<ClientCall> call_;
  std::deque<std::string> messages_;
  std::optional<ConnectError> error_;
  bool reading_ = false;
  bool cancelled_ = false;
};

// Sends what the feed brings until it ends or the client leaves; `format` makes a message an event.
template <class Format>
asio::awaitable<void> SendFeed(HttpConnection& connection, const Caller& caller,
                               const std::shared_ptr<Feed>& feed, const Format& format) {
  const ConnectionTokenEnd token_end(co_await asio::this_coro::executor, connection, caller);
  connection.WatchForLeaving([feed] { feed->Cancel(); });
  const HeaderList headers = {{"content-type", "text/event-stream"},
                              {"cache-control", "no-cache"},
                              {"x-accel-buffering", "no"}};
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

// What a stream takes of what there is for all. It is counted here and not where the call begins,
// because what is counted here is not answered with 200 first.
struct Places {
  std::shared_ptr<const Caller> caller;
  std::unique_ptr<OpenCalls::Place> call;
  std::unique_ptr<Budget::Share> answer;
};

// For a caller who may have the stream of a method, which comes from `service`.
absl::StatusOr<Places> Admit(const HttpContext& context, const char* path,
                             const std::string& service, const HttpRequest& request) {
  Places places;
  MORTISE_ASSIGN_OR_RETURN(places.caller, CallerOf(context, request));
  const Caller& caller = *places.caller;
  MORTISE_RETURN_IF_ERROR(context.admission->Authorize(*context.contract->Find(path), caller));
  MORTISE_ASSIGN_OR_RETURN(places.call,
                           context.open_calls->Enter(CallKind::kStream, caller.subject));
  MORTISE_RETURN_IF_ERROR(places.call->EnterService(service));
  places.answer = context.answers->Take(caller.subject, 1);
  if (places.answer == nullptr) return TooManyAtATime("streams and waiting calls over HTTP");
  return places;
}

// The metadata of a call that has its place.
HeaderList Counted(const HttpContext& context, HeaderList metadata) {
  metadata.emplace_back(kCountedMetadata, context.open_calls->pass());
  return metadata;
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
  const auto places = Admit(context, kFollowEvents, kGateway, request);
  const auto query = ReadEventsQuery(target, request);
  const absl::Status status = places.ok() ? query.status() : places.status();
  if (!status.ok()) co_return co_await WriteError(connection, ToConnectError(status), {}, true);

  const auto listing =
      ClientCall::StartUnary(*context.stub, {kListStreams, metadata, std::nullopt}, "");
  const std::optional<std::string> listed = co_await listing->Read();
  if (!listed) {
    co_return co_await WriteError(connection, *ToConnectError(listing->status()), {}, true);
  }
  v1::ListStreamsResponse streams;
  streams.ParseFromString(*listed);
  auto first = FirstPosition(*query, streams);
  if (!first.ok()) {
    co_return co_await WriteError(connection, ToConnectError(first.status()), {}, true);
  }
  EventPosition position = *std::move(first);

  v1::FollowEventsRequest follow;
  for (const auto& [stream, after] : position) {
    follow.add_streams(stream);
    v1::EventPosition& begin = *follow.add_positions();
    begin.set_stream(stream);
    begin.set_after_number(after);
  }
  for (const std::string& type : query->types) follow.add_type_prefixes(type);
  const auto feed = std::make_shared<Feed>(co_await asio::this_coro::executor);
  feed->Begin(ClientCall::StartStreaming(*context.stub,
                                         {kFollowEvents, Counted(context, metadata), std::nullopt},
                                         {follow.SerializeAsString()}));
  const auto& type = *context.contract->Find(kFollowEvents)->descriptor->output_type();
  co_await SendFeed(connection, *places->caller, feed, [&](const std::string& message) {
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
  const auto places =
      Admit(context, kWatchOperation, std::string(ServiceOfOperation(operation)), request);
  if (!places.ok()) {
    co_return co_await WriteError(connection, ToConnectError(places.status()), {}, true);
  }
  v1::WatchOperationRequest watch;
  watch.set_name(operation);
  const auto call = ClientCall::StartStreaming(
      *context.stub, {kWatchOperation, Counted(context, MetadataOf(request)), std::nullopt},
      {watch.SerializeAsString()});
  // The first state comes at once, or a failure that deserves an HTTP status.
  const std::optional<std::string> now = co_await call->Read();
  if (!now) {
    const auto error = ToConnectError(call->status());
    co_return co_await WriteError(
        connection, error.value_or(ToConnectError(ResourceNotFound(operation))), {}, true);
  }
  const auto& type = *context.contract->Find(kWatchOperation)->descriptor->output_type();
  const auto format = [&](const std::string& message) {
    return absl::StrCat("event: operation\ndata: ",
                        context.transcoder->ToJson(type, message).value_or("{}"), "\n\n");
  };
  const auto feed = std::make_shared<Feed>(co_await asio::this_coro::executor);
  feed->Put(*now);
  feed->Begin(call);
  co_await SendFeed(connection, *places->caller, feed, format);
  co_return false;
}

}  // namespace mortise::gateway
