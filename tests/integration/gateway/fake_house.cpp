#include "tests/integration/gateway/fake_house.h"

#include <grpcpp/server_builder.h>

#include <chrono>
#include <thread>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"

namespace mortise::gateway {
namespace {

constexpr int64_t kChunkBytes = 256 * 1024;

std::string Metadata(const grpc::ServerContext& context, const char* key) {
  const auto found = context.client_metadata().find(key);
  if (found == context.client_metadata().end()) return {};
  return std::string(found->second.data(), found->second.size());
}

}  // namespace

struct FakeHouse::Services {
  explicit Services(FakeHouse& house) : catalog(house), simulator(), fabplanner() {}

  class Catalog final : public v1::CatalogService::Service {
   public:
    explicit Catalog(FakeHouse& house) : house_(house) {}

    grpc::Status GetItem(grpc::ServerContext* context, const v1::GetItemRequest* request,
                         v1::Item* item) override {
      item->set_name(request->name());
      item->set_revision(int64_t{1} << 60);
      if (request->name() == "items/missing") {
        return rpc::ToGrpc(ResourceNotFound(request->name()));
      }
      if (request->name() == "items/slow") {
        while (!context->IsCancelled()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
        ++house_.cancelled_;
        return grpc::Status::CANCELLED;
      }
      if (request->name() == "items/echo") Describe(*context, *item);
      return grpc::Status::OK;
    }

    grpc::Status ExportDesign(grpc::ServerContext* context, const v1::ExportDesignRequest* request,
                              grpc::ServerWriter<v1::Chunk>* writer) override {
      v1::Chunk chunk;
      const bool endless = request->name() == "templates/endless";
      for (int64_t offset = 0; endless || offset < request->revision(); offset += kChunkBytes) {
        const int64_t left = endless ? kChunkBytes : request->revision() - offset;
        chunk.set_offset(offset);
        chunk.mutable_data()->assign(static_cast<std::size_t>(std::min(left, kChunkBytes)), 'x');
        // A write fails when the call is over, which IsCancelled() tells only a little later.
        if (!writer->Write(chunk)) {
          ++house_.cancelled_;
          return grpc::Status::CANCELLED;
        }
        ++house_.written_;
        if (request->name() == "templates/broken") {
          context->AddTrailingMetadata("x-trail", "torn");
          return rpc::ToGrpc(PreconditionFailed("BROKEN", "the design is broken"));
        }
      }
      if (context->IsCancelled()) ++house_.cancelled_;
      return grpc::Status::OK;
    }

   private:
    static void Describe(grpc::ServerContext& context, v1::Item& item) {
      item.set_title(Metadata(context, "x-custom"));
      const std::string trace = Metadata(context, "mortise-trace-id");
      item.set_supplier(trace);
      item.set_supplier_number(Metadata(context, "mortise-identity-bin").empty()
                                   ? (trace.empty() ? "nobody" : "trace")
                                   : "identity");
      item.set_supplier_url(Metadata(context, "authorization"));
      item.set_material(Metadata(context, "x-blob-bin"));
      context.AddInitialMetadata("x-lead", "first");
      context.AddTrailingMetadata("x-trail", "last");
    }

    FakeHouse& house_;
  };

  class Simulator final : public v1::SimulatorService::Service {
   public:
    grpc::Status UploadBlob(grpc::ServerContext*, grpc::ServerReader<v1::Chunk>* reader,
                            v1::UploadBlobResponse* response) override {
      int64_t bytes = 0;
      v1::Chunk chunk;
      while (reader->Read(&chunk)) bytes += static_cast<int64_t>(chunk.data().size());
      response->set_sha256(std::to_string(bytes));
      return grpc::Status::OK;
    }
  };

  class FabPlanner final : public v1::FabPlannerService::Service {
   public:
    grpc::Status AttachBridge(
        grpc::ServerContext*,
        grpc::ServerReaderWriter<v1::PlannerMessage, v1::BridgeMessage>* stream) override {
      v1::PlannerMessage answer;
      answer.mutable_hold()->set_work_order("welcome");
      stream->Write(answer);
      v1::BridgeMessage message;
      while (stream->Read(&message)) {
        if (message.hello().bridge() == "reject") {
          return {grpc::StatusCode::PERMISSION_DENIED, "no such bridge"};
        }
        answer.mutable_hold()->set_work_order(message.hello().bridge());
        stream->Write(answer);
      }
      return grpc::Status::OK;
    }
  };

  Catalog catalog;
  Simulator simulator;
  FabPlanner fabplanner;
};

FakeHouse::FakeHouse() : services_(std::make_unique<Services>(*this)) {
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&services_->catalog);
  builder.RegisterService(&services_->simulator);
  builder.RegisterService(&services_->fabplanner);
  server_ = builder.BuildAndStart();
  address_ = "127.0.0.1:" + std::to_string(port);
}

FakeHouse::~FakeHouse() { server_->Shutdown(std::chrono::system_clock::now()); }

bool FakeHouse::WaitForCancelled(int count) const {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (cancelled_ < count) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace mortise::gateway
