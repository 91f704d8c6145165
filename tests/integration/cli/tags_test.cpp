// External ids, labels and filters on the command line, against a gateway that the test plays: what
// commands ask for, what they print, and how faults are named.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/commands/command_line.h"
#include "common/base/errors.h"
#include "common/resources/resource_tags.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/gateway.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::json;
using ::testing::ElementsAre;

grpc::Status Refused(const std::string& field) {
  return rpc::ToGrpc(InvalidField(field, "is not to the service's liking"));
}

// Keeps what it is asked, and one resource of a few kinds.
class PlayedCatalog final : public v1::CatalogService::Service {
 public:
  PlayedCatalog() {
    item.set_name("items/bolt");
    item.set_title("Bolt");
    item.set_revision(7);
    (*item.mutable_labels())["draft"] = "";
    table.set_name("templates/table");
    table.set_title("Table");
    table.set_revision(3);
    table.add_parameters()->set_name("length");
  }

  grpc::Status GetItem(grpc::ServerContext*, const v1::GetItemRequest* request,
                       v1::Item* response) override {
    if (request->name() != item.name()) return rpc::ToGrpc(ResourceNotFound(request->name()));
    *response = item;
    return grpc::Status::OK;
  }

  grpc::Status ListItems(grpc::ServerContext*, const v1::ListItemsRequest* request,
                         v1::ListItemsResponse* response) override {
    items_asked.push_back(*request);
    const std::string& id = request->filter().external_id();
    const bool has_id = std::count(item.external_ids().begin(), item.external_ids().end(), id) > 0;
    if (id.empty() || has_id) *response->add_items() = item;
    return grpc::Status::OK;
  }

  grpc::Status UpdateItem(grpc::ServerContext*, const v1::UpdateItemRequest* request,
                          v1::Item* response) override {
    updates.push_back(*request);
    if (request->item().labels().contains("bad")) return Refused("item.labels");
    if (request->item().external_ids_size() > 1) return Refused("item.external_ids[1]");
    resources::UpdateTags(request->item(), request->update_mask(), &item);
    item.set_revision(item.revision() + 1);
    *response = item;
    return grpc::Status::OK;
  }

  grpc::Status GetTemplate(grpc::ServerContext*, const v1::GetTemplateRequest*,
                           v1::Template* response) override {
    *response = table;
    return grpc::Status::OK;
  }

  grpc::Status ListTemplates(grpc::ServerContext*, const v1::ListTemplatesRequest* request,
                             v1::ListTemplatesResponse* response) override {
    templates_asked.push_back(*request);
    *response->add_templates() = table;
    return grpc::Status::OK;
  }

  grpc::Status ImportTemplate(grpc::ServerContext*, const v1::ImportTemplateRequest* request,
                              v1::Template* response) override {
    imports.push_back(*request);
    *response = request->template_();
    response->set_revision(request->expected_revision() + 1);
    return grpc::Status::OK;
  }

  v1::Item item;
  v1::Template table;
  std::vector<v1::ListItemsRequest> items_asked;
  std::vector<v1::ListTemplatesRequest> templates_asked;
  std::vector<v1::UpdateItemRequest> updates;
  std::vector<v1::ImportTemplateRequest> imports;
};

// Fronts on pages of one.
class PlayedPareto final : public v1::ParetoService::Service {
 public:
  PlayedPareto() {
    for (const char* const id : {"3", "2", "1"}) {
      v1::Front& front = fronts.emplace_back();
      front.set_name(absl::StrCat("fronts/", id));
      front.mutable_specification()->set_subject("templates/table");
      front.set_creator("users/ada");
      front.add_external_ids("100-4711/A");
    }
  }

  grpc::Status ListFronts(grpc::ServerContext*, const v1::ListFrontsRequest* request,
                          v1::ListFrontsResponse* response) override {
    asked.push_back(*request);
    if (request->filter().labels().contains("bad")) return Refused("filter.labels");
    if (!request->filter().external_id().empty() &&
        request->filter().external_id() != "100-4711/A") {
      return grpc::Status::OK;
    }
    const std::size_t index = request->page_token().empty() ? 0 : std::stoul(request->page_token());
    *response->add_fronts() = fronts[index];
    if (index + 1 < fronts.size()) response->set_next_page_token(std::to_string(index + 1));
    return grpc::Status::OK;
  }

  grpc::Status GetFront(grpc::ServerContext*, const v1::GetFrontRequest*,
                        v1::Front* response) override {
    *response = fronts[0];
    return grpc::Status::OK;
  }

  grpc::Status UpdateFront(grpc::ServerContext*, const v1::UpdateFrontRequest* request,
                           v1::Front* response) override {
    updates.push_back(*request);
    resources::UpdateTags(request->front(), request->update_mask(), &fronts[0]);
    *response = fronts[0];
    return grpc::Status::OK;
  }

