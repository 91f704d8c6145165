// ImportCatalog on PostgreSQL: many at once, and none where the catalog dies midway.
#include <gtest/gtest.h>
#include <libpq-fe.h>

#include <future>
#include <memory>
#include <thread>

#include "absl/time/clock.h"
#include "common/store/store.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/catalog/imported_catalog.h"
#include "tests/integration/services/service_under_test.h"
#include "tests/support/private_postgresql.h"
#include "tests/support/status_assertions.h"

namespace mortise::catalog {
namespace {

using Stub = v1::CatalogService::Stub;

class ImportCatalogPostgresql : public ::testing::Test {
 protected:
  void SetUp() override {
    auto cluster = testing::PrivatePostgresql::Start();
    ASSERT_OK(cluster);
    cluster_ = *std::move(cluster);
    process_ = std::make_unique<testing::ServiceUnderTest>(
        "mortise-catalog", std::vector<std::string>(), cluster_->url());
    stub_ = v1::CatalogService::NewStub(process_->channel());
  }

  // Until somebody waits for what another transaction has written.
  void AwaitWaiting() {
    const std::unique_ptr<PGconn, void (*)(PGconn*)> connection(
        PQconnectdb(cluster_->url().c_str()), PQfinish);
    const absl::Time deadline = absl::Now() + absl::Minutes(2);
    while (absl::Now() < deadline) {
      const std::unique_ptr<PGresult, void (*)(PGresult*)> answer(
          PQexec(connection.get(),
                 "SELECT count(*) FROM pg_locks WHERE NOT granted AND locktype = 'transactionid'"),
          PQclear);
      ASSERT_EQ(PQresultStatus(answer.get()), PGRES_TUPLES_OK) << PQerrorMessage(connection.get());
      if (std::string(PQgetvalue(answer.get(), 0, 0)) != "0") return;
      std::this_thread::yield();
    }
    ADD_FAILURE() << "nobody waits";
  }

  std::unique_ptr<testing::PrivatePostgresql> cluster_;
  std::unique_ptr<testing::ServiceUnderTest> process_;
  std::unique_ptr<Stub> stub_;
};

TEST_F(ImportCatalogPostgresql, BringsInManyAndAgainOnlyWhatDiffers) {
  v1::ImportCatalogRequest request = ManyPegs(300);
  ASSERT_OK_AND_ASSIGN(const v1::ImportCatalogResponse first,
                       testing::Call(*stub_, &Stub::ImportCatalog, request));
  EXPECT_EQ(first.created_count(), 301);
  EXPECT_EQ(CountItems(*stub_), 300u);
  request.set_request_id("dearer");
  request.mutable_items(7)->mutable_price()->set_amount(0.09);
  ASSERT_OK_AND_ASSIGN(const v1::ImportCatalogResponse again,
                       testing::Call(*stub_, &Stub::ImportCatalog, request));
  EXPECT_EQ(again.unchanged_count(), 300);
  EXPECT_EQ(again.updated_count(), 1);
  request.set_request_id("faulty");
  request.add_items()->set_name("items/one-more");
  const absl::Status refused = testing::Call(*stub_, &Stub::ImportCatalog, request).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(CountItems(*stub_), 300u);
}

// The catalog has written half of it, and waits for a transaction of another that has written one
// of the items too, when it dies.
TEST_F(ImportCatalogPostgresql, KilledMidwayLeavesNothing) {
  const v1::ImportCatalogRequest request = ManyPegs(300);
  auto opened = store::OpenStore({.url = cluster_->url(), .service = "catalog"});
  ASSERT_OK(opened);
  const std::unique_ptr<store::Store> store = *std::move(opened);
  std::promise<void> written, killed;
  std::thread other([&] {
    const absl::Status status = store->Transact([&](store::Transaction& transaction) {
      EXPECT_OK(transaction.Put("items", "peg-150", "another's"));
      written.set_value();
      killed.get_future().wait();
      return absl::AbortedError("nothing is stored");
    });
    EXPECT_TRUE(absl::IsAborted(status)) << status;
  });
  written.get_future().wait();
  std::thread client([&] {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(200));
    v1::ImportCatalogResponse answer;
    EXPECT_FALSE(stub_->ImportCatalog(&context, request, &answer).ok());
  });
  AwaitWaiting();
  process_->Kill();
  client.join();
  killed.set_value();
  other.join();
  process_->Start();
  stub_ = v1::CatalogService::NewStub(process_->channel());
  EXPECT_EQ(CountItems(*stub_), 0u);
  ASSERT_OK_AND_ASSIGN(const v1::ImportCatalogResponse again,
                       testing::Call(*stub_, &Stub::ImportCatalog, request));
  EXPECT_EQ(again.created_count(), 301);
  EXPECT_EQ(CountItems(*stub_), 300u);
}

}  // namespace
}  // namespace mortise::catalog
