#include "gateway/forwarding/client_call.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>
#include <grpcpp/client_context.h>
#include <grpcpp/generic/generic_stub.h>

#include <atomic>
#include <boost/asio/async_result.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <functional>
#include <mutex>

#include "gateway/forwarding/wire.h"
#include "google/rpc/status.pb.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
namespace pb = google::protobuf;

HeaderList Unreserved(const std::multimap<grpc::string_ref, grpc::string_ref>& metadata) {
  HeaderList headers;
  for (const auto& [key, value] : metadata) {
    const std::string_view name(key.data(), key.size());
    if (IsReservedMetadata(name) && name != "x-request-id") continue;
    headers.emplace_back(name, std::string(value.data(), value.size()));
  }
  return headers;
}

// One value that a thread of gRPC gives and a coroutine waits for, in either order.
class Signal {
 public:
  // Resumes the coroutine that waits, or the next one to do so.
  void Give(bool value) {
    std::function<void(bool)> waiting;
    {
      std::lock_guard lock(mutex_);
      waiting.swap(waiting_);
      if (!waiting) value_ = value;
    }
    if (waiting) waiting(value);
  }

  // Takes the value; one coroutine at a time.
  asio::awaitable<bool> Wait() {
    return asio::async_initiate<const asio::use_awaitable_t<>, void(bool)>(
        [this](auto handler) { Keep(std::move(handler)); }, asio::use_awaitable);
  }

 private:
  // Keeps the coroutine's continuation, and its executor from running out of work.
  template <class Handler>
  void Keep(Handler handler) {
    auto executor = asio::get_associated_executor(handler);
    auto guard = asio::make_work_guard(executor);
    auto shared = std::make_shared<Handler>(std::move(handler));
    std::function<void(bool)> resume = [executor, guard = std::move(guard), shared](bool value) {
      asio::post(executor, [shared, value] { (*shared)(value); });
    };
    std::optional<bool> value;
    {
      std::lock_guard lock(mutex_);
      value.swap(value_);
      if (!value) waiting_ = std::move(resume);
    }
    if (value) resume(*value);
  }

  std::mutex mutex_;
  std::optional<bool> value_;          // guarded by mutex_
  std::function<void(bool)> waiting_;  // guarded by mutex_
};

// Empty for a type that this program does not know, and for a message that is none of its type.
std::string DetailAsJson(const std::string& type, const std::string& bytes) {
  const auto* descriptor = pb::DescriptorPool::generated_pool()->FindMessageTypeByName(type);
  if (descriptor == nullptr) return {};
  const pb::Message* prototype = pb::MessageFactory::generated_factory()->GetPrototype(descriptor);
  if (prototype == nullptr) return {};
  const std::unique_ptr<pb::Message> message(prototype->New());
  std::string json;
  if (!message->ParseFromString(bytes)) return {};
  if (!pb::util::MessageToJsonString(*message, &json).ok()) return {};
  return json;
}

void Prepare(grpc::ClientContext& context, const CallHead& head) {
  for (const auto& [key, value] : head.metadata) context.AddMetadata(key, value);
  if (head.deadline) context.set_deadline(*head.deadline);
}

// One answer, which gRPC asks for together with the status. Within a process this is the only way
// to be sure of it: there a server that sends its answer and its status as one drops the answer if
// nobody asks for it yet, and then waits forever for its end.
class UnaryCall final : public ClientCall, public grpc::ClientUnaryReactor {
 public:
  void Begin(std::shared_ptr<UnaryCall> self, GenericStub& stub, const CallHead& head,
             std::string_view request) {
    self_ = std::move(self);
    Prepare(context_, head);
    request_ = ToByteBuffer(request);
    stub.PrepareUnaryCall(&context_, head.path, {}, &request_, &answer_, this);
    StartCall();
  }

  asio::awaitable<std::optional<std::string>> Read() override {
    if (over_) co_return std::nullopt;
    over_ = co_await ended_.Wait();
    if (!status_.ok()) co_return std::nullopt;
    co_return ToString(answer_);
  }

  const grpc::Status& status() const override { return status_; }
  HeaderList leading() const override { return Unreserved(context_.GetServerInitialMetadata()); }
  HeaderList trailing() const override { return Unreserved(context_.GetServerTrailingMetadata()); }
  void Cancel() override { context_.TryCancel(); }

  void OnDone(const grpc::Status& status) override {
    status_ = status;
    // The last reference may be this one.
    const std::shared_ptr<UnaryCall> self = std::move(self_);
    ended_.Give(true);
  }

 private:
  std::shared_ptr<UnaryCall> self_;  // until OnDone
  grpc::ClientContext context_;
  grpc::ByteBuffer request_;
  grpc::ByteBuffer answer_;
  grpc::Status status_;
  Signal ended_;
  bool over_ = false;
};