  grpc::Status DiscoverFront(grpc::ServerContext*, const v1::DiscoverFrontRequest* request,
                             v1::Operation* response) override {
    discoveries.push_back(*request);
    if (request->labels().contains("bad")) return Refused("labels");
    response->set_name("operations/pareto/1");
    return grpc::Status::OK;
  }

  std::vector<v1::Front> fronts;
  std::vector<v1::ListFrontsRequest> asked;
  std::vector<v1::UpdateFrontRequest> updates;
  std::vector<v1::DiscoverFrontRequest> discoveries;
};

class PlayedFabPlanner final : public v1::FabPlannerService::Service {
 public:
  grpc::Status ListWorkOrders(grpc::ServerContext*, const v1::ListWorkOrdersRequest* request,
                              v1::ListWorkOrdersResponse* response) override {
    asked.push_back(*request);
    response->add_work_orders()->set_name("workOrders/1");
    return grpc::Status::OK;
  }

  grpc::Status CreatePlan(grpc::ServerContext*, const v1::CreatePlanRequest* request,
                          v1::Operation* response) override {
    plans.push_back(*request);
    response->set_name("operations/fabplanner/1");
    return grpc::Status::OK;
  }

  // Refuses a second external id where there is no label.
  grpc::Status ReleaseWorkOrder(grpc::ServerContext*, const v1::ReleaseWorkOrderRequest* request,
                                v1::Operation* response) override {
    releases.push_back(*request);
    if (request->labels().empty()) return Refused("external_ids[1]");
    response->set_name("operations/fabplanner/2");
    return grpc::Status::OK;
  }

  std::vector<v1::ListWorkOrdersRequest> asked;
  std::vector<v1::CreatePlanRequest> plans;
  std::vector<v1::ReleaseWorkOrderRequest> releases;
};

class PlayedSimulator final : public v1::SimulatorService::Service {
 public:
  grpc::Status AnalyzeDesign(grpc::ServerContext*, const v1::AnalyzeDesignRequest* request,
                             v1::Operation* response) override {
    analyses.push_back(*request);
    response->set_name("operations/simulator/1");
    return grpc::Status::OK;
  }

  std::vector<v1::AnalyzeDesignRequest> analyses;
};

// Lets nobody see webhooks.
class PlayedWebhooks final : public v1::WebhookService::Service {
 public:
  grpc::Status ListWebhooks(grpc::ServerContext*, const v1::ListWebhooksRequest*,
                            v1::ListWebhooksResponse*) override {
    return {grpc::StatusCode::PERMISSION_DENIED, "needs an admin"};
  }
};

class PlayedOperations final : public v1::OperationService::Service {
 public:
  grpc::Status ListOperations(grpc::ServerContext*, const v1::ListOperationsRequest* request,
                              v1::ListOperationsResponse*) override {
    asked.push_back(*request);
    return grpc::Status::OK;
  }

  std::vector<v1::ListOperationsRequest> asked;
};

class TagCommands : public ::testing::Test {
 protected:
  TagCommands() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    for (grpc::Service* const service : std::initializer_list<grpc::Service*>{
             &catalog_, &pareto_, &fabplanner_, &simulator_, &webhooks_, &operations_}) {
      builder.RegisterService(service);
    }
    server_ = builder.BuildAndStart();
    session_.gateway.address = "127.0.0.1:" + std::to_string(port);
  }
  ~TagCommands() override { server_->Shutdown(std::chrono::system_clock::now()); }

  absl::StatusOr<Json> Run(const std::vector<std::string>& arguments) {
    Output output(Output::Form::kSilent);
    MORTISE_RETURN_IF_ERROR(RunCommandLine(arguments, session_, output));
    return Json::parse(output.last_document(), nullptr, /*allow_exceptions=*/false);
  }

  // The field that a command's failure names.
  std::string FieldOfFailure(const std::vector<std::string>& arguments) {
    const absl::Status status = Run(arguments).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field;
  }

  PlayedCatalog catalog_;
  PlayedPareto pareto_;
  PlayedFabPlanner fabplanner_;
  PlayedSimulator simulator_;
  PlayedWebhooks webhooks_;
  PlayedOperations operations_;
  std::unique_ptr<grpc::Server> server_;
  Session session_;
};

template <typename Request>
void ExpectTagged(const Request& request) {
  EXPECT_THAT(request.external_ids(), ElementsAre("100-4711/A", "2"));
  EXPECT_EQ(request.labels().size(), 1u);
  EXPECT_EQ(request.labels().at("customer"), "acme");
}

