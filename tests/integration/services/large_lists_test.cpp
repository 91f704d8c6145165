// Every list of every service, of records so large that a page of a hundred would be more than a
// message: clients get all of them, each once, without asking for smaller pages.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/store/store.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::testing {
namespace {

constexpr int kRecords = 30;
constexpr std::size_t kLarge = 400'000;  // bytes of each

std::string Key(int i) { return absl::StrFormat("r%02d", i); }

class LargeListsTest : public ::testing::Test {
 protected:
  // Writes kRecords, each made by `make(i)`, into the store that the service begins with.
  void Fill(const std::string& kind, const std::function<std::string(int)>& make) {
    const auto store = store::OpenStore({.url = Url(), .blob_folder = folder_.path() / "blobs"});
    ASSERT_TRUE(store.ok()) << store.status();
    for (int i = 0; i < kRecords; ++i) {
      const absl::Status put = (*store)->Transact([&](store::Transaction& transaction) {
        return transaction.Put(kind, Key(i), make(i)).status();
      });
      ASSERT_TRUE(put.ok()) << put;
    }
  }

  std::string Url() const { return "sqlite:" + (folder_.path() / "store.db").string(); }

  void Start(const std::string& program, const std::vector<std::string>& flags = {}) {
    service_ = std::make_unique<ServiceUnderTest>(program, flags, "", folder_.path());
  }

  // Reads the whole list as anybody calls it, without a page size.
  template <class Service, class Request, class Response, class Entries>
  void ExpectEachOnce(grpc::Status (Service::Stub::*method)(grpc::ClientContext*, const Request&,
                                                            Response*),
                      const Entries& entries, bool newest_first) {
    const auto stub = Service::NewStub(service_->channel());
    std::vector<std::string> names;
    Request request;
    int pages = 0;
    do {
      const absl::StatusOr<Response> page = Call(*stub, method, request);
      ASSERT_TRUE(page.ok()) << page.status();
      EXPECT_LT(page->ByteSizeLong(), std::size_t{3} << 20);
      for (const auto& entry : entries(*page)) names.push_back(entry.name());
      request.set_page_token(page->next_page_token());
      ASSERT_LE(++pages, kRecords);
    } while (!request.page_token().empty());
    EXPECT_GT(pages, 1);
    EXPECT_EQ(names.size(), static_cast<std::size_t>(kRecords));
    if (newest_first) std::reverse(names.begin(), names.end());
    EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
    EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
    request.set_page_size(1001);
    const absl::Status refused = Call(*stub, method, request).status();
    EXPECT_EQ(refused.message(), "page_size: must be 0 to 1000");
  }

