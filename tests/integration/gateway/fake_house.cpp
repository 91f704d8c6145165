#include "tests/integration/gateway/fake_house.h"

#include <grpcpp/server_builder.h>

#include <algorithm>
#include <chrono>

#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"

namespace mortise::gateway {
namespace {

constexpr int64_t kChunkBytes = 256 * 1024;
// How often a handler that waits for the end of its call looks.
constexpr std::chrono::milliseconds kLook(5);

std::string Metadata(const grpc::CallbackServerContext& context, const char* key) {
  const auto found = context.client_metadata().find(key);
  if (found == context.client_metadata().end()) return {};
  return std::string(found->second.data(), found->second.size());
}

}  // namespace

struct FakeHouse::Services {
  explicit Services(FakeHouse& house) : catalog(house), simulator(house), fabplanner() {}

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
      if (IsFile(request->name())) return SendFile(*request, *writer);
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

    grpc::Status ListItems(grpc::ServerContext*, const v1::ListItemsRequest* request,
                           v1::ListItemsResponse* response) override {
      const bool first = request->page_token().empty();
      v1::Item& item = *response->add_items();
      item.set_name(first ? "items/a" : "items/b");
      item.set_title(first ? "Screw, \"small\"" : "Bohle, größer");
      item.set_kind(request->kind() == v1::ITEM_KIND_UNSPECIFIED ? v1::SCREW : request->kind());
      item.mutable_price()->set_amount(0.25);
      if (first) response->set_next_page_token("more");
      return grpc::Status::OK;
    }

    grpc::Status ImportCatalog(grpc::ServerContext*, const v1::ImportCatalogRequest* request,
                               v1::ImportCatalogResponse* response) override {
      for (int i = 0; i < request->items_size(); ++i) {
        if (request->items(i).name() != "items/bad") continue;
        return rpc::ToGrpc(InvalidField("items[" + std::to_string(i) + "].price.amount", "is odd"));
      }
      response->set_created_count(request->items_size());
      return grpc::Status::OK;
    }

   private:
    static bool IsFile(const std::string& name) {
      return name == "templates/file" || name == "templates/page" || name == "templates/short";
    }

    grpc::Status SendFile(const v1::ExportDesignRequest& request,
                          grpc::ServerWriter<v1::Chunk>& writer) {
      const std::string bytes = FileBytes(static_cast<std::size_t>(request.revision()));
      const bool page = request.name() == "templates/page";
      v1::Chunk chunk;
      chunk.set_total_size(request.revision() + (request.name() == "templates/short" ? 1 : 0));
      chunk.set_sha256(Sha256Hex(bytes));
      chunk.set_file_name(page ? "../../x\"\r\nSet-Cookie: a=b" : "table.step");
      chunk.set_media_type(page ? "text/html\r\nX-Evil: 1" : "model/step");
      for (std::size_t offset = 0; offset == 0 || offset < bytes.size(); offset += kChunkBytes) {
        chunk.set_offset(static_cast<int64_t>(offset));
        chunk.set_data(bytes.substr(offset, kChunkBytes));
        if (!writer.Write(chunk)) {
          house_.Count(&Counts::cancelled);
          return grpc::Status::CANCELLED;
        }
        house_.Count(&Counts::written);
        chunk = {};
      }
      return grpc::Status::OK;
    }

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
    explicit Simulator(FakeHouse& house) : house_(house) {}

    grpc::Status UploadBlob(grpc::ServerContext* context, grpc::ServerReader<v1::Chunk>* reader,
                            v1::UploadBlobResponse* response) override {
      int64_t bytes = 0;
      int64_t total = 0;
      std::string about;
      v1::Chunk chunk;
      while (reader->Read(&chunk)) {
        house_.Count(&Counts::uploaded);
        if (chunk.total_size() > int64_t{1} << 30)
          return rpc::ToGrpc(TooLarge("the file", "1 GiB"));
        total = std::max(total, chunk.total_size());
        if (chunk.offset() == 0) about = chunk.media_type() + chunk.sha256();
        bytes += static_cast<int64_t>(chunk.data().size());
        if (chunk.media_type() == "test/stall") {
          house_.WaitUntilOver(*context);
          return grpc::Status::CANCELLED;
        }
      }
      if (bytes < total) house_.Count(&Counts::cancelled);
      response->set_sha256(std::to_string(bytes) + about);
      return grpc::Status::OK;
    }

   private:
    FakeHouse& house_;
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

std::string FakeHouse::FileBytes(std::size_t count) {
  std::string bytes(count, ' ');
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<char>('a' + i * 7 % 26);
  return bytes;
}

void FakeHouse::WaitUntilOver(const grpc::ServerContext& context) {
  std::unique_lock lock(mutex_);
  while (!context.IsCancelled()) changed_.wait_for(lock, kLook);
  ++counts_.cancelled;
  changed_.notify_all();
}

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