TEST_F(TagCommands, AreGivenToWhatCommandsMake) {
  const std::vector<std::vector<std::string>> commands = {
      {"plan", "table"},
      {"fab", "release", "plans/1"},
      {"analyze", "table"},
      {"pareto", "run", "table", "--minimize", "mass", "--minimize", "cost"}};
  for (std::vector<std::string> command : commands) {
    command.insert(command.end(), {"--external-id", "100-4711/A", "--external-id", "2", "--label",
                                   "customer=acme", "--detach"});
    const auto started = Run(command);
    EXPECT_TRUE(started.ok()) << started.status();
  }
  ASSERT_EQ(fabplanner_.plans.size(), 1u);
  ExpectTagged(fabplanner_.plans[0]);
  ASSERT_EQ(fabplanner_.releases.size(), 1u);
  ExpectTagged(fabplanner_.releases[0]);
  ASSERT_EQ(simulator_.analyses.size(), 1u);
  ExpectTagged(simulator_.analyses[0]);
  ASSERT_EQ(pareto_.discoveries.size(), 1u);
  ExpectTagged(pareto_.discoveries[0]);
}

TEST_F(TagCommands, FaultsOfWhatIsMadeNameTheFlag) {
  EXPECT_EQ(FieldOfFailure({"pareto", "run", "table", "--minimize", "mass", "--label", "bad=1"}),
            "--label");
  EXPECT_EQ(
      FieldOfFailure({"fab", "release", "plans/1", "--external-id", "a", "--external-id", "b"}),
      "--external-id b");
  EXPECT_EQ(FieldOfFailure({"plan", "table", "--label", "customer"}), "--label");
  // Metrics alone make nothing that could be found again.
  EXPECT_EQ(FieldOfFailure({"analyze", "table", "--metric", "mass", "--label", "a=1"}), "--label");
}

TEST_F(TagCommands, FilterLists) {
  const std::vector<std::string> filter = {"--external-id", "x",  "--label",   "customer=acme",
                                           "--label",       "a",  "--creator", "ada",
                                           "--since",       "2h", "--before",  "2200-01-01"};
  const auto run = [&](std::vector<std::string> command) {
    command.insert(command.end(), filter.begin(), filter.end());
    const auto listed = Run(command);
    EXPECT_TRUE(listed.ok()) << listed.status();
  };
  run({"catalog", "list", "items"});
  run({"catalog", "list"});
  run({"operations", "list"});
  run({"list", "fronts", "--subject", "templates/table"});
  run({"list", "work-orders", "--state", "in-progress", "--state", "held"});
  run({"fab", "list"});
  const auto expect_filter = [](const v1::ResourceFilter& asked) {
    EXPECT_EQ(asked.external_id(), "x");
    EXPECT_EQ(asked.labels().at("customer"), "acme");
    EXPECT_EQ(asked.labels().at("a"), "");
    EXPECT_EQ(asked.creator(), "users/ada");
    EXPECT_GT(asked.created_before().seconds(), asked.created_from().seconds());
  };
  ASSERT_EQ(catalog_.items_asked.size(), 1u);
  expect_filter(catalog_.items_asked[0].filter());
  ASSERT_EQ(catalog_.templates_asked.size(), 1u);
  expect_filter(catalog_.templates_asked[0].filter());
  ASSERT_EQ(operations_.asked.size(), 1u);
  expect_filter(operations_.asked[0].filter());
  ASSERT_EQ(pareto_.asked.size(), 1u);
  expect_filter(pareto_.asked[0].filter());
  EXPECT_EQ(pareto_.asked[0].subject(), "templates/table");
  ASSERT_EQ(fabplanner_.asked.size(), 2u);
  expect_filter(fabplanner_.asked[0].filter());
  EXPECT_THAT(fabplanner_.asked[0].states(),
              ElementsAre(v1::WorkOrder::IN_PROGRESS, v1::WorkOrder::HELD));
  expect_filter(fabplanner_.asked[1].filter());
}

TEST_F(TagCommands, ListsHaveAllPagesUpToALimit) {
  const auto names = [](const absl::StatusOr<Json>& list) {
    EXPECT_TRUE(list.ok()) << list.status();
    std::vector<std::string> found;
    for (const Json& entry : list.value_or(Json::array())) found.push_back(entry["name"]);
    return found;
  };
  EXPECT_THAT(names(Run({"list", "fronts"})), ElementsAre("fronts/3", "fronts/2", "fronts/1"));
  EXPECT_EQ(pareto_.asked.size(), 3u);
  EXPECT_THAT(names(Run({"list", "fronts", "--limit", "2"})), ElementsAre("fronts/3", "fronts/2"));
  EXPECT_EQ(pareto_.asked.back().page_size(), 1);
}

