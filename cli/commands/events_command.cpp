// mortise events: what happened, in order, and what happens now.
#include <google/protobuf/util/time_util.h>
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/client/command_flags.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/events.grpc.pb.h"

namespace mortise::cli {
namespace {

struct EventsOptions {
  bool follow = false;
  std::int64_t since = 0;
  std::int64_t limit = 0;
  std::vector<std::string> streams;
  std::vector<std::string> types;
};

std::string EventLine(const v1::Event& event) {
  return absl::StrFormat("%s  %s:%d  %s  %s  %s",
                         google::protobuf::util::TimeUtil::ToString(event.time()), event.stream(),
                         event.number(), event.type(), event.subject(), event.data());
}

absl::Status ReadStream(const EventsOptions& options, v1::EventService::Stub& stub,
                        const GatewayClient& client, const std::string& stream,
                        nlohmann::ordered_json& document, const Output& output) {
  std::int64_t after = options.since;
  while (true) {
    v1::ReadEventsRequest request;
    request.set_stream(stream);
    request.set_after_number(after);
    v1::ReadEventsResponse response;
    MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
      return rpc::FromGrpc(stub.ReadEvents(&context, request, &response));
    }));
    for (const v1::Event& event : response.events()) {
      after = event.number();
      const bool wanted =
          options.types.empty() ||
          std::any_of(options.types.begin(), options.types.end(), [&](const std::string& prefix) {
            return event.type().compare(0, prefix.size(), prefix) == 0;
          });
      if (!wanted) continue;
      output.Line(EventLine(event));
      if (!output.text()) document.push_back(ToJson(event));
    }
    if (response.events().empty() || after >= response.latest_number()) return absl::OkStatus();
  }
}

absl::Status Follow(const EventsOptions& options, v1::EventService::Stub& stub,
                    const GatewayClient& client, Output& output) {
  v1::FollowEventsRequest request;
  for (const std::string& stream : options.streams) request.add_streams(stream);
  for (const std::string& type : options.types) request.add_type_prefixes(type);
  request.set_after_number(options.since);
  grpc::ClientContext context;
  client.Prepare(context, 0);
  const auto reader = stub.FollowEvents(&context, request);
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  v1::Event event;
  std::int64_t count = 0;
  while (reader->Read(&event)) {
    output.Line(EventLine(event));
    if (!output.text()) document.push_back(ToJson(event));
    if (options.limit > 0 && ++count >= options.limit) {
      context.TryCancel();
      output.Document(document);
      return absl::OkStatus();
    }
  }
  return rpc::FromGrpc(reader->Finish());
}

absl::Status Events(const EventsOptions& options, Session& session, Output& output) {
  if (output.json() && options.follow && options.limit == 0) {
    return InvalidField("--follow", "has no end, and --json prints one document; add --limit N");
  }
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::EventService::NewStub(client->channel());
  if (options.follow) return Follow(options, *stub, *client, output);
  std::vector<std::string> streams = options.streams;
  if (streams.empty()) {
    v1::ListStreamsResponse response;
    MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
      return rpc::FromGrpc(stub->ListStreams(&context, {}, &response));
    }));
    for (const auto& stream : response.streams()) streams.push_back(stream.name());
  }
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  for (const std::string& stream : streams) {
    MORTISE_RETURN_IF_ERROR(ReadStream(options, *stub, *client, stream, document, output));
  }
  output.Document(document);
  return absl::OkStatus();
}

}  // namespace

void AddEventsCommand(CLI::App& app, Session& session) {
  auto options = std::make_shared<EventsOptions>();
  CommandFlags flags(
      *app.add_subcommand("events", "What happened, in order, and what happens now"));
  flags.command().add_flag("--follow", options->follow, "Go on with what happens from now on");
  flags.Add("--since", options->since, "Begin after this number in each stream", "after_number")
      ->capture_default_str();
  flags.Add("--limit", options->limit, "With --follow: end after so many events");
  flags.Add("--stream", options->streams, "Only these streams");
  flags.AlsoGives("--stream", "stream");  // one call for each
  flags.Add("--type", options->types, "Only types that begin with one of these", "type_prefixes");
  flags.command().footer("Example: mortise events --follow --since 0 --type cut.");
  flags.Run(session, [options](Session& s, Output& o) { return Events(*options, s, o); });
}

}  // namespace mortise::cli
