#include "common/host/event_service.h"

#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <deque>
#include <map>
#include <mutex>
#include <vector>

#include "absl/strings/match.h"
#include "common/base/errors.h"
#include "common/resources/page_rule.h"
#include "common/rpc/method_overrides.h"
#include "common/store/store.h"
#include "mortise/v1/events.grpc.pb.h"

namespace mortise::rpc {
namespace {

constexpr int kMaxTypes = 100;
constexpr std::size_t kMaxTypeBytes = 256;
constexpr int kMaxPositions = 64;
constexpr int kDefaultLimit = 1000;
constexpr int kMaxLimit = 10000;
constexpr int kFollowBatch = 500;
// How soon a follower sees events that another replica numbered.
constexpr absl::Duration kPollInterval = absl::Seconds(1);

class Signal : public EventSignal {
 public:
  void Notify() override {
    std::lock_guard lock(state_->mutex);
    for (const auto& [id, callback] : state_->callbacks) callback();
  }

  std::shared_ptr<void> Subscribe(std::function<void()> callback) override {
    std::lock_guard lock(state_->mutex);
    const int64_t id = ++state_->last;
    state_->callbacks[id] = std::move(callback);
    return std::shared_ptr<void>(nullptr, [state = state_, id](void*) {
      std::function<void()> dropped;
      std::lock_guard end_lock(state->mutex);
      dropped = std::move(state->callbacks[id]);
      state->callbacks.erase(id);
    });
  }

 private:
  struct State {
    std::mutex mutex;
    int64_t last = 0;                                    // guarded by mutex
    std::map<int64_t, std::function<void()>> callbacks;  // guarded by mutex
  };
  const std::shared_ptr<State> state_ = std::make_shared<State>();
};

v1::Event EventProto(const store::NumberedEvent& event, const std::string& stream) {
  v1::Event proto;
  proto.set_stream(stream);
  proto.set_epoch(event.epoch);
  proto.set_number(event.number);
  proto.set_type(event.type);
  proto.set_subject(event.subject);
  *proto.mutable_time() =
      google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(event.time));
  proto.set_trace_id(event.trace_id);
  proto.set_data(event.payload);
  return proto;
}

// Where a follower is. Used by one thread at a time.
struct Follower {
  int64_t after_number = 0;
  std::vector<std::string> type_prefixes;
  std::deque<v1::Event> ahead;

  bool Wants(const store::NumberedEvent& event) const {
    if (type_prefixes.empty()) return true;
    for (const std::string& prefix : type_prefixes) {
      if (absl::StartsWith(event.type, prefix)) return true;
    }
    return false;
  }
};

using EventWriter = std::shared_ptr<StreamWriter<v1::Event>>;

// Wakes the writer again and again, until its stream has ended.
void WakeRepeatedly(Dispatcher* dispatcher, const std::weak_ptr<StreamWriter<v1::Event>>& writer) {
  dispatcher->SubmitAfter(
      kPollInterval,
      [dispatcher, writer] {
        const EventWriter alive = writer.lock();
        if (!alive) return;
        alive->Wake();
        WakeRepeatedly(dispatcher, writer);
      },
      Lane::kStreams);
}

// The stream of one service, and what the methods stand on to show it.
struct EventSource {
  Dispatcher* dispatcher;
  store::Store* store;
  std::string stream;
  std::shared_ptr<EventSignal> signal;  // null if nobody tells of new events
};

absl::StatusOr<v1::ListStreamsResponse> ListStreams(const EventSource& source, const Call&,
                                                    const v1::ListStreamsRequest&) {
  v1::ListStreamsResponse response;
  auto* stream = response.add_streams();
  stream->set_name(source.stream);
  MORTISE_RETURN_IF_ERROR(source.store->Read([&](store::ReadTransaction& read) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(const int64_t number, read.LatestEventNumber());
    MORTISE_ASSIGN_OR_RETURN(const int64_t epoch, read.Epoch());
    stream->set_latest_number(number);
    stream->set_epoch(epoch);
    return absl::OkStatus();
  }));
  return response;
}

absl::Status CheckStream(const EventSource& source, const std::string& stream, const char* field) {
  if (stream == source.stream) return absl::OkStatus();
  return InvalidField(field, "this service has only the stream '" + source.stream + "'");
}

absl::StatusOr<v1::ReadEventsResponse> ReadEvents(const EventSource& source, const Call&,
                                                  const v1::ReadEventsRequest& asked) {
  MORTISE_RETURN_IF_ERROR(CheckStream(source, asked.stream(), "stream"));
  if (asked.after_number() < 0) return InvalidField("after_number", "must be at least 0");
  if (asked.limit() < 0 || asked.limit() > kMaxLimit) {
    return InvalidField("limit", "must be 0 to 10000");
  }
  const int limit = asked.limit() == 0 ? kDefaultLimit : asked.limit();
  v1::ReadEventsResponse response;
  MORTISE_RETURN_IF_ERROR(source.store->Read([&](store::ReadTransaction& read) -> absl::Status {
    response.Clear();
    resources::PageRoom room(limit);
    MORTISE_ASSIGN_OR_RETURN(const int64_t latest, read.LatestEventNumber());
    response.set_latest_number(latest);
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::NumberedEvent> events,
                             read.ReadEvents(asked.after_number(), limit));
    for (const store::NumberedEvent& event : events) {
      v1::Event proto = EventProto(event, source.stream);
      if (!room.Take(proto.ByteSizeLong())) break;
      *response.add_events() = std::move(proto);
    }
    return absl::OkStatus();
  }));
  return response;
}