TEST_F(TagCommands, FaultsOfListsNameTheFlag) {
  EXPECT_EQ(FieldOfFailure({"list", "fronts", "--label", "bad=1"}), "--label");
  EXPECT_EQ(FieldOfFailure({"list", "fronts", "--since", "yesterday"}), "--since");
  EXPECT_EQ(FieldOfFailure({"list", "fronts", "--state", "held"}), "--state");
  EXPECT_EQ(FieldOfFailure({"list", "workOrders", "--state", "asleep"}), "--state");
  EXPECT_EQ(FieldOfFailure({"list", "items", "--subject", "templates/table"}), "--subject");
  EXPECT_EQ(FieldOfFailure({"list", "chairs"}), "kind");
  EXPECT_EQ(FieldOfFailure({"catalog", "list", "--before", "then"}), "--before");
  EXPECT_EQ(FieldOfFailure({"operations", "list", "--label", "="}), "--label");
}

TEST_F(TagCommands, AreFoundInEveryKindThatMayBeSeen) {
  catalog_.item.add_external_ids("100-4711/A");
  const auto found = Run({"find", "100-4711/A"});
  ASSERT_TRUE(found.ok()) << found.status();
  std::vector<std::string> names;
  for (const Json& entry : *found) names.push_back(entry["name"]);
  EXPECT_THAT(names, ElementsAre("items/bolt", "templates/table", "fronts/3", "fronts/2",
                                 "fronts/1", "workOrders/1"));
  EXPECT_EQ(pareto_.asked[0].filter().external_id(), "100-4711/A");
  EXPECT_TRUE(operations_.asked[0].omit_results());
  EXPECT_EQ(FieldOfFailure({"find", ""}), "external id");
}

TEST_F(TagCommands, OfItemsAreMergedIntoTheRevisionThatWasRead) {
  const auto changed =
      Run({"label", "items/bolt", "customer=acme", "draft-", "--external-id", "100-4711/A"});
  ASSERT_TRUE(changed.ok()) << changed.status();
  EXPECT_EQ(*changed, (Json{{"name", "items/bolt"},
                            {"revision", "8"},
                            {"external_ids", {"100-4711/A"}},
                            {"labels", {{"customer", "acme"}}},
                            {"creator", ""}}));
  ASSERT_EQ(catalog_.updates.size(), 1u);
  const v1::UpdateItemRequest& update = catalog_.updates[0];
  EXPECT_FALSE(update.request_id().empty());
  EXPECT_EQ(update.item().revision(), 7);
  EXPECT_EQ(update.item().title(), "");
  EXPECT_THAT(update.update_mask().paths(), ElementsAre("external_ids", "labels"));
}

TEST_F(TagCommands, OfTemplatesAreTheNextRevisionOfTheSameContent) {
  const auto changed = Run({"label", "templates/table", "customer=acme"});
  ASSERT_TRUE(changed.ok()) << changed.status();
  EXPECT_EQ((*changed)["revision"], "4");
  ASSERT_EQ(catalog_.imports.size(), 1u);
  EXPECT_EQ(catalog_.imports[0].expected_revision(), 3);
  EXPECT_EQ(catalog_.imports[0].template_().title(), "Table");
  EXPECT_EQ(catalog_.imports[0].template_().parameters_size(), 1);
  EXPECT_EQ(catalog_.imports[0].template_().labels().at("customer"), "acme");
}

TEST_F(TagCommands, OfFrontsAreChangedByThemselves) {
  const auto changed =
      Run({"label", "fronts/3", "customer=acme", "--no-external-id", "100-4711/A"});
  ASSERT_TRUE(changed.ok()) << changed.status();
  EXPECT_EQ((*changed)["labels"], Json({{"customer", "acme"}}));
  EXPECT_EQ((*changed)["external_ids"], Json::array());
  ASSERT_EQ(pareto_.updates.size(), 1u);
  EXPECT_FALSE(pareto_.updates[0].front().has_specification());
}

TEST_F(TagCommands, ArePrintedWhereNothingChanges) {
  const auto printed = Run({"label", "items/bolt"});
  ASSERT_TRUE(printed.ok()) << printed.status();
  EXPECT_EQ((*printed)["labels"], Json({{"draft", ""}}));
  ASSERT_TRUE(Run({"label", "items/bolt", "draft=", "absent-"}).ok());
  EXPECT_TRUE(catalog_.updates.empty());
}

TEST_F(TagCommands, FaultsOfChangesNameWhatWasTyped) {
  EXPECT_EQ(FieldOfFailure({"label", "items/bolt", "bad=1"}), "change");
  EXPECT_EQ(FieldOfFailure({"label", "items/bolt", "bad"}), "change");
  EXPECT_EQ(FieldOfFailure({"label", "items/bolt", "--external-id", "a", "--external-id", "b"}),
            "--external-id");
  EXPECT_EQ(FieldOfFailure({"label", "bolt", "a=1"}), "name");
  EXPECT_TRUE(absl::IsNotFound(Run({"label", "items/nut", "a=1"}).status()));
}

}  // namespace
}  // namespace mortise::cli
