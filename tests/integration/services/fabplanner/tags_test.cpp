// The fabplanner as a process: plans and work orders are found by what callers attach to them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/rpc/status_mapping.h"
#include "common/store/store.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/fabplanner/fabplanner_service_fixture.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::fabplanner {
namespace {

using mortise::testing::Call;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;
using Stub = v1::FabPlannerService::Stub;

class FabPlannerTagsTest : public FabPlannerServiceTest {
 protected:
  v1::Plan PlanTableAs(const std::string& external_id, const std::string& project) {
    v1::CreatePlanRequest request = TableRequest();
    request.add_external_ids(external_id);
    (*request.mutable_labels())["project"] = project;
    const v1::Operation operation = CreatePlan(request);
    EXPECT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.error().message();
    EXPECT_EQ(operation.external_ids(0), external_id);
    v1::Plan plan;
    EXPECT_TRUE(operation.result().UnpackTo(&plan));
    EXPECT_EQ(plan.creator(), operation.creator());
    return plan;
  }

  v1::Operation ReleaseAs(const v1::Plan& plan, const std::string& external_id) {
    v1::ReleaseWorkOrderRequest request;
    request.set_request_id(NewRequestId());
    request.set_plan(plan.name());
    request.add_external_ids(external_id);
    (*request.mutable_labels())["shift"] = "early";
    const auto operation = Call(*Planner(), &Stub::ReleaseWorkOrder, request);
    EXPECT_OK(operation);
    return operation.ok() ? *operation : v1::Operation();
  }

  // The names on all pages of one entry.
  std::vector<std::string> Plans(v1::ListPlansRequest request) {
    std::vector<std::string> names;
    request.set_page_size(1);
    do {
      const auto page = Call(*Planner(), &Stub::ListPlans, request);
      EXPECT_OK(page);
      if (!page.ok()) break;
      for (const v1::Plan& plan : page->plans()) names.push_back(plan.name());
      request.set_page_token(page->next_page_token());
    } while (!request.page_token().empty());
    return names;
  }

  std::vector<std::string> Orders(v1::ListWorkOrdersRequest request) {
    std::vector<std::string> names;
    request.set_page_size(1);
    do {
      const auto page = Call(*Planner(), &Stub::ListWorkOrders, request);
      EXPECT_OK(page);
      if (!page.ok()) break;
      for (const v1::WorkOrder& order : page->work_orders()) names.push_back(order.name());
      request.set_page_token(page->next_page_token());
    } while (!request.page_token().empty());
    return names;
  }

