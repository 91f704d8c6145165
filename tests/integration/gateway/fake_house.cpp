#include "tests/integration/gateway/fake_house.h"

#include <grpcpp/server_builder.h>

#include <algorithm>
#include <chrono>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"

namespace mortise::gateway {
namespace {

constexpr int64_t kChunkBytes = 256 * 1024;

std::string Metadata(const grpc::CallbackServerContext& context, const char* key) {
  const auto found = context.client_metadata().find(key);
  if (found == context.client_metadata().end()) return {};
  return std::string(found->second.data(), found->second.size());
}

}  // namespace

struct FakeHouse::Services {
  explicit Services(FakeHouse& house) : catalog(house), simulator(), fabplanner() {}

  class Catalog final
      : public v1::CatalogService::WithCallbackMethod_GetItem<v1::CatalogService::Service> {
   public:
    explicit Catalog(FakeHouse& house) : house_(house) {}

    grpc::ServerUnaryReactor* GetItem(grpc::CallbackServerContext* context,
                                      const v1::GetItemRequest* request, v1::Item* item) override {
      if (request->name() == "items/slow") return new SlowAnswer(house_);
      item->set_name(request->name());
      item->set_revision(int64_t{1} << 60);
      if (request->name() == "items/echo") Describe(*context, *item);
      grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
      reactor->Finish(request->name() == "items/missing"
                          ? rpc::ToGrpc(ResourceNotFound(request->name()))
                          : grpc::Status::OK);
      return reactor;
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
          house_.Count(&Counts::cancelled);
          return grpc::Status::CANCELLED;
        }
        house_.Count(&Counts::written);
        if (request->name() == "templates/broken") {
          context->AddTrailingMetadata("x-trail", "torn");
          return rpc::ToGrpc(PreconditionFailed("BROKEN", "the design is broken"));
        }
      }
      if (context->IsCancelled()) house_.Count(&Counts::cancelled);
      return grpc::Status::OK;
    }

   private:
    // Answers when the call is cancelled.
    class SlowAnswer final : public grpc::ServerUnaryReactor {
     public:
      explicit SlowAnswer(FakeHouse& house) : house_(house) { house.Count(&Counts::slow); }
      void OnCancel() override {
        house_.Count(&Counts::cancelled);
        Finish(grpc::Status::CANCELLED);
      }
      void OnDone() override { delete this; }

     private:
      FakeHouse& house_;
    };

    static void Describe(grpc::CallbackServerContext& context, v1::Item& item) {
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

    grpc::Status HoldWorkOrder(grpc::ServerContext*, const v1::HoldWorkOrderRequest* request,
                               v1::WorkOrder* order) override {
      order->set_name(request->name());
      return grpc::Status::OK;
    }
  };

  Catalog catalog;
  Simulator simulator;
  FabPlanner fabplanner;
};

FakeHouse::FakeHouse(int most_streams) : services_(std::make_unique<Services>(*this)) {
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  if (most_streams > 0) {
    builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, most_streams);
  }
  builder.RegisterService(&services_->catalog);
  builder.RegisterService(&services_->simulator);
  builder.RegisterService(&services_->fabplanner);
  server_ = builder.BuildAndStart();
  address_ = "127.0.0.1:" + std::to_string(port);
}

FakeHouse::~FakeHouse() { server_->Shutdown(std::chrono::system_clock::now()); }

FakeHouse::Counts FakeHouse::counts() const {
  std::lock_guard lock(mutex_);
  return counts_;
}

void FakeHouse::Count(int Counts::*what) {
  std::lock_guard lock(mutex_);
  ++(counts_.*what);
  changed_.notify_all();
}

bool FakeHouse::WaitFor(int Counts::*what, int count) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::seconds(10), [&] { return counts_.*what >= count; });
}

}  // namespace mortise::gateway
