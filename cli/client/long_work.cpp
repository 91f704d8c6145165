#include "cli/client/long_work.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <grpcpp/grpcpp.h>
#include <unistd.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "cli/client/ending_signals.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/rpc/channel.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/operations.grpc.pb.h"

namespace mortise::cli {
namespace {

constexpr double kCancelPatience = 10;  // s
constexpr absl::Duration kPendingPatience = absl::Seconds(2);

// What a command that was asked to end says of the operation it cancelled.
std::string WhatWasKept(const v1::Operation& operation, const std::string& what_stays) {
  const std::string made = MadeBy(operation);
  switch (operation.state()) {
    case v1::Operation::SUCCEEDED:
      return absl::StrCat(operation.name(), " had finished before it could be cancelled",
                          made.empty() ? "" : "; it made ", made);
    case v1::Operation::FAILED:
      return absl::StrCat(operation.name(), " had failed before it could be cancelled: ",
                          operation.error().message());
    default:
      return absl::StrCat(
          operation.name(), " was cancelled; ",
          made.empty() ? what_stays : absl::StrCat("its best so far is kept in ", made));
  }
}

// One operation of one command, and the signals that come meanwhile.
class Following {
 public:
  Following(const GatewayClient& client, const LongWork& work, Output& output)
      : client_(client),
        work_(work),
        output_(output),
        signals_([this](int signal, int count) { OnSignal(signal, count); }) {}

  absl::Status Start(const StartCall& start) {
    v1::Operation started;
    MORTISE_RETURN_IF_ERROR(
        client_.Call([&](grpc::ClientContext& context) { return start(context, &started); }));
    SetOperation(started);
    if (work_.detach) return absl::OkStatus();
    const char* const at_signals = work_.when_left == WhenLeft::kIsCancelled ? "cancels it"
                                   : work_.when_left == WhenLeft::kGoesOn    ? "leaves it running"
                                                                             : "ends it";
    output_.Note(absl::StrCat(started.name(), " started; Ctrl-C ", at_signals));
    return absl::OkStatus();
  }

  void SetOperation(const v1::Operation& operation) {
    const std::lock_guard lock(mutex_);
    operation_ = operation;
  }

  v1::Operation operation() const {
    const std::lock_guard lock(mutex_);
    return operation_;
  }

  bool asked_to_end() const { return signal_ != 0; }

  absl::StatusOr<v1::Operation> ToItsEnd() {
    absl::StatusOr<v1::Operation> done = Watch(stop_.get_token());
    output_.EndProgress();
    if (signal_ == 0) {
      if (!done.ok()) return WithGoingOn(done.status());
      const absl::Status error = ErrorOf(*done);
      if (!error.ok()) return error;
      return done;
    }
    return Leave(done);
  }

 private:
  // On a thread of the signals.
  void OnSignal(int signal, int count) {
    const v1::Operation operation = this->operation();
    if (count > 1) {
      output_.Failure(Interrupted(signal, GoingOn(operation), operation.name()));
      ::_exit(128 + signal);
    }
    signal_ = signal;
    if (work_.when_left == WhenLeft::kIsCancelled) {
      output_.Note(
          operation.name().empty()
              ? "cancelling once it has started; Ctrl-C again leaves at once"
              : absl::StrCat("cancelling ", operation.name(), "; Ctrl-C again leaves at once"));
    }
    stop_.request_stop();
  }

  std::string GoingOn(const v1::Operation& operation) const {
    if (operation.name().empty()) {
      return absl::StrCat("left before it was known what had started; see what runs with: ",
                          client_.command(), " operations list");
    }
    return work_.how_to_go_on ? work_.how_to_go_on(client_, operation)
                              : HowToGoOn(client_, operation);
  }

  // The failure of following an operation, which goes on: unless it is not there, or ends with the
  // house that this command runs.
  absl::Status WithGoingOn(const absl::Status& failure) const {
    if (absl::IsNotFound(failure) || work_.when_left == WhenLeft::kEndsWithHouse) return failure;
    absl::Status status(failure.code(),
                        absl::StrCat(failure.message(), "\n", GoingOn(operation())));
    failure.ForEachPayload([&](absl::string_view type, const absl::Cord& payload) {
      status.SetPayload(type, payload);
    });
    return status;
  }

  absl::StatusOr<v1::Operation> Watch(const std::stop_token& stop) {
    std::atomic<bool> is_pending = operation().state() == v1::Operation::PENDING;
    const std::jthread patience([&](const std::stop_token& ended) {
      if (!rpc::Pause(kPendingPatience, ended) || !is_pending) return;
      output_.Progress(0, 0,
                       absl::StrCat("waiting until the service has ended other work; see what "
                                    "runs with: ",
                                    client_.command(), " operations list --active"));
    });
    return client_.Follow(
        operation().name(),
        [this, &is_pending](const v1::Operation& now) {
          is_pending = now.state() == v1::Operation::PENDING;
          if (is_pending && now.progress().message().empty()) return;
          output_.Progress(now.progress().done(), now.progress().total(), now.progress().message());
        },
        stop);
  }

