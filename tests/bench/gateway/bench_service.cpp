#include "tests/bench/gateway/bench_service.h"

#include <grpcpp/grpcpp.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "common/base/files.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::gateway {
namespace {

constexpr int64_t kChunkBytes = 256 * 1024;

class ChunkWriter final : public grpc::ServerWriteReactor<v1::Chunk> {
 public:
  explicit ChunkWriter(int64_t bytes) : left_(bytes) {
    chunk_.mutable_data()->assign(static_cast<std::size_t>(kChunkBytes), 'x');
    Next();
  }

  void OnWriteDone(bool ok) override {
    if (!ok) return Finish(grpc::Status::CANCELLED);
    Next();
  }

  void OnDone() override { delete this; }

 private:
  void Next() {
    if (left_ <= 0) return Finish(grpc::Status::OK);
    left_ -= kChunkBytes;
    StartWrite(&chunk_);
  }

  int64_t left_;
  v1::Chunk chunk_;
};

class Catalog final : public v1::CatalogService::CallbackService {
 public:
  grpc::ServerUnaryReactor* GetItem(grpc::CallbackServerContext* context,
                                    const v1::GetItemRequest* request, v1::Item* item) override {
    item->set_name(request->name());
    auto* reactor = context->DefaultReactor();
    reactor->Finish(grpc::Status::OK);
    return reactor;
  }

  grpc::ServerWriteReactor<v1::Chunk>* ExportDesign(
      grpc::CallbackServerContext*, const v1::ExportDesignRequest* request) override {
    return new ChunkWriter(request->revision());
  }
};

}  // namespace

int RunBenchService(const std::string& certificate, const std::string& key) {
  Catalog catalog;
  grpc::ServerBuilder builder;
  int plain = 0;
  int secure = 0;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &plain);
  grpc::SslServerCredentialsOptions security;
  security.pem_key_cert_pairs.push_back(
      {ReadFile(key).value_or(""), ReadFile(certificate).value_or("")});
  builder.AddListeningPort("127.0.0.1:0", grpc::SslServerCredentials(security), &secure);
  builder.RegisterService(&catalog);
  const auto server = builder.BuildAndStart();
  std::printf("127.0.0.1:%d 127.0.0.1:%d\n", plain, secure);
  std::fflush(stdout);
  char byte = 0;
  while (::read(STDIN_FILENO, &byte, 1) > 0) {
  }
  return 0;
}

}  // namespace mortise::gateway