// The next event that the follower wants; nothing if there is none yet.
absl::StatusOr<std::optional<v1::Event>> NextEvent(const EventSource& source, Follower& follower) {
  while (follower.ahead.empty()) {
    std::vector<store::NumberedEvent> events;
    MORTISE_RETURN_IF_ERROR(source.store->Read([&](store::ReadTransaction& read) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(events, read.ReadEvents(follower.after_number, kFollowBatch));
      return absl::OkStatus();
    }));
    if (events.empty()) return std::optional<v1::Event>();
    follower.after_number = events.back().number;
    for (const store::NumberedEvent& event : events) {
      if (follower.Wants(event)) follower.ahead.push_back(EventProto(event, source.stream));
    }
  }
  std::optional<v1::Event> next = std::move(follower.ahead.front());
  follower.ahead.pop_front();
  return next;
}

// Where a request to follow begins. INVALID_ARGUMENT naming the field at fault.
absl::StatusOr<std::shared_ptr<Follower>> FollowerOf(const EventSource& source,
                                                     const v1::FollowEventsRequest& asked) {
  for (int i = 0; i < asked.streams_size(); ++i) {
    MORTISE_RETURN_IF_ERROR(
        CheckStream(source, asked.streams(i), ("streams[" + std::to_string(i) + "]").c_str()));
  }
  MORTISE_ASSIGN_OR_RETURN(const auto positions, FollowPositions(asked));
  for (const auto& [stream, after] : positions) {
    MORTISE_RETURN_IF_ERROR(CheckStream(source, stream, "positions"));
  }
  MORTISE_RETURN_IF_ERROR(CheckTypePrefixes(asked.type_prefixes()));
  auto follower = std::make_shared<Follower>();
  follower->after_number = positions.empty() ? asked.after_number() : positions.begin()->second;
  follower->type_prefixes.assign(asked.type_prefixes().begin(), asked.type_prefixes().end());
  if (follower->after_number != -1) return follower;
  MORTISE_RETURN_IF_ERROR(source.store->Read([&](store::ReadTransaction& read) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(follower->after_number, read.LatestEventNumber());
    return absl::OkStatus();
  }));
  return follower;
}

absl::Status FollowEvents(const EventSource& source, const Call&,
                          const v1::FollowEventsRequest& asked, const EventWriter& writer) {
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<Follower> follower, FollowerOf(source, asked));
  std::weak_ptr<StreamWriter<v1::Event>> weak = writer;
  if (source.signal) {
    std::shared_ptr<void> subscription = source.signal->Subscribe([weak] {
      if (const EventWriter alive = weak.lock()) alive->Wake();
    });
    writer->OnEnd([subscription] {});  // keeps it until then
  }
  writer->Pull([&source, follower] { return NextEvent(source, *follower); });
  WakeRepeatedly(source.dispatcher, weak);
  return absl::OkStatus();
}

class EventAdapter final : public v1::EventService::CallbackService {
  using Contract = v1::EventService::CallbackService;

 public:
  explicit EventAdapter(EventSource source)
      : source_(std::move(source)), endpoint_(source_.dispatcher, "mortise.v1.EventService") {}

  MORTISE_QUERY(ListStreams, With(source_, rpc::ListStreams))
  MORTISE_QUERY(ReadEvents, With(source_, rpc::ReadEvents))
  MORTISE_SERVER_STREAM(FollowEvents, With(source_, rpc::FollowEvents), {.endless = true})

 private:
  const EventSource source_;
  Endpoint endpoint_;
};

}  // namespace

absl::Status CheckTypePrefixes(const google::protobuf::RepeatedPtrField<std::string>& prefixes) {
  if (prefixes.size() > kMaxTypes) {
    return InvalidField("type_prefixes", "has more than 100 entries");
  }
  for (int i = 0; i < prefixes.size(); ++i) {
    if (prefixes[i].size() > kMaxTypeBytes) {
      return InvalidField("type_prefixes[" + std::to_string(i) + "]", "has more than 256 bytes");
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::map<std::string, int64_t>> FollowPositions(
    const v1::FollowEventsRequest& asked) {
  if (asked.after_number() < -1) return InvalidField("after_number", "must be at least -1");
  if (asked.positions_size() > kMaxPositions) {
    return InvalidField("positions", "has more than 64 entries");
  }
  std::map<std::string, int64_t> positions;
  for (int i = 0; i < asked.positions_size(); ++i) {
    const v1::EventPosition& position = asked.positions(i);
    const std::string where = "positions[" + std::to_string(i) + "]";
    if (position.after_number() < -1) {
      return InvalidField(where + ".after_number", "must be at least -1");
    }
    const auto& streams = asked.streams();
    if (!streams.empty() &&
        std::find(streams.begin(), streams.end(), position.stream()) == streams.end()) {
      return InvalidField(where + ".stream", "is not one of the streams followed");
    }
    if (!positions.emplace(position.stream(), position.after_number()).second) {
      return InvalidField(where + ".stream", "is there twice");
    }
  }
  return positions;
}

std::shared_ptr<EventSignal> EventSignal::Create() { return std::make_shared<Signal>(); }

std::shared_ptr<grpc::Service> MakeEventService(Dispatcher* dispatcher, store::Store* store,
                                                const std::string& stream,
                                                std::shared_ptr<EventSignal> signal) {
  return std::make_shared<EventAdapter>(EventSource{dispatcher, store, stream, std::move(signal)});
}

}  // namespace mortise::rpc
