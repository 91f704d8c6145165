// EventService over all services: the streams, and one stream out of many.
#include <algorithm>
#include <deque>
#include <map>
#include <set>

#include "common/base/errors.h"
#include "common/host/event_service.h"
#include "common/rpc/method_overrides.h"
#include "gateway/forwarding/event_codec.h"
#include "gateway/forwarding/event_hub.h"
#include "gateway/forwarding/hosted_services.h"
#include "mortise/v1/events.grpc.pb.h"

namespace mortise::gateway {
namespace {

constexpr int kBatch = 256;
// A follower of a service that cannot be reached looks again this often.
constexpr absl::Duration kRetry = absl::Seconds(1);

// One client that follows streams. Used by one thread at a time.
class Follower {
 public:
  Follower(EventHub* hub, const v1::FollowEventsRequest& asked,
           const std::map<std::string, int64_t>& positions)
      : hub_(hub), types_(asked.type_prefixes().begin(), asked.type_prefixes().end()) {
    const auto& named = asked.streams();
    std::vector<std::string> streams(named.begin(), named.end());
    if (streams.empty()) streams = hub->streams();
    for (const std::string& stream : streams) after_[stream] = asked.after_number();
    for (const auto& [stream, after] : positions) after_[stream] = after;
  }

  // The next event, or nothing if there is none now. `look_again` then tells after how long to ask
  // again without being told of new events: a stream could not be read, or is being searched.
  std::optional<v1::Event> Next(std::optional<absl::Duration>& look_again) {
    look_again.reset();
    if (ahead_.empty()) ReadAhead(look_again);
    if (ahead_.empty()) return std::nullopt;
    std::optional<v1::Event> event = ToProto(ahead_.front());
    ahead_.pop_front();
    return event;
  }

 private:
  void ReadAhead(std::optional<absl::Duration>& look_again) {
    for (auto& [stream, after] : after_) {
      // Only what comes from now on: from when the gateway first knows where the stream is.
      if (after < 0) after = hub_->Latest(stream).value_or(-1);
      if (after < 0) continue;
      const auto events = hub_->Read(stream, after, kBatch);
      if (!events.ok()) {
        look_again = kRetry;
        continue;
      }
      for (const bus::Event& event : *events) {
        after = event.number;
        if (Wants(event)) ahead_.push_back(event);
      }
      // A full batch without a wanted event: the search goes on, but others get their turn.
      if (ahead_.empty() && !events->empty()) look_again = absl::ZeroDuration();
    }
  }

  bool Wants(const bus::Event& event) const {
    if (types_.empty()) return true;
    for (const std::string& prefix : types_) {
      if (event.type.starts_with(prefix)) return true;
    }
    return false;
  }

  EventHub* const hub_;
  const std::vector<std::string> types_;
  std::map<std::string, int64_t> after_;
  std::deque<bus::Event> ahead_;
};

bool Knows(const EventHub& hub, const std::string& stream) {
  const auto& known = hub.streams();
  return std::find(known.begin(), known.end(), stream) != known.end();
}

absl::StatusOr<v1::ListStreamsResponse> ListStreams(const HostedEnvironment& environment,
                                                    const rpc::Call&,
                                                    const v1::ListStreamsRequest&) {
  EventHub& hub = *environment.hub;
  v1::ListStreamsResponse response;
  const std::set<std::string> names(hub.streams().begin(), hub.streams().end());
  for (const std::string& name : names) {
    auto& stream = *response.add_streams();
    stream.set_name(name);
    const int64_t latest = hub.Latest(name).value_or(0);
    stream.set_latest_number(latest);
    if (latest == 0) continue;
    const auto last = hub.Read(name, latest - 1, 1);
    if (last.ok() && !last->empty()) stream.set_epoch(last->back().epoch);
  }
  return response;
}

absl::Status FollowEvents(const HostedEnvironment& environment, const rpc::Call&,
                          const v1::FollowEventsRequest& asked,
                          const std::shared_ptr<rpc::StreamWriter<v1::Event>>& writer) {
  MORTISE_ASSIGN_OR_RETURN(const auto positions, rpc::FollowPositions(asked));
  MORTISE_RETURN_IF_ERROR(rpc::CheckTypePrefixes(asked.type_prefixes()));
  for (const std::string& stream : asked.streams()) {
    if (!Knows(*environment.hub, stream)) return NoSuchStream(stream);
  }
  for (const auto& [stream, after] : positions) {
    if (!Knows(*environment.hub, stream)) return NoSuchStream(stream);
  }
  const auto follower = std::make_shared<Follower>(environment.hub, asked, positions);
  const std::weak_ptr<rpc::StreamWriter<v1::Event>> weak = writer;
  writer->Pull([dispatcher = environment.dispatcher, follower,
                weak]() -> absl::StatusOr<std::optional<v1::Event>> {
    std::optional<absl::Duration> look_again;
    std::optional<v1::Event> event = follower->Next(look_again);
    if (!event && look_again) {
      dispatcher->SubmitAfter(
          *look_again,
          [weak] {
            if (const auto alive = weak.lock()) alive->Wake();
          },
          rpc::Lane::kStreams);
    }
    return event;
  });
  auto token = environment.hub->OnEvents([weak](const std::string&) {
    if (const auto alive = weak.lock()) alive->Wake();
  });
  // Held until the stream ends; and one look for what came before the hub began to tell.
  writer->OnEnd([token]() mutable { token.reset(); });
  writer->Wake();
  return absl::OkStatus();
}

class MergedEvents final : public v1::EventService::CallbackService {
  using Contract = v1::EventService::CallbackService;

 public:
  explicit MergedEvents(const HostedEnvironment& environment)
      : environment_(environment), endpoint_(environment.dispatcher, "mortise.v1.EventService") {}

  MORTISE_QUERY(ListStreams, rpc::With(environment_, gateway::ListStreams))
  MORTISE_SERVER_STREAM(FollowEvents, rpc::With(environment_, gateway::FollowEvents),
                        {.endless = true})

 private:
  const HostedEnvironment environment_;
  rpc::Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeMergedEventService(const HostedEnvironment& environment) {
  return std::make_shared<MergedEvents>(environment);
}

}  // namespace mortise::gateway
