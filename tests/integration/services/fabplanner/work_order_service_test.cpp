// Work orders of the fabplanner as a process, through a bridge: to their end, and when the process
// is killed, the line drops or the bridge is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <thread>
#include <vector>

#include "tests/integration/services/fabplanner/fabplanner_service_fixture.h"

namespace mortise::fabplanner {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST_F(FabPlannerServiceTest, AWorkOrderRunsToItsEnd) {
  const v1::Operation operation = Release(PlanTable());
  FakeBridge bridge("north");
  bridge.Connect(process_.address());
  const v1::Operation done = Wait(operation);
  ASSERT_EQ(done.state(), v1::Operation::SUCCEEDED) << done.error().message();
  v1::WorkOrder order;
  ASSERT_TRUE(done.result().UnpackTo(&order));
  EXPECT_EQ(order.state(), v1::WorkOrder::COMPLETED);
  EXPECT_EQ(order.cuts_done(), kTableCuts);
  EXPECT_EQ(order.operation(), operation.name());
  ASSERT_EQ(order.cuts_size(), kTableCuts);
  EXPECT_EQ(order.cuts(0).command().machine(), "jigsaw-1");  // by machine and sequence
  for (int i = 1; i < kTableCuts; ++i) {
    EXPECT_EQ(order.cuts(i).command().sequence(), i);
    EXPECT_EQ(order.cuts(i).bridge(), "north");
    EXPECT_EQ(order.cuts(i).state(), v1::WorkOrder::Cut::CUT);
  }
  std::map<std::string, int> events = EventsUntil(order.name(), "workOrder.completed");
  EXPECT_EQ(events["workOrder.released"], 1);
  EXPECT_EQ(events["workOrder.started"], 1);
  EXPECT_EQ(events["cut.ordered"], kTableCuts);
  EXPECT_EQ(events["cut.finished"], kTableCuts);

