#include "cli/files/import_call.h"

#include <grpcpp/grpcpp.h>
#include <unistd.h>

#include <atomic>
#include <memory>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/client/ending_signals.h"
#include "common/base/errors.h"
#include "mortise/v1/events.grpc.pb.h"

namespace mortise::cli {
namespace {

// Shows what events say of one import, for as long as it lives. Where they cannot be followed
// nothing is shown, and the import goes on.
class ShownProgress {
 public:
  ShownProgress(const GatewayClient& client, std::string request_id, Output& output)
      : request_id_(std::move(request_id)), output_(output) {
    client.Prepare(context_, 0);
    thread_ =
        std::jthread([this, stub = v1::EventService::NewStub(client.channel())] { Follow(*stub); });
  }
  ~ShownProgress() {
    context_.TryCancel();
    thread_.join();
    output_.EndProgress();
  }
  ShownProgress(const ShownProgress&) = delete;
  ShownProgress& operator=(const ShownProgress&) = delete;

 private:
  void Follow(v1::EventService::Stub& stub) {
    v1::FollowEventsRequest request;
    request.add_streams("catalog");
    request.add_type_prefixes("assembly.importing");
    request.set_after_number(-1);
    const auto reader = stub.FollowEvents(&context_, request);
    v1::Event event;
    while (reader->Read(&event)) Show(event);
    reader->Finish();
  }

  void Show(const v1::Event& event) {
    const auto data = nlohmann::json::parse(event.data(), nullptr, false);
    if (!data.is_object() || data.value("request_id", "") != request_id_) return;
    output_.Progress(data.value("done", 0L), data.value("total", 0L), data.value("stage", ""));
  }

  const std::string request_id_;
  Output& output_;
  grpc::ClientContext context_;
  std::jthread thread_;
};

// What became of an import that a signal has cancelled.
std::string WhatBecame(const ImportCall& call) {
  const absl::StatusOr<std::int64_t> present = call.present();
  if (!present.ok()) {
    return absl::StrCat(
        "the import of ", call.name,
        " was cancelled; whether it is stored is not known: ", present.status().message());
  }
  if (*present == call.before) {
    return absl::StrCat("the import of ", call.name, " was cancelled; nothing of it is stored");
  }
  return absl::StrCat(call.name, " was stored as revision ", *present,
                      " before it could be cancelled");
}

}  // namespace

absl::Status MakeWatched(const ImportCall& call, const GatewayClient& client, Output& output) {
  std::stop_source stop;
  std::atomic<int> ended_by = 0;
  const EndingSignals signals([&](int signal, int count) {
    if (count > 1) ::_exit(128 + signal);
    ended_by = signal;
    output.Note(
        absl::StrCat("cancelling the import of ", call.name, "; Ctrl-C again leaves at once"));
    stop.request_stop();
  });
  absl::Status status;
  {
    const ShownProgress shown(client, call.request_id, output);
    status = client.Call(
        [&](grpc::ClientContext& context) {
          const std::stop_callback stopping(stop.get_token(), [&context] { context.TryCancel(); });
          return call.make(context);
        },
        call.seconds);
  }
  if (ended_by == 0 || status.ok()) return status;
  return Interrupted(ended_by, WhatBecame(call), call.name);
}

}  // namespace mortise::cli