  // Ends what the signal means to end, and tells what became of it.
  absl::Status Leave(absl::StatusOr<v1::Operation> done) {
    const v1::Operation operation = this->operation();
    const auto interrupted = [&](const std::string& message) {
      return Interrupted(signal_, message, operation.name());
    };
    if (work_.when_left == WhenLeft::kEndsWithHouse) {
      return interrupted(absl::StrCat(operation.name(), " ends with its house"));
    }
    if (work_.when_left == WhenLeft::kGoesOn && !done.ok()) {
      return interrupted(GoingOn(operation));
    }
    if (!done.ok()) {
      const absl::Status cancelled = Cancel(operation.name());
      if (cancelled.ok()) done = Watch({});
      output_.EndProgress();
      if (!cancelled.ok() || !done.ok()) {
        const absl::Status& why = cancelled.ok() ? done.status() : cancelled;
        return interrupted(absl::StrCat(operation.name(), " may not have been cancelled: ",
                                        why.message(), "\n", GoingOn(operation)));
      }
    }
    return interrupted(WhatWasKept(*done, work_.what_stays));
  }

  absl::Status Cancel(const std::string& name) const {
    const auto stub = v1::OperationService::NewStub(client_.channel());
    v1::CancelOperationRequest request;
    request.set_request_id(NewIdentifier());
    request.set_name(name);
    v1::Operation ignored;
    return client_.Call(
        [&](grpc::ClientContext& context) {
          return rpc::FromGrpc(stub->CancelOperation(&context, request, &ignored));
        },
        kCancelPatience);
  }

  const GatewayClient& client_;
  const LongWork& work_;
  Output& output_;
  mutable std::mutex mutex_;
  v1::Operation operation_;  // guarded by mutex_; without a name until it has started
  std::atomic<int> signal_ = 0;
  std::stop_source stop_;
  EndingSignals signals_;  // last: gone before what it tells of
};

}  // namespace

std::string HowToGoOn(const GatewayClient& client, const v1::Operation& operation) {
  return absl::StrCat(operation.name(), " goes on\n  watch it with:  ", client.command(),
                      " operations watch ", operation.name(),
                      "\n  cancel it with: ", client.command(), " operations cancel ",
                      operation.name());
}

absl::StatusOr<v1::Operation> GetOperation(const GatewayClient& client, const std::string& name) {
  const auto stub = v1::OperationService::NewStub(client.channel());
  v1::GetOperationRequest request;
  request.set_name(name);
  v1::Operation operation;
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->GetOperation(&context, request, &operation));
  }));
  return operation;
}

std::string MadeBy(const v1::Operation& operation) {
  const std::string& url = operation.result().type_url();
  const auto* const type =
      google::protobuf::DescriptorPool::generated_pool()->FindMessageTypeByName(
          url.substr(url.find('/') + 1));
  const auto* const field = type == nullptr ? nullptr : type->FindFieldByName("name");
  const bool has_name = field != nullptr && !field->is_repeated() &&
                        field->type() == google::protobuf::FieldDescriptor::TYPE_STRING;
  if (!has_name) return "";
  const std::unique_ptr<google::protobuf::Message> result(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(type)->New());
  if (!operation.result().UnpackTo(result.get())) return "";
  return result->GetReflection()->GetString(*result, field);
}

absl::StatusOr<std::optional<v1::Operation>> Run(const GatewayClient& client, const LongWork& work,
                                                 const StartCall& start, Output& output) {
  Following following(client, work, output);
  MORTISE_RETURN_IF_ERROR(following.Start(start));
  if (work.detach && !following.asked_to_end()) {
    const v1::Operation operation = following.operation();
    output.Line(work.how_to_go_on ? work.how_to_go_on(client, operation)
                                  : HowToGoOn(client, operation));
    output.DocumentOf(operation);
    return std::optional<v1::Operation>();
  }
  MORTISE_ASSIGN_OR_RETURN(v1::Operation done, following.ToItsEnd());
  return std::optional<v1::Operation>(std::move(done));
}

absl::StatusOr<v1::Operation> Follow(const GatewayClient& client, const LongWork& work,
                                     const v1::Operation& operation, Output& output) {
  Following following(client, work, output);
  following.SetOperation(operation);
  return following.ToItsEnd();
}

}  // namespace mortise::cli
