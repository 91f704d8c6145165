// A unary call through the proxy: one batch of operations on either side.
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "gateway/forwarding/proxied_call.h"

namespace mortise::gateway {
namespace {

class UnaryForward final : public grpc::ServerGenericBidiReactor, public grpc::ClientUnaryReactor {
 public:
  explicit UnaryForward(std::unique_ptr<ProxiedCall> call) : call_(std::move(call)) {
    StartRead(&request_);
  }

  // The client's message came.
  void OnReadDone(bool ok) override {
    if (!ok) return End(rpc::ToGrpc(InvalidField("request", "the call carries no message")));
    absl::Status error = call_->Expand(request_);
    if (!error.ok()) return End(rpc::ToGrpc(error));
    GenericStub* stub = call_->Prepare(&request_, error);
    if (stub == nullptr) return End(rpc::ToGrpc(error));
    // The call that is started has taken the message; a large one is not held here until the
    // answer.
    grpc::ByteBuffer sent(request_);
    if (IsLarge(sent)) request_.Clear();
    stub->PrepareUnaryCall(&call_->upstream(), call_->method().path, {}, &sent, &response_, this);
    StartCall();
  }

  // The client went away or its deadline passed.
  void OnCancel() override { call_->Cancel(); }

  // The service answered.
  void OnDone(const grpc::Status& upstream) override {
    call_->CopyInitialMetadata();
    status_ = call_->Conclude(upstream, &request_);
    if (!status_.ok()) return Finish(status_);
    StartWriteAndFinish(&response_, grpc::WriteOptions(), status_);
  }

  // The client has its answer.
  void OnDone() override {
    call_->Record(status_);
    delete this;
  }

 private:
  void End(grpc::Status status) {
    status_ = std::move(status);
    Finish(status_);
  }

  std::unique_ptr<ProxiedCall> call_;
  grpc::ByteBuffer request_;
  grpc::ByteBuffer response_;
  grpc::Status status_;
};

class Refusal final : public grpc::ServerGenericBidiReactor {
 public:
  Refusal(std::unique_ptr<ProxiedCall> call, grpc::Status status)
      : call_(std::move(call)), status_(std::move(status)) {
    Finish(status_);
  }

  void OnDone() override {
    call_->Record(status_);
    delete this;
  }

 private:
  std::unique_ptr<ProxiedCall> call_;
  grpc::Status status_;
};

}  // namespace

grpc::ServerGenericBidiReactor* MakeUnaryForward(std::unique_ptr<ProxiedCall> call) {
  return new UnaryForward(std::move(call));
}

grpc::ServerGenericBidiReactor* MakeRefusal(std::unique_ptr<ProxiedCall> call,
                                            const absl::Status& status) {
  return new Refusal(std::move(call), rpc::ToGrpc(status));
}

}  // namespace mortise::gateway
