// Who asks AssemblyService to parametrise an assembly and does not wait for it.
#include <google/protobuf/text_format.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/rpc/channel.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/server_host.h"
#include "common/rpc/status_mapping.h"
#include "common/store/store.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "services/catalog/records/assembly_records.h"
#include "services/catalog/records/parametrization_cache.h"
#include "services/catalog/service/assembly_service.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::catalog {
namespace {

// A store whose reads from the second on take a while to begin. Of ParametrizeAssembly the first is
// that of the assembly, and the second that of its shapes, which is part of the work.
class SlowStore : public store::Store {
 public:
  explicit SlowStore(std::unique_ptr<store::Store> store) : store_(std::move(store)) {}

  void TakeLonger(absl::Duration wait) {
    wait_ = wait;
    reads_ = 0;
  }
  bool has_waited() const { return reads_ > 1; }

  absl::Status Read(const std::function<absl::Status(store::ReadTransaction&)>& read) override {
    if (++reads_ > 1) never_.WaitForNotificationWithTimeout(wait_);
    return store_->Read(read);
  }
  absl::Status Transact(const std::function<absl::Status(store::Transaction&)>& change,
                        store::Isolation isolation) override {
    return store_->Transact(change, isolation);
  }
  absl::StatusOr<std::unique_ptr<store::EventNumbering>> TakeEventNumbering() override {
    return store_->TakeEventNumbering();
  }
  std::unique_ptr<store::CommitListener> OnCommit(std::function<void()> callback) override {
    return store_->OnCommit(std::move(callback));
  }
  absl::StatusOr<store::BlobFolder*> Blobs() override { return store_->Blobs(); }
  absl::Time Now() const override { return store_->Now(); }

 private:
  const std::unique_ptr<store::Store> store_;
  const absl::Notification never_;
  absl::Duration wait_ = absl::ZeroDuration();
  std::atomic<int> reads_ = 0;
};

class AssemblyCallerTest : public ::testing::Test {
 protected:
  AssemblyCallerTest() {
    v1::Assembly assembly;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
        "name: 'assemblies/post' parts { name: 'foot' size { x: 0.2 y: 0.2 z: 0.1 } } "
        "parts { name: 'post' position { z: 0.1 } size { x: 0.1 y: 0.1 z: 1 } }",
        &assembly));
    EXPECT_OK(store_.Transact(
        [&](store::Transaction& transaction) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(const v1::AssemblyBundle bundle, Freeze(transaction, assembly));
          return ImportBundle(transaction, bundle, 0, {.user = "users/test", .trace_id = ""})
              .status();
        },
        store::Isolation::kSerializable));
    auto host = rpc::ServerHost::Start({.dispatcher = dispatcher_.get(),
                                        .services = {MakeAssemblyService(environment_, catalog_)}});
    EXPECT_OK(host);
    host_ = *std::move(host);
    host_->SetReady();
    stub_ = v1::AssemblyService::NewStub(*rpc::MakeChannel(host_->address(), {}));
  }

  ~AssemblyCallerTest() override {
    host_->Shutdown();
    dispatcher_->WaitIdle();
  }

  absl::StatusCode Parametrize(absl::Time deadline) {
    grpc::ClientContext context;
    context.set_deadline(absl::ToChronoTime(deadline));
    v1::ParametrizeAssemblyRequest request;
    request.set_name("assemblies/post");
    v1::Parametrization answer;
    return rpc::FromGrpc(stub_->ParametrizeAssembly(&context, request, &answer)).code();
  }

  // Whether somebody who asks the same has to do the work.
  bool IsStillToDo() {
    v1::AssemblyBundle bundle;
    EXPECT_OK(store_.Read([&](store::ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(bundle, GetAssemblyBundle(transaction, "assemblies/post", 0));
      return absl::OkStatus();
    }));
    bool is_to_do = false;
    const absl::Status found = catalog_->parametrized
                                   .Get(
                                       bundle, [] { return true; },
                                       [&](v1::AssemblyBundle&) {
                                         is_to_do = true;
                                         return absl::CancelledError("only looking");
                                       })
                                   .status();
    EXPECT_EQ(found.ok(), !is_to_do);
    return is_to_do;
  }

  const testing::TemporaryFolder folder_;
  SlowStore store_{store::OpenStore({.url = "sqlite:" + (folder_.path() / "store.db").string(),
                                     .blob_folder = folder_.path() / "blobs",
                                     .service = "catalog"})
                       .value()};
  const std::unique_ptr<rpc::Dispatcher> dispatcher_ =
      rpc::Dispatcher::Create({.service = "catalog", .threads = 2, .store = &store_});
  const std::shared_ptr<Catalog> catalog_ = std::make_shared<Catalog>(&store_, *store_.Blobs());
  const rpc::ServiceOptions options_;
  const rpc::ServiceEnvironment environment_{options_, &store_, nullptr, dispatcher_.get(),
                                             nullptr,  nullptr, nullptr};
  std::unique_ptr<rpc::ServerHost> host_;
  std::unique_ptr<v1::AssemblyService::Stub> stub_;
};

TEST_F(AssemblyCallerTest, EndsTheWorkByLeaving) {
  // On a machine that has much to do a call may be over before it has begun.
  absl::Duration patience = absl::Milliseconds(200);
  do {
    store_.TakeLonger(2 * patience);
    EXPECT_NE(Parametrize(absl::Now() + patience), absl::StatusCode::kOk);
    dispatcher_->WaitIdle();
    patience *= 2;
  } while (!store_.has_waited() && patience < absl::Minutes(1));
  store_.TakeLonger(absl::ZeroDuration());
  EXPECT_TRUE(IsStillToDo());
}

TEST_F(AssemblyCallerTest, LeavesTheAnswerToOthersByWaiting) {
  EXPECT_EQ(Parametrize(absl::Now() + absl::Minutes(1)), absl::StatusCode::kOk);
  EXPECT_FALSE(IsStillToDo());
}

}  // namespace
}  // namespace mortise::catalog
