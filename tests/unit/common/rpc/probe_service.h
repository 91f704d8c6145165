// ProbeService, whose handlers are set by each test.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/handler.h"
#include "common/store/store.h"
#include "probe.grpc.pb.h"

namespace mortise::testing {

using ChunkWriter = std::shared_ptr<rpc::StreamWriter<v1::Chunk>>;
using ResponseWriter = std::shared_ptr<rpc::StreamWriter<ReadResponse>>;

// What the methods do. Set before the first call.
struct ProbeHandlers {
  std::function<absl::StatusOr<ReadResponse>(const rpc::Call&, const ReadRequest&)> read;
  std::function<absl::StatusOr<ReadResponse>(const rpc::Call&, const ReadRequest&)> hurry;
  std::function<absl::StatusOr<Kept>(const rpc::Call&, const KeepRequest&, store::Transaction&)>
      keep;
  std::function<absl::StatusOr<std::string>(const rpc::Call&, const KeepRequest&)> prepare;
  std::function<absl::StatusOr<v1::Operation>(const rpc::Call&, const KeepRequest&,
                                              store::Transaction&)>
      begin;
  std::function<absl::Status(const rpc::Call&, const ReadRequest&, rpc::Responder<ReadResponse>)>
      await;
  std::function<absl::Status(const rpc::Call&, const ReadRequest&, const ResponseWriter&)> follow;
  rpc::StreamOptions follow_options;
  std::function<absl::Status(const rpc::Call&, const ReadRequest&, const ChunkWriter&)> download;
  std::function<absl::StatusOr<std::unique_ptr<rpc::UploadReader<v1::Chunk, Kept>>>(
      const rpc::Call&)>
      upload;
  std::function<absl::StatusOr<std::unique_ptr<rpc::StreamReader<ReadRequest>>>(const rpc::Call&,
                                                                                ResponseWriter)>
      chat;
};

class ProbeAdapter : public ProbeService::CallbackService {
 public:
  ProbeAdapter(rpc::Dispatcher* dispatcher, ProbeHandlers* handlers)
      : handlers_(handlers), endpoint_(dispatcher, "mortise.testing.ProbeService") {}

  grpc::ServerUnaryReactor* Read(grpc::CallbackServerContext* context, const ReadRequest* request,
                                 ReadResponse* response) override {
    return endpoint_.Query("Read", context, request, response, handlers_->read);
  }

  grpc::ServerUnaryReactor* Hurry(grpc::CallbackServerContext* context, const ReadRequest* request,
                                  ReadResponse* response) override {
    return endpoint_.Query("Hurry", context, request, response, handlers_->hurry);
  }

  grpc::ServerUnaryReactor* Keep(grpc::CallbackServerContext* context, const KeepRequest* request,
                                 Kept* response) override {
    return endpoint_.Mutation("Keep", context, request, response, handlers_->keep);
  }

  grpc::ServerUnaryReactor* KeepSlowly(grpc::CallbackServerContext* context,
                                       const KeepRequest* request, Kept* response) override {
    return endpoint_.PreparedMutation(
        "KeepSlowly", context, request, response, handlers_->prepare,
        [this](const rpc::Call& call, const KeepRequest& asked, std::string& prepared,
               store::Transaction& transaction) -> absl::StatusOr<Kept> {
          KeepRequest changed = asked;
          changed.set_value(prepared);
          return handlers_->keep(call, changed, transaction);
        });
  }

  grpc::ServerUnaryReactor* Begin(grpc::CallbackServerContext* context, const KeepRequest* request,
                                  v1::Operation* response) override {
    return endpoint_.Mutation("Begin", context, request, response, handlers_->begin);
  }

  grpc::ServerUnaryReactor* Await(grpc::CallbackServerContext* context, const ReadRequest* request,
                                  ReadResponse* response) override {
    return endpoint_.AsyncQuery("Await", context, request, response, handlers_->await);
  }

  grpc::ServerUnaryReactor* Undeclared(grpc::CallbackServerContext* context,
                                       const ReadRequest* request,
                                       ReadResponse* response) override {
    return endpoint_.Query("Undeclared", context, request, response, handlers_->read);
  }

  grpc::ServerWriteReactor<ReadResponse>* Follow(grpc::CallbackServerContext* context,
                                                 const ReadRequest* request) override {
    return endpoint_.ServerStream<ReadResponse>("Follow", context, request, handlers_->follow,
                                                handlers_->follow_options);
  }

  grpc::ServerWriteReactor<v1::Chunk>* Download(grpc::CallbackServerContext* context,
                                                const ReadRequest* request) override {
    return endpoint_.ServerStream<v1::Chunk>("Download", context, request, handlers_->download);
  }

  grpc::ServerReadReactor<v1::Chunk>* Upload(grpc::CallbackServerContext* context,
                                             Kept* response) override {
    return endpoint_.Upload<v1::Chunk, Kept>("Upload", context, response, handlers_->upload);
  }

  grpc::ServerBidiReactor<ReadRequest, ReadResponse>* Chat(
      grpc::CallbackServerContext* context) override {
    return endpoint_.Bidi<ReadRequest, ReadResponse>("Chat", context, handlers_->chat,
                                                     {.endless = true});
  }

 private:
  ProbeHandlers* const handlers_;
  rpc::Endpoint endpoint_;
};

}  // namespace mortise::testing
