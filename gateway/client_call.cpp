#include "gateway/client_call.h"

#include <grpcpp/client_context.h>
#include <grpcpp/generic/generic_stub.h>

#include <atomic>
#include <boost/asio/async_result.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <functional>
#include <mutex>

#include "gateway/wire.h"
#include "google/rpc/status.pb.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;

HeaderList Unreserved(const std::multimap<grpc::string_ref, grpc::string_ref>& metadata) {
  HeaderList headers;
  for (const auto& [key, value] : metadata) {
    const std::string_view name(key.data(), key.size());
    if (IsReservedMetadata(name) && name != "x-request-id") continue;
    headers.emplace_back(name, std::string(value.data(), value.size()));
  }
  return headers;
}

class Call final : public ClientCall,
                   public grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                   public std::enable_shared_from_this<Call> {
 public:
  void Begin(GenericStub& stub, const CallHead& head, std::vector<std::string> requests) {
    self_ = shared_from_this();
    for (const auto& [key, value] : head.metadata) context_.AddMetadata(key, value);
    if (head.deadline) context_.set_deadline(*head.deadline);
    for (const std::string& request : requests) requests_.push_back(ToByteBuffer(request));
    stub.PrepareBidiStreamingCall(&context_, head.path, {}, this);
    AddHold();  // Reads begin outside of gRPC's callbacks.
    WriteNext();
    StartCall();
  }

  asio::awaitable<std::optional<std::string>> Read() override {
    const bool ok = co_await asio::async_initiate<const asio::use_awaitable_t<>, void(bool)>(
        [this](auto handler) {
          Await(std::move(handler));
          StartRead(&answer_);
        },
        asio::use_awaitable);
    if (ok) co_return ToString(answer_);
    // No more is read: the call may end, and its status is waited for.
    co_await asio::async_initiate<const asio::use_awaitable_t<>, void(bool)>(
        [this](auto handler) {
          Await(std::move(handler));
          bool ended = false;
          {
            std::lock_guard lock(mutex_);
            awaiting_end_ = true;
            ended = ended_;
          }
          if (ended) return Resume(true);
          ReleaseHold();
        },
        asio::use_awaitable);
    co_return std::nullopt;
  }

  const grpc::Status& status() const override { return status_; }
  HeaderList leading() const override { return Unreserved(context_.GetServerInitialMetadata()); }
  HeaderList trailing() const override { return Unreserved(context_.GetServerTrailingMetadata()); }
  void Cancel() override { context_.TryCancel(); }

  void OnReadDone(bool ok) override { Resume(ok); }

  void OnWriteDone(bool ok) override {
    if (ok) WriteNext();
  }

  void OnDone(const grpc::Status& status) override {
    status_ = status;
    bool awaited = false;
    {
      std::lock_guard lock(mutex_);
      ended_ = true;
      awaited = awaiting_end_;
    }
    // The last reference may be this one.
    const std::shared_ptr<Call> self = std::move(self_);
    if (awaited) Resume(true);
  }

  // The coroutine went away without reading to the end.
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

  // Keeps the coroutine's continuation, and its executor from running out of work.
  template <class Handler>
  void Await(Handler handler) {
    auto executor = asio::get_associated_executor(handler);
    auto guard = asio::make_work_guard(executor);
    auto shared = std::make_shared<Handler>(std::move(handler));
    std::lock_guard lock(mutex_);
    continuation_ = [executor, guard = std::move(guard), shared](bool ok) {
      asio::post(executor, [shared, ok] { (*shared)(ok); });
    };
  }

  void Resume(bool ok) {
    std::function<void(bool)> continuation;
    {
      std::lock_guard lock(mutex_);
      continuation.swap(continuation_);
    }
    if (continuation) continuation(ok);
  }

  std::shared_ptr<Call> self_;  // until OnDone
  grpc::ClientContext context_;
  std::vector<grpc::ByteBuffer> requests_;
  std::size_t written_ = 0;
  grpc::ByteBuffer answer_;
  grpc::Status status_;
  std::atomic<bool> released_{false};
  std::mutex mutex_;
  std::function<void(bool)> continuation_;  // guarded by mutex_
  bool awaiting_end_ = false;               // guarded by mutex_
  bool ended_ = false;                      // guarded by mutex_
};

}  // namespace

std::shared_ptr<ClientCall> ClientCall::Start(GenericStub& stub, CallHead head,
                                              std::vector<std::string> requests) {
  auto call = std::make_shared<Call>();
  call->Begin(stub, head, std::move(requests));
  // The handle's end, not the call's: a handle dropped early abandons the call.
  return std::shared_ptr<ClientCall>(call.get(), [call](ClientCall*) { call->Abandon(); });
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
      error.details.push_back({url.substr(url.rfind('/') + 1), detail.value()});
    }
  }
  return error;
}

}  // namespace mortise::gateway
