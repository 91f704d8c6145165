// ProbeService, whose handlers are set by each test.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/handler.h"
#include "common/rpc/method_overrides.h"
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

inline absl::StatusOr<Kept> KeepWhatWasPrepared(const ProbeHandlers& handlers,
                                                const rpc::Call& call, const KeepRequest& asked,
                                                std::string& prepared,
                                                store::Transaction& transaction) {
  KeepRequest changed = asked;
  changed.set_value(prepared);
  return handlers.keep(call, changed, transaction);
}

class ProbeAdapter : public ProbeService::CallbackService {
  using Contract = ProbeService::CallbackService;

 public:
  ProbeAdapter(rpc::Dispatcher* dispatcher, ProbeHandlers* handlers)
      : handlers_(handlers), endpoint_(dispatcher, "mortise.testing.ProbeService") {}

  MORTISE_QUERY(Read, handlers_->read)
  MORTISE_QUERY(Hurry, handlers_->hurry)
  MORTISE_QUERY(Undeclared, handlers_->read)
  MORTISE_MUTATION(Keep, handlers_->keep)
  MORTISE_PREPARED_MUTATION(KeepSlowly, handlers_->prepare,
                            rpc::With(*handlers_, &KeepWhatWasPrepared))
  MORTISE_MUTATION(Begin, handlers_->begin)
  MORTISE_ASYNC_QUERY(Await, handlers_->await)
  MORTISE_SERVER_STREAM(Follow, handlers_->follow, handlers_->follow_options)
  MORTISE_SERVER_STREAM(Download, handlers_->download)
  MORTISE_UPLOAD(Upload, handlers_->upload)
  MORTISE_BIDI(Chat, handlers_->chat, {.endless = true})

 private:
  ProbeHandlers* const handlers_;
  rpc::Endpoint endpoint_;
};

}  // namespace mortise::testing