  static std::vector<std::string> FieldsAtFault(const absl::Status& status) {
    std::vector<std::string> fields;
    for (const FieldViolation& violation : AllViolationsOf(status)) {
      fields.push_back(violation.field);
    }
    return fields;
  }
};

TEST_F(FabPlannerTagsTest, PlansAreFoundByTheirTags) {
  const v1::Plan first = PlanTableAs("100-4711/A", "loft");
  const v1::Plan second = PlanTableAs("100-4711/B", "loft");
  EXPECT_FALSE(first.creator().empty());
  EXPECT_EQ(first.external_ids(0), "100-4711/A");

  v1::ListPlansRequest request;
  EXPECT_THAT(Plans(request), ElementsAre(second.name(), first.name()));
  request.mutable_filter()->set_external_id("100-4711/A");
  EXPECT_THAT(Plans(request), ElementsAre(first.name()));
  request.Clear();
  (*request.mutable_filter()->mutable_labels())["project"] = "loft";
  EXPECT_THAT(Plans(request), ElementsAre(second.name(), first.name()));
  (*request.mutable_filter()->mutable_labels())["project"] = "shed";
  EXPECT_THAT(Plans(request), IsEmpty());
  request.Clear();
  request.mutable_filter()->set_creator(first.creator());
  EXPECT_EQ(Plans(request).size(), 2u);
  request.mutable_filter()->set_creator("users/nobody");
  EXPECT_THAT(Plans(request), IsEmpty());
  request.Clear();
  *request.mutable_filter()->mutable_created_from() = second.create_time();
  EXPECT_THAT(Plans(request), ElementsAre(second.name()));
  request.Clear();
  *request.mutable_filter()->mutable_created_before() = second.create_time();
  EXPECT_THAT(Plans(request), ElementsAre(first.name()));
  request.Clear();
  request.set_subject("templates/table");
  EXPECT_EQ(Plans(request).size(), 2u);
  request.set_subject("templates/chair");
  EXPECT_THAT(Plans(request), IsEmpty());
}

TEST_F(FabPlannerTagsTest, TagsOfAPlanAreChangedAndSurviveARestart) {
  const v1::Plan plan = PlanTableAs("100-4711/A", "loft");
  v1::UpdatePlanRequest request;
  request.set_request_id(NewRequestId());
  request.mutable_plan()->set_name(plan.name());
  request.mutable_plan()->set_creator("users/eve");
  (*request.mutable_plan()->mutable_labels())["project"] = "shed";
  request.mutable_update_mask()->add_paths("labels");
  const auto updated = Call(*Planner(), &Stub::UpdatePlan, request);
  ASSERT_OK(updated);
  EXPECT_EQ(updated->labels().at("project"), "shed");
  EXPECT_EQ(updated->external_ids(0), "100-4711/A");
  EXPECT_EQ(updated->creator(), plan.creator());
  EXPECT_EQ(updated->boards_size(), plan.boards_size()) << "nothing else of it";
  EXPECT_EQ(EventsUntil(plan.name(), "plan.updated")["plan.updated"], 1);

  process_.Kill();
  process_.Start();
  v1::ListPlansRequest list;
  (*list.mutable_filter()->mutable_labels())["project"] = "shed";
  EXPECT_THAT(Plans(list), ElementsAre(plan.name()));
  v1::GetPlanRequest get;
  get.set_name(plan.name());
  EXPECT_EQ(Call(*Planner(), &Stub::GetPlan, get)->labels().at("project"), "shed");
}

TEST_F(FabPlannerTagsTest, WorkOrdersAreFoundByTagsPlanAndState) {
  const v1::Plan plan = PlanTableAs("100-4711/A", "loft");
  const v1::Plan other = PlanTable();
  const v1::Operation first = ReleaseAs(plan, "FA-1");
  const v1::Operation second = ReleaseAs(other, "FA-2");
  EXPECT_EQ(first.external_ids(0), "FA-1");
  const v1::WorkOrder order = GetOrder(first.subject());
  EXPECT_EQ(order.external_ids(0), "FA-1");
  EXPECT_EQ(order.labels().at("shift"), "early");
  EXPECT_EQ(order.creator(), first.creator());
  v1::HoldWorkOrderRequest hold;
  hold.set_request_id(NewRequestId());
  hold.set_name(second.subject());
  ASSERT_OK(Call(*Planner(), &Stub::HoldWorkOrder, hold));

  v1::ListWorkOrdersRequest request;
  EXPECT_THAT(Orders(request), ElementsAre(second.subject(), first.subject()));
  request.set_subject(plan.name());
  EXPECT_THAT(Orders(request), ElementsAre(first.subject()));
  request.Clear();
  request.add_states(v1::WorkOrder::HELD);
  EXPECT_THAT(Orders(request), ElementsAre(second.subject()));
  request.add_states(v1::WorkOrder::RELEASED);
  EXPECT_EQ(Orders(request).size(), 2u);
  request.mutable_filter()->set_external_id("FA-1");
  EXPECT_THAT(Orders(request), ElementsAre(first.subject()));
  request.set_states(1, v1::WorkOrder::CANCELLED);
  EXPECT_THAT(Orders(request), IsEmpty());

  // What started them is found by the same number.
  v1::ListOperationsRequest operations;
  operations.mutable_filter()->set_external_id("FA-2");
  const auto found = Call(*v1::OperationService::NewStub(process_.channel()),
                          &v1::OperationService::Stub::ListOperations, operations);
  ASSERT_OK(found);
  ASSERT_EQ(found->operations_size(), 1);
  EXPECT_EQ(found->operations(0).name(), second.name());
}

TEST_F(FabPlannerTagsTest, TagsOfAnOrderChangeWhileItIsCut) {
  const v1::Operation released = ReleaseAs(PlanTable(), "FA-1");
  const auto label = [&](int number) {
    v1::UpdateWorkOrderRequest request;
    request.set_request_id(NewRequestId());
    request.mutable_work_order()->set_name(released.subject());
    (*request.mutable_work_order()->mutable_labels())["number"] = std::to_string(number);
    request.mutable_update_mask()->add_paths("labels");
    return Call(*Planner(), &Stub::UpdateWorkOrder, request);
  };
  FakeBridge bridge("north");
  for (int cuts = 3; cuts < kTableCuts; cuts += 3) {
    bridge.Connect(process_.address(), {.cuts_before_silence = cuts});
    ASSERT_OK(label(cuts));
    ASSERT_TRUE(bridge.WaitUntil([&](FakeBridge& b) { return b.effects() >= cuts; }));
    bridge.Disconnect();
  }
  const auto labelled = label(100);
  ASSERT_OK(labelled);
  EXPECT_EQ(labelled->cuts_size(), kTableCuts) << "whole, as after a pause";
  bridge.Connect(process_.address());
  const v1::Operation done = Wait(released);
  ASSERT_EQ(done.state(), v1::Operation::SUCCEEDED) << done.error().message();
  v1::WorkOrder order;
  ASSERT_TRUE(done.result().UnpackTo(&order));
  EXPECT_EQ(order.state(), v1::WorkOrder::COMPLETED);
  EXPECT_EQ(order.cuts_done(), kTableCuts);
  EXPECT_EQ(order.external_ids(0), "FA-1");
  EXPECT_EQ(order.labels().at("number"), "100");
  EXPECT_EQ(done.labels().at("shift"), "early") << "the operation keeps what started it";
  bridge.Disconnect();
  ExpectEachCutOnce(bridge);
}

TEST_F(FabPlannerTagsTest, AllThatIsWrongIsToldAndNothingIsMade) {
  v1::CreatePlanRequest create = TableRequest();
  create.set_quantity(-1);
  create.add_external_ids("100-4711/A");
  create.add_external_ids("100-4711/A");
  (*create.mutable_labels())["-"] = "x";
  EXPECT_THAT(FieldsAtFault(Call(*Planner(), &Stub::CreatePlan, create).status()),
              UnorderedElementsAre("quantity", "external_ids[1]", "labels"));
  EXPECT_THAT(Plans({}), IsEmpty());

  v1::ReleaseWorkOrderRequest release;
  release.set_request_id(NewRequestId());
  release.set_plan("tables/x");
  release.add_external_ids("");
  EXPECT_THAT(FieldsAtFault(Call(*Planner(), &Stub::ReleaseWorkOrder, release).status()),
              UnorderedElementsAre("plan", "external_ids[0]"));
  EXPECT_THAT(Orders({}), IsEmpty());

  v1::ListPlansRequest plans;
  plans.set_page_size(-1);
  plans.set_subject("plans/p1");
  plans.mutable_filter()->set_creator(std::string(201, 'x'));
  EXPECT_THAT(FieldsAtFault(Call(*Planner(), &Stub::ListPlans, plans).status()),
              UnorderedElementsAre("page_size", "subject", "filter.creator"));

  v1::ListWorkOrdersRequest orders;
  orders.set_subject("templates/table");
  orders.add_states(v1::WorkOrder::HELD);
  orders.add_states(v1::WorkOrder::STATE_UNSPECIFIED);
  (*orders.mutable_filter()->mutable_labels())[""] = "x";
  EXPECT_THAT(FieldsAtFault(Call(*Planner(), &Stub::ListWorkOrders, orders).status()),
              UnorderedElementsAre("subject", "states[1]", "filter.labels"));
  orders.Clear();
  orders.add_states(static_cast<v1::WorkOrder::State>(77));
  EXPECT_THAT(FieldsAtFault(Call(*Planner(), &Stub::ListWorkOrders, orders).status()),
              ElementsAre("states[0]"));

  v1::UpdateWorkOrderRequest update;
  update.set_request_id(NewRequestId());
  update.mutable_work_order()->set_name("plans/p1");
  update.mutable_work_order()->add_external_ids("a\n");
  update.mutable_update_mask()->add_paths("state");
  EXPECT_THAT(FieldsAtFault(Call(*Planner(), &Stub::UpdateWorkOrder, update).status()),
              UnorderedElementsAre("work_order.name", "update_mask", "work_order.external_ids[0]"));
  update.Clear();
  update.set_request_id(NewRequestId());
  update.mutable_work_order()->set_name("workOrders/none");
  EXPECT_TRUE(absl::IsNotFound(Call(*Planner(), &Stub::UpdateWorkOrder, update).status()));
}

// As an earlier version wrote them: without tags, creator and whatever came later.
TEST_F(FabPlannerTagsTest, RecordsOfAnEarlierVersionAreListedAndChanged) {
  mortise::testing::TemporaryFolder state;
  {
    const auto store =
        store::OpenStore({.url = "sqlite:" + (state.path() / "store.db").string()}).value();
    v1::Plan plan;
    plan.set_name("plans/p1");
    plan.set_template_("templates/table");
    plan.mutable_create_time()->set_seconds(1'700'000'000);
    v1::WorkOrder order;
    order.set_name("workOrders/o1");
    order.set_plan("plans/p1");
    order.set_state(v1::WorkOrder::COMPLETED);
    ASSERT_OK(store->Transact([&](store::Transaction& transaction) -> absl::Status {
      for (const char* kind : {"plans", "planSummaries"}) {
        MORTISE_RETURN_IF_ERROR(transaction.Put(kind, "p1", plan.SerializeAsString()).status());
      }
      return transaction.Put("workOrders", "o1", order.SerializeAsString()).status();
    }));
  }
  mortise::testing::ServiceUnderTest old(
      "mortise-fabplanner", {"--peer=catalog=" + catalog_.address()}, {}, state.path());
  const auto planner = v1::FabPlannerService::NewStub(old.channel());
  v1::ListPlansRequest list;
  list.set_subject("templates/table");
  list.mutable_filter()->mutable_created_from()->set_seconds(1'700'000'000);
  const auto plans = Call(*planner, &Stub::ListPlans, list);
  ASSERT_OK(plans);
  ASSERT_EQ(plans->plans_size(), 1);
  EXPECT_EQ(plans->plans(0).creator(), "");
  v1::ListWorkOrdersRequest orders;
  orders.add_states(v1::WorkOrder::COMPLETED);
  EXPECT_EQ(Call(*planner, &Stub::ListWorkOrders, orders)->work_orders_size(), 1);

  v1::UpdatePlanRequest update;
  update.set_request_id(NewRequestId());
  update.mutable_plan()->set_name("plans/p1");
  update.mutable_plan()->add_external_ids("100-4711/A");
  ASSERT_OK(Call(*planner, &Stub::UpdatePlan, update));
  list.mutable_filter()->set_external_id("100-4711/A");
  EXPECT_EQ(Call(*planner, &Stub::ListPlans, list)->plans_size(), 1);
}

}  // namespace
}  // namespace mortise::fabplanner