class StreamingCall final : public ClientCall,
                            public grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  void Begin(std::shared_ptr<StreamingCall> self, GenericStub& stub, const CallHead& head,
             const std::vector<std::string>& requests) {
    self_ = std::move(self);
    Prepare(context_, head);
    for (const std::string& request : requests) requests_.push_back(ToByteBuffer(request));
    stub.PrepareBidiStreamingCall(&context_, head.path, {}, this);
    AddHold();  // Reads begin outside of gRPC's callbacks.
    WriteNext();
    StartCall();
  }

  asio::awaitable<std::optional<std::string>> Read() override {
    StartRead(&answer_);
    const bool ok = co_await read_.Wait();
    if (ok) co_return ToString(answer_);
    // No more is read: the call may end, and its status is waited for.
    ReleaseHold();
    co_await ended_.Wait();
    co_return std::nullopt;
  }

  const grpc::Status& status() const override { return status_; }
  HeaderList leading() const override { return Unreserved(context_.GetServerInitialMetadata()); }
  HeaderList trailing() const override { return Unreserved(context_.GetServerTrailingMetadata()); }
  void Cancel() override { context_.TryCancel(); }

  void OnReadDone(bool ok) override { read_.Give(ok); }

  void OnWriteDone(bool ok) override {
    if (ok) WriteNext();
  }

  void OnDone(const grpc::Status& status) override {
    status_ = status;
    // The last reference may be this one.
    const std::shared_ptr<StreamingCall> self = std::move(self_);
    ended_.Give(true);
  }

  // The coroutine went away, maybe without reading to the end.
  void Abandon() {
    context_.TryCancel();
    ReleaseHold();
  }

 private:
  void WriteNext() {
    if (written_ == requests_.size()) {
      if (requests_.empty()) StartWritesDone();
      return;
    }
    const grpc::ByteBuffer& next = requests_[written_++];
    if (written_ == requests_.size()) return StartWriteLast(&next, grpc::WriteOptions());
    StartWrite(&next);
  }

  void ReleaseHold() {
    if (!released_.exchange(true)) RemoveHold();
  }

  std::shared_ptr<StreamingCall> self_;  // until OnDone
  grpc::ClientContext context_;
  std::vector<grpc::ByteBuffer> requests_;
  std::size_t written_ = 0;
  grpc::ByteBuffer answer_;
  grpc::Status status_;
  std::atomic<bool> released_{false};
  Signal read_;
  Signal ended_;
};

class StreamedUpload final : public UploadCall,
                             public grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  void Begin(std::shared_ptr<StreamedUpload> self, GenericStub& stub, const CallHead& head,
             std::function<void()> answered) {
    self_ = std::move(self);
    when_answered_ = std::move(answered);
    Prepare(context_, head);
    stub.PrepareBidiStreamingCall(&context_, head.path, {}, this);
    AddHold();            // Writes begin outside of gRPC's callbacks.
    StartRead(&answer_);  // From the beginning, as of UnaryCall.
    StartCall();
  }

  asio::awaitable<bool> Write(std::string_view message) override {
    message_ = ToByteBuffer(message);
    StartWrite(&message_);
    refused_ = !co_await written_.Wait();
    message_.Clear();
    co_return !refused_;
  }

  asio::awaitable<std::optional<std::string>> Finish() override {
    if (!refused_) StartWritesDone();
    ReleaseHold();
    co_await ended_.Wait();
    if (!status_.ok() || !answered_) co_return std::nullopt;
    co_return ToString(answer_);
  }

  const grpc::Status& status() const override { return status_; }
  void Cancel() override { context_.TryCancel(); }

  void OnReadDone(bool ok) override {
    answered_ = ok;
    when_answered_();
  }
  void OnWriteDone(bool ok) override { written_.Give(ok); }

  void OnDone(const grpc::Status& status) override {
    status_ = status;
    // The last reference may be this one.
    const std::shared_ptr<StreamedUpload> self = std::move(self_);
    ended_.Give(true);
  }

  // The coroutine went away, maybe before it had finished.
  void Abandon() {
    context_.TryCancel();
    ReleaseHold();
  }

 private:
  void ReleaseHold() {
    if (!released_.exchange(true)) RemoveHold();
  }

  std::shared_ptr<StreamedUpload> self_;  // until OnDone
  grpc::ClientContext context_;
  grpc::ByteBuffer message_;
  grpc::ByteBuffer answer_;
  std::function<void()> when_answered_;
  bool answered_ = false;  // until OnDone of gRPC's threads alone
  bool refused_ = false;
  grpc::Status status_;
  std::atomic<bool> released_{false};
  Signal written_;
  Signal ended_;
};

}  // namespace

// The handles below end with what awaits them, not with the call: one dropped early abandons it.

std::shared_ptr<ClientCall> ClientCall::StartUnary(GenericStub& stub, const CallHead& head,
                                                   std::string_view request) {
  auto call = std::make_shared<UnaryCall>();
  call->Begin(call, stub, head, request);
  return std::shared_ptr<ClientCall>(call.get(), [call](ClientCall*) { call->Cancel(); });
}

std::shared_ptr<ClientCall> ClientCall::StartStreaming(GenericStub& stub, const CallHead& head,
                                                       const std::vector<std::string>& requests) {
  auto call = std::make_shared<StreamingCall>();
  call->Begin(call, stub, head, requests);
  return std::shared_ptr<ClientCall>(call.get(), [call](ClientCall*) { call->Abandon(); });
}

std::shared_ptr<UploadCall> UploadCall::Start(GenericStub& stub, const CallHead& head,
                                              std::function<void()> answered) {
  auto call = std::make_shared<StreamedUpload>();
  call->Begin(call, stub, head, std::move(answered));
  return std::shared_ptr<UploadCall>(call.get(), [call](UploadCall*) { call->Abandon(); });
}

std::optional<ConnectError> ToConnectError(const grpc::Status& status) {
  if (status.ok()) return std::nullopt;
  ConnectError error;
  error.code = static_cast<absl::StatusCode>(status.error_code());
  error.message = status.error_message();
  google::rpc::Status details;
  if (details.ParseFromString(status.error_details())) {
    for (const auto& detail : details.details()) {
      const std::string& url = detail.type_url();
      const std::string type = url.substr(url.rfind('/') + 1);
      error.details.push_back({type, detail.value(), DetailAsJson(type, detail.value())});
    }
  }
  return error;
}

}  // namespace mortise::gateway
