// A streaming call through the proxy: two pumps, each holding at most one message.
#include <mutex>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "gateway/forwarding/proxied_call.h"

namespace mortise::gateway {
namespace {

using grpc::ByteBuffer;

// The client's stream is this object, the service's stream its member `service_side_`.
//
// gRPC ends the service's stream (OnDone) once its status has come and nothing is pending on it.
// Reads and writes here are started by what happens on the *client's* stream, so each pump keeps a
// hold on the service's stream until it will start nothing more.
class StreamForward final : public grpc::ServerGenericBidiReactor {
 public:
  explicit StreamForward(std::unique_ptr<ProxiedCall> call)
      : call_(std::move(call)),
        client_streaming_(call_->method().client_streaming),
        service_side_(*this) {
    // A client that streams may wait for the service to speak first; otherwise the request comes
    // first, and goes out in one batch with the headers.
    if (client_streaming_ && !Connect(nullptr)) return;
    StartRead(&from_client_);
  }

  void OnReadDone(bool ok) override {
    const absl::Status readable = ok ? call_->Expand(from_client_) : absl::OkStatus();
    if (client_streaming_) {
      if (readable.ok()) return PassOn(ok);
      {
        std::lock_guard lock(mutex_);
        refused_ = readable;
      }
      call_->Cancel();
      return PassOn(false);
    }
    if (!ok) return End(rpc::ToGrpc(InvalidField("request", "the call carries no message")));
    if (!readable.ok()) return End(rpc::ToGrpc(readable));
    Connect(&from_client_);
  }

  void OnWriteDone(bool ok) override {
    if (ok) return service_side_.StartRead(&from_service_);
    call_->Cancel();
    StopReading();
  }

  void OnCancel() override { call_->Cancel(); }

  void OnDone() override {
    call_->Record(status_);
    delete this;
  }

 private:
  class ServiceSide final : public grpc::ClientBidiReactor<ByteBuffer, ByteBuffer> {
   public:
    explicit ServiceSide(StreamForward& owner) : owner_(owner) {}
    void OnReadInitialMetadataDone(bool ok) override { owner_.OnHeaders(ok); }
    void OnReadDone(bool ok) override { owner_.OnServiceMessage(ok); }
    void OnWriteDone(bool ok) override { owner_.OnPassedOn(ok); }
    void OnDone(const grpc::Status& status) override { owner_.OnServiceDone(status); }

   private:
    StreamForward& owner_;
  };

  // Begins the service's stream. False if that ended the call.
  bool Connect(const ByteBuffer* first) {
    absl::Status error;
    GenericStub* stub = call_->Prepare(first, error);
    if (stub == nullptr) {
      End(rpc::ToGrpc(error));
      return false;
    }
    if (first != nullptr) call_->upstream().set_initial_metadata_corked(true);
    stub->PrepareBidiStreamingCall(&call_->upstream(), call_->method().path, {}, &service_side_);
    service_side_.AddMultipleHolds(client_streaming_ ? 2 : 1);
    if (first != nullptr) service_side_.StartWriteLast(first, grpc::WriteOptions());
    service_side_.StartCall();
    return true;
  }

  // --- From the service to the client.

  void OnHeaders(bool ok) {
    if (!ok) return StopReading();
    call_->CopyInitialMetadata();
    StartSendInitialMetadata();
    service_side_.StartRead(&from_service_);
  }

  void OnServiceMessage(bool ok) {
    if (!ok) return StopReading();
    StartWrite(&from_service_);
  }

  // The service has said all, or the client listens no more.
  void StopReading() {
    bool release_writer = false;
    {
      std::lock_guard lock(mutex_);
      service_over_ = true;
      release_writer = client_streaming_ && !writer_released_ && !passing_on_;
      if (release_writer) writer_released_ = true;
    }
    if (release_writer) service_side_.RemoveHold();
    service_side_.RemoveHold();
  }

  void OnServiceDone(const grpc::Status& status) {
    absl::Status refused;
    {
      std::lock_guard lock(mutex_);
      refused = refused_;
    }
    if (!refused.ok()) return End(rpc::ToGrpc(refused));
    End(call_->Conclude(status, client_streaming_ ? nullptr : &from_client_));
  }

  // --- From the client to the service.

  // A message of the client's, or its half-close (client streaming only).
  void PassOn(bool ok) {
    {
      std::lock_guard lock(mutex_);
      // Released: the service is over, and this is the client's stream being ended.
      if (writer_released_) return;
      (ok ? passing_on_ : writer_released_) = true;
    }
    if (ok) return service_side_.StartWrite(&from_client_);
    service_side_.StartWritesDone();
    service_side_.RemoveHold();
  }

  void OnPassedOn(bool ok) {
    if (!client_streaming_) {
      // The only message. What became of it is held by its service, so its room is kept.
      if (IsLarge(from_client_)) from_client_.Clear();
      return;
    }
    from_client_.Clear();
    call_->LetGo();
    bool release = false;
    {
      std::lock_guard lock(mutex_);
      passing_on_ = false;
      if (!ok) service_over_ = true;
      release = service_over_ && !writer_released_;
      if (release) writer_released_ = true;
    }
    if (release) {
      service_side_.RemoveHold();
    } else if (ok) {
      StartRead(&from_client_);
    }
  }

  // Ends the client's stream, once.
  void End(grpc::Status status) {
    status_ = std::move(status);
    Finish(status_);
  }

  std::unique_ptr<ProxiedCall> call_;
  const bool client_streaming_;
  ServiceSide service_side_;
  ByteBuffer from_client_;
  ByteBuffer from_service_;
  grpc::Status status_;
  std::mutex mutex_;
  absl::Status refused_;          // of a message of the client's; guarded by mutex_
  bool service_over_ = false;     // nothing more goes to the service; guarded by mutex_
  bool passing_on_ = false;       // a write to the service is pending; guarded by mutex_
  bool writer_released_ = false;  // the client's pump gave its hold back; guarded by mutex_
};

}  // namespace

grpc::ServerGenericBidiReactor* MakeStreamForward(std::unique_ptr<ProxiedCall> call) {
  return new StreamForward(std::move(call));
}

}  // namespace mortise::gateway