  TemporaryFolder folder_;
  std::unique_ptr<ServiceUnderTest> service_;
};

template <class Message>
std::string Titled(const std::string& name) {
  Message message;
  message.set_name(name);
  message.set_title(std::string(kLarge, 'x'));
  return message.SerializeAsString();
}

TEST_F(LargeListsTest, OfTheCatalog) {
  Fill("materials", [](int i) { return Titled<v1::Material>("materials/" + Key(i)); });
  Fill("items", [](int i) { return Titled<v1::Item>("items/" + Key(i)); });
  Fill("templates", [](int i) {
    v1::TemplateBundle bundle;
    bundle.mutable_template_()->set_name("templates/" + Key(i));
    bundle.mutable_template_()->set_description(std::string(kLarge, 'x'));
    return bundle.SerializeAsString();
  });
  Fill("assemblies", [](int i) {
    v1::AssemblyBundle bundle;
    bundle.mutable_assembly()->set_name("assemblies/" + Key(i));
    bundle.mutable_assembly()->set_description(std::string(kLarge, 'x'));
    return bundle.SerializeAsString();
  });
  Start("mortise-catalog");
  using Catalog = v1::CatalogService;
  ExpectEachOnce<Catalog>(
      &Catalog::Stub::ListMaterials,
      [](const v1::ListMaterialsResponse& page) { return page.materials(); }, false);
  ExpectEachOnce<Catalog>(
      &Catalog::Stub::ListItems, [](const v1::ListItemsResponse& page) { return page.items(); },
      false);
  ExpectEachOnce<Catalog>(
      &Catalog::Stub::ListTemplates,
      [](const v1::ListTemplatesResponse& page) { return page.templates(); }, false);
  ExpectEachOnce<v1::AssemblyService>(
      &v1::AssemblyService::Stub::ListAssemblies,
      [](const v1::ListAssembliesResponse& page) { return page.assemblies(); }, false);
}

TEST_F(LargeListsTest, OfTheSimulator) {
  Fill("analyses", [](int i) { return Titled<v1::Analysis>("analyses/" + Key(i)); });
  Fill("evaluators", [](int i) { return Titled<v1::Evaluator>("evaluators/" + Key(i)); });
  Start("mortise-simulator", {"--peer=catalog=127.0.0.1:1"});
  ExpectEachOnce<v1::SimulatorService>(
      &v1::SimulatorService::Stub::ListAnalyses,
      [](const v1::ListAnalysesResponse& page) { return page.analyses(); }, true);
  ExpectEachOnce<v1::EvaluatorService>(
      &v1::EvaluatorService::Stub::ListEvaluators,
      [](const v1::ListEvaluatorsResponse& page) { return page.evaluators(); }, false);
}

TEST_F(LargeListsTest, OfTasks) {
  {
    const auto store = store::OpenStore({.url = Url(), .blob_folder = folder_.path() / "blobs"});
    ASSERT_TRUE(store.ok()) << store.status();
    for (int i = 0; i < kRecords; ++i) {
      v1::Task task;
      task.set_subject(std::string(kLarge, 'x'));
      const absl::Status queued = (*store)->Transact([&](store::Transaction& transaction) {
        return transaction.EnqueueTask(
            {.queue = "simulator", .key = Key(i), .payload = task.SerializeAsString()});
      });
      ASSERT_TRUE(queued.ok()) << queued;
    }
  }
  Start("mortise-simulator", {"--peer=catalog=127.0.0.1:1"});
  ExpectEachOnce<v1::SimulatorService>(
      &v1::SimulatorService::Stub::ListTasks,
      [](const v1::ListTasksResponse& page) {
        std::vector<v1::Task> tasks;
        for (const auto& entry : page.tasks()) tasks.push_back(entry.task());
        return tasks;
      },
      false);
}

TEST_F(LargeListsTest, OfFronts) {
  Fill("fronts", [](int i) {
    v1::Front front;
    front.set_name("fronts/" + Key(i));
    front.add_remarks(std::string(kLarge, 'x'));
    return front.SerializeAsString();
  });
  Start("mortise-pareto", {"--peer=simulator=127.0.0.1:1"});
  ExpectEachOnce<v1::ParetoService>(
      &v1::ParetoService::Stub::ListFronts,
      [](const v1::ListFrontsResponse& page) { return page.fronts(); }, true);
}

TEST_F(LargeListsTest, OfPlansAndWorkOrders) {
  Fill("planSummaries", [](int i) {
    v1::Plan plan;
    plan.set_name("plans/" + Key(i));
    plan.add_handwork(std::string(kLarge, 'x'));
    return plan.SerializeAsString();
  });
  Fill("workOrders", [](int i) {
    v1::WorkOrder order;
    order.set_name("workOrders/" + Key(i));
    order.set_state(v1::WorkOrder::COMPLETED);
    order.add_handwork(std::string(kLarge, 'x'));
    return order.SerializeAsString();
  });
  Start("mortise-fabplanner", {"--peer=catalog=127.0.0.1:1"});
  using Planner = v1::FabPlannerService;
  ExpectEachOnce<Planner>(
      &Planner::Stub::ListPlans, [](const v1::ListPlansResponse& page) { return page.plans(); },
      true);
  ExpectEachOnce<Planner>(
      &Planner::Stub::ListWorkOrders,
      [](const v1::ListWorkOrdersResponse& page) { return page.work_orders(); }, true);
}

// A record that cannot be read is told, not shown as an empty one.
TEST_F(LargeListsTest, NameARecordThatIsDamaged) {
  Fill("analyses", [](int i) {
    return i == 7 ? std::string("\xff\xff damaged") : Titled<v1::Analysis>("analyses/" + Key(i));
  });
  Start("mortise-simulator", {"--peer=catalog=127.0.0.1:1"});
  const auto stub = v1::SimulatorService::NewStub(service_->channel());
  v1::ListAnalysesRequest request;
  absl::Status failure;
  do {
    const auto page = Call(*stub, &v1::SimulatorService::Stub::ListAnalyses, request);
    failure = page.status();
    if (page.ok()) request.set_page_token(page->next_page_token());
  } while (failure.ok() && !request.page_token().empty());
  EXPECT_EQ(failure.code(), absl::StatusCode::kInternal) << failure;
  EXPECT_NE(failure.message().find("analyses/r07"), absl::string_view::npos) << failure;
}

}  // namespace
}  // namespace mortise::testing