  v1::ListBridgesResponse bridges;
  auto context = Context();
  ASSERT_TRUE(Planner()->ListBridges(context.get(), {}, &bridges).ok());
  ASSERT_EQ(bridges.bridges_size(), 1);
  EXPECT_TRUE(bridges.bridges(0).attached());
  EXPECT_EQ(bridges.bridges(0).machines_size(), 2);
  EXPECT_EQ(bridges.bridges(0).reports_stored(), kTableCuts);
  bridge.Disconnect();
  ExpectEachCutOnce(bridge);
}

TEST_F(FabPlannerServiceTest, OrdersReleasedHeldAndResumedAtOnceNeverWaitForEachOther) {
  constexpr int kClients = 4;
  constexpr int kOrdersEach = 7;  // together fewer than may be under way
  const v1::Plan plan = PlanTable();
  FakeBridge bridge("north");
  bridge.Connect(process_.address(), {.cuts_before_silence = 1});
  std::vector<std::thread> clients;
  for (int client = 0; client < kClients; ++client) {
    clients.emplace_back([&] {
      for (int i = 0; i < kOrdersEach; ++i) {
        const std::string order = Release(plan).subject();
        v1::HoldWorkOrderRequest hold;
        hold.set_request_id(NewRequestId());
        hold.set_name(order);
        v1::ResumeWorkOrderRequest resume;
        resume.set_request_id(NewRequestId());
        resume.set_name(order);
        v1::WorkOrder answer;
        EXPECT_TRUE(Planner()->HoldWorkOrder(Context().get(), hold, &answer).ok());
        EXPECT_TRUE(Planner()->ResumeWorkOrder(Context().get(), resume, &answer).ok());
      }
    });
  }
  for (std::thread& client : clients) client.join();
  v1::ListWorkOrdersRequest list;
  list.set_page_size(100);
  v1::ListWorkOrdersResponse orders;
  ASSERT_TRUE(Planner()->ListWorkOrders(Context().get(), list, &orders).ok());
  EXPECT_EQ(orders.work_orders_size(), kClients * kOrdersEach);
  bridge.Disconnect();
}

TEST_F(FabPlannerServiceTest, KillsInTheMiddleNeitherLoseNorRepeatACut) {
  const v1::Operation operation = Release(PlanTable());
  FakeBridge bridge("north");
  for (int cuts = 2; cuts < kTableCuts; cuts += 3) {
    bridge.Connect(process_.address(), {.cuts_before_silence = cuts});
    ASSERT_TRUE(bridge.WaitUntil([&](FakeBridge& b) { return b.effects() >= cuts; }));
    process_.Kill();
    bridge.Disconnect();
    process_.Start();
  }
  bridge.Connect(process_.address());
  const v1::Operation done = Wait(operation);
  EXPECT_EQ(done.state(), v1::Operation::SUCCEEDED) << done.error().message();
  bridge.Disconnect();
  ExpectEachCutOnce(bridge);
}

TEST_F(FabPlannerServiceTest, ADroppedLineSendsLostCommandsAgainUnderTheirNumbers) {
  const v1::Operation operation = Release(PlanTable());
  FakeBridge bridge("north");
  bridge.Connect(process_.address(), {.ignores_commands = true});
  ASSERT_TRUE(bridge.WaitUntil([](FakeBridge& b) { return b.commands_received() >= 5; }));
  const v1::WorkOrder before = GetOrder(operation.subject());
  EXPECT_EQ(before.state(), v1::WorkOrder::IN_PROGRESS);
  bridge.Disconnect();
  bridge.Connect(process_.address());
  EXPECT_EQ(Wait(operation).state(), v1::Operation::SUCCEEDED);
  bridge.Disconnect();
  ExpectEachCutOnce(bridge);
  for (const v1::WorkOrder::Cut& cut : before.cuts()) {
    if (cut.state() != v1::WorkOrder::Cut::SENT) continue;
    EXPECT_EQ(bridge.journal().at({cut.command().machine(), cut.command().sequence()}).part(),
              cut.command().part());
  }
}

TEST_F(FabPlannerServiceTest, HoldPausesAndResumeGoesOn) {
  const v1::Operation operation = Release(PlanTable());
  FakeBridge bridge("north");
  bridge.Connect(process_.address(), {.cuts_before_silence = 1});
  ASSERT_TRUE(bridge.WaitUntil([](FakeBridge& b) { return b.effects() >= 1; }));

  v1::HoldWorkOrderRequest hold;
  hold.set_request_id(NewRequestId());
  hold.set_name(operation.subject());
  v1::WorkOrder order;
  auto context = Context();
  ASSERT_TRUE(Planner()->HoldWorkOrder(context.get(), hold, &order).ok());
  EXPECT_EQ(order.state(), v1::WorkOrder::HELD);
  ASSERT_TRUE(bridge.WaitUntil([](FakeBridge& b) { return b.holds() >= 1; }));
  bridge.Disconnect();
  const int holds_before = bridge.holds();
  bridge.Connect(process_.address(), {.cuts_before_silence = 1});  // the pause outlives the line
  ASSERT_TRUE(bridge.WaitUntil([&](FakeBridge& b) { return b.holds() > holds_before; }));
  EXPECT_EQ(bridge.resumes(), 0);
  bridge.Disconnect();  // a person resumes while the bridge is away

  v1::ResumeWorkOrderRequest resume;
  resume.set_request_id(NewRequestId());
  resume.set_name(operation.subject());
  context = Context();
  ASSERT_TRUE(Planner()->ResumeWorkOrder(context.get(), resume, &order).ok());
  EXPECT_EQ(order.state(), v1::WorkOrder::IN_PROGRESS);
  bridge.Connect(process_.address());
  ASSERT_TRUE(bridge.WaitUntil([](FakeBridge& b) { return b.resumes() >= 1; }));
  EXPECT_EQ(Wait(operation).state(), v1::Operation::SUCCEEDED);
  bridge.Disconnect();
  ExpectEachCutOnce(bridge);
}

TEST_F(FabPlannerServiceTest, AHeldMachineIsToldWithItsReason) {
  const v1::Operation operation = Release(PlanTable());
  auto stub = v1::OperationService::NewStub(process_.channel());
  v1::WatchOperationRequest watch;
  watch.set_name(operation.name());
  auto context = Context();
  const auto told = stub->WatchOperation(context.get(), watch);
  const auto wait_for = [&told](auto is_it) {
    for (v1::Operation now; told->Read(&now);) {
      if (is_it(now.progress().message())) return true;
    }
    return false;
  };

  FakeBridge bridge("north");
  bridge.Connect(process_.address(), {.cuts_before_silence = 1});
  ASSERT_TRUE(bridge.WaitUntil([](FakeBridge& b) { return b.effects() >= 1; }));
  bridge.TellSaw("HELD", "the line was down");
  const std::string held = "saw-1 of north is HELD: the line was down";
  EXPECT_TRUE(wait_for([&](const std::string& text) { return text.find(held) != text.npos; }));
  const v1::WorkOrder order = GetOrder(operation.subject());
  ASSERT_EQ(order.held_machines_size(), 1);
  EXPECT_EQ(order.held_machines(0).bridge(), "north");
  EXPECT_EQ(order.held_machines(0).machine().name(), "saw-1");
  EXPECT_EQ(order.held_machines(0).machine().held_because(), "the line was down");

  bridge.TellSaw("EXECUTE", "");
  EXPECT_TRUE(wait_for([&](const std::string& text) { return text.find("HELD") == text.npos; }));
  EXPECT_EQ(GetOrder(operation.subject()).held_machines_size(), 0);
  context->TryCancel();
}

TEST_F(FabPlannerServiceTest, TheAlarmOfAMachineWithoutOrdersIsClearedByItsName) {
  const auto clear = [this](const std::string& machine, const std::string& bridge) {
    v1::ResumeWorkOrderRequest request;
    request.set_request_id(NewRequestId());
    request.set_machine(machine);
    request.set_bridge(bridge);
    v1::WorkOrder answer;
    auto context = Context();
    const grpc::Status status = Planner()->ResumeWorkOrder(context.get(), request, &answer);
    return std::pair(status, answer);
  };
  EXPECT_EQ(clear("saw-1", "").first.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(clear("no name/", "").first.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(clear("saw-1", "No Name").first.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(clear("", "north").first.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  const auto there = [this](int count) {
    return [this, count](FakeBridge&) {
      v1::ListBridgesResponse bridges;
      auto context = Context();
      return Planner()->ListBridges(context.get(), {}, &bridges).ok() &&
             bridges.bridges_size() == count;
    };
  };
  FakeBridge bridge("north");
  bridge.Connect(process_.address(), {.alarm_of_saw = "it jumped"});
  ASSERT_TRUE(bridge.WaitUntil(there(1)));
  FakeBridge other("south");
  other.Connect(process_.address());
  ASSERT_TRUE(other.WaitUntil(there(2)));
  EXPECT_EQ(clear("saw-1", "").first.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  const grpc::Status without = clear("saw-1", "south").first;
  EXPECT_EQ(without.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(without.error_message(), HasSubstr("has not raised the alarm"));
  const auto [status, answer] = clear("saw-1", "north");
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(answer.held_machines_size(), 1);
  EXPECT_EQ(answer.held_machines(0).machine().held_because(), "it jumped");
  EXPECT_TRUE(bridge.WaitUntil([](FakeBridge& b) { return !b.cleared().empty(); }));
  bridge.Disconnect();
  EXPECT_EQ(bridge.cleared(), std::vector<std::string>{"saw-1"});
  EXPECT_EQ(bridge.resumes(), 0);
}

// Nobody could have looked at it.
TEST_F(FabPlannerServiceTest, AnEarlierResumeClearsNoAlarmThatRoseMeanwhile) {
  const v1::Operation operation = Release(PlanTable());
  FakeBridge bridge("north");
  bridge.Connect(process_.address(), {.cuts_before_silence = 1});
  ASSERT_TRUE(bridge.WaitUntil([](FakeBridge& b) { return b.effects() >= 1; }));
  bridge.Disconnect();
  v1::ResumeWorkOrderRequest resume;
  resume.set_request_id(NewRequestId());
  resume.set_name(operation.subject());
  v1::WorkOrder order;
  auto context = Context();
  ASSERT_TRUE(Planner()->ResumeWorkOrder(context.get(), resume, &order).ok());
  bridge.Connect(process_.address(), {.cuts_before_silence = 1, .alarm_of_saw = "it jumped"});
  // What is told at attaching comes before what is asked for later.
  ASSERT_TRUE(bridge.WaitUntil([this, &operation](FakeBridge&) {
    const v1::WorkOrder now = GetOrder(operation.subject());
    return now.held_machines_size() == 1 && now.held_machines(0).machine().alarm();
  }));
  EXPECT_EQ(bridge.resumes(), 0);
  resume.set_request_id(NewRequestId());
  context = Context();
  ASSERT_TRUE(Planner()->ResumeWorkOrder(context.get(), resume, &order).ok());
  ASSERT_TRUE(bridge.WaitUntil([](FakeBridge& b) { return b.resumes() >= 1; }));
  bridge.Disconnect();
  EXPECT_EQ(bridge.resumes(), 1);
}

TEST_F(FabPlannerServiceTest, AFailedCutFailsTheOrderAndHoldsTheBridge) {
  const v1::Operation operation = Release(PlanTable());
  FakeBridge bridge("north");
  bridge.Connect(process_.address(), {.cuts_before_silence = 4, .fails_at_part = "apron_front"});
  const v1::Operation done = Wait(operation);
  EXPECT_EQ(done.state(), v1::Operation::FAILED);
  EXPECT_THAT(done.error().message(), AllOf(HasSubstr("apron_front"), HasSubstr("stalled")));
  EXPECT_TRUE(bridge.WaitUntil([](FakeBridge& b) { return b.holds() >= 1; }));
  EXPECT_EQ(GetOrder(operation.subject()).state(), v1::WorkOrder::FAILED);
}

TEST_F(FabPlannerServiceTest, CancellingTheOperationCancelsTheOrder) {
  const v1::Operation operation = Release(PlanTable());
  auto stub = v1::OperationService::NewStub(process_.channel());
  v1::CancelOperationRequest cancel;
  cancel.set_request_id(NewRequestId());
  cancel.set_name(operation.name());
  v1::Operation answer;
  auto context = Context();
  ASSERT_TRUE(stub->CancelOperation(context.get(), cancel, &answer).ok());
  EXPECT_EQ(Wait(operation).state(), v1::Operation::CANCELLED);
  EXPECT_EQ(GetOrder(operation.subject()).state(), v1::WorkOrder::CANCELLED);
}

TEST_F(FabPlannerServiceTest, ABridgeThatLostItsJournalIsRefused) {
  const v1::Operation operation = Release(PlanTable());
  FakeBridge bridge("north");
  bridge.Connect(process_.address());
  ASSERT_EQ(Wait(operation).state(), v1::Operation::SUCCEEDED);
  bridge.Disconnect();
  FakeBridge forgetful("north");
  forgetful.Connect(process_.address());
  ASSERT_TRUE(forgetful.WaitUntil([](FakeBridge& b) { return b.finished(); }));
  EXPECT_EQ(forgetful.status().error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(forgetful.status().error_message(), HasSubstr("journal"));
}

TEST_F(FabPlannerServiceTest, ANewerStreamOfTheSameBridgeTakesOver) {
  FakeBridge first("north");
  first.Connect(process_.address());
  ASSERT_TRUE(first.WaitUntil([this](FakeBridge&) {
    v1::ListBridgesResponse bridges;
    auto context = Context();
    return Planner()->ListBridges(context.get(), {}, &bridges).ok() && bridges.bridges_size() == 1;
  }));
  FakeBridge second("north");
  second.Connect(process_.address());
  ASSERT_TRUE(first.WaitUntil([](FakeBridge& b) { return b.finished(); }));
  EXPECT_EQ(first.status().error_code(), grpc::StatusCode::ABORTED);
}

TEST_F(FabPlannerServiceTest, ABridgeMustSayHelloProperly) {
  const auto refused = [this](const v1::BridgeMessage& first) {
    auto context = Context();
    auto stream = Planner()->AttachBridge(context.get());
    stream->Write(first);
    v1::PlannerMessage message;
    while (stream->Read(&message)) {
    }
    return stream->Finish();
  };
  v1::BridgeMessage message;
  message.mutable_command_accepted()->set_sequence(1);
  EXPECT_EQ(refused(message).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  message.mutable_hello()->set_bridge("Not A Name");
  message.mutable_hello()->set_next_report_number(1);
  EXPECT_EQ(refused(message).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  message.mutable_hello()->set_bridge("north");
  message.mutable_hello()->set_next_report_number(-4);
  EXPECT_EQ(refused(message).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  message.mutable_hello()->set_next_report_number(1);
  message.mutable_hello()->add_machines()->set_name("saw");
  EXPECT_EQ(refused(message).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

}  // namespace
}  // namespace mortise::fabplanner
