// The fabplanner as a process: plans, work orders through a bridge, and what happens when the
// process is killed, the line drops or the input is bad.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "common/base/digest.h"
#include "google/rpc/status.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/integration/services/fabplanner/fake_bridge.h"
#include "tests/integration/services/fabplanner/fake_catalog.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::fabplanner {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kTableCuts = 4 + 8 + 1;  // trims of four boards, crosscuts, the top

class FabPlannerServiceTest : public ::testing::Test {
 protected:
  std::unique_ptr<v1::FabPlannerService::Stub> Planner() {
    return v1::FabPlannerService::NewStub(process_.channel());
  }

  static std::unique_ptr<grpc::ClientContext> Context() {
    auto context = std::make_unique<grpc::ClientContext>();
    context->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
    return context;
  }

  static std::string NewRequestId() {
    static int count = 0;
    return "request-" + std::to_string(++count);
  }

  static v1::CreatePlanRequest TableRequest() {
    v1::CreatePlanRequest request;
    request.set_request_id(NewRequestId());
    request.set_template_("templates/table");
    return request;
  }

  v1::Operation Wait(const v1::Operation& started) {
    auto stub = v1::OperationService::NewStub(process_.channel());
    v1::WaitOperationRequest request;
    request.set_name(started.name());
    request.set_timeout_seconds(50);
    v1::Operation operation;
    auto context = Context();
    const grpc::Status status = stub->WaitOperation(context.get(), request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return operation;
  }

  v1::Operation CreatePlan(const v1::CreatePlanRequest& request) {
    v1::Operation operation;
    auto context = Context();
    const grpc::Status status = Planner()->CreatePlan(context.get(), request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return Wait(operation);
  }

  v1::Plan PlanTable() {
    const v1::Operation operation = CreatePlan(TableRequest());
    EXPECT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.error().message();
    v1::Plan plan;
    EXPECT_TRUE(operation.result().UnpackTo(&plan));
    return plan;
  }

  v1::Operation Release(const v1::Plan& plan) {
    v1::ReleaseWorkOrderRequest request;
    request.set_request_id(NewRequestId());
    request.set_plan(plan.name());
    v1::Operation operation;
    auto context = Context();
    const grpc::Status status = Planner()->ReleaseWorkOrder(context.get(), request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return operation;
  }

  v1::WorkOrder GetOrder(const std::string& name) {
    v1::GetWorkOrderRequest request;
    request.set_name(name);
    v1::WorkOrder order;
    auto context = Context();
    const grpc::Status status = Planner()->GetWorkOrder(context.get(), request, &order);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return order;
  }

  std::string Download(const v1::Plan& plan, const std::string& file_name, std::string* sha256) {
    v1::DownloadArtifactRequest request;
    request.set_name(plan.name());
    request.set_file_name(file_name);
    auto context = Context();
    auto stream = Planner()->DownloadArtifact(context.get(), request);
    std::string bytes;
    for (v1::Chunk chunk; stream->Read(&chunk);) {
      EXPECT_EQ(chunk.offset(), static_cast<int64_t>(bytes.size()));
      if (chunk.offset() == 0) *sha256 = chunk.sha256();
      bytes += chunk.data();
    }
    const grpc::Status status = stream->Finish();
    EXPECT_TRUE(status.ok()) << status.error_message();
    return bytes;
  }

  // How often each type of event was told of a subject, as soon as `last_type` has been.
  std::map<std::string, int> EventsUntil(const std::string& subject, const std::string& last_type) {
    auto stub = v1::EventService::NewStub(process_.channel());
    v1::FollowEventsRequest request;
    auto context = Context();
    auto stream = stub->FollowEvents(context.get(), request);
    std::map<std::string, int> counts;
    for (v1::Event event; stream->Read(&event);) {
      if (event.subject() == subject) ++counts[event.type()];
      if (event.subject() == subject && event.type() == last_type) break;
    }
    context->TryCancel();
    stream->Finish();
    return counts;
  }

  static void ExpectEachCutOnce(const FakeBridge& bridge) {
    EXPECT_EQ(bridge.parts_cut().size(), kTableCuts);
    for (const auto& [part, times] : bridge.parts_cut()) EXPECT_EQ(times, 1) << part;
    EXPECT_EQ(bridge.contradictions(), 0);
  }

  FakeCatalog catalog_;
  testing::ServiceUnderTest process_{"mortise-fabplanner",
                                     {"--peer=catalog=" + catalog_.address()}};
};

TEST_F(FabPlannerServiceTest, PlansATableWithItsFiles) {
  const v1::Plan plan = PlanTable();
  EXPECT_EQ(plan.template_(), "templates/table");
  EXPECT_EQ(plan.template_revision(), 3);
  EXPECT_EQ(plan.chop_saw_parts(), 8);
  EXPECT_EQ(plan.jigsaw_parts(), 1);
  EXPECT_EQ(plan.pegs(), 22);
  EXPECT_EQ(plan.steps_size(), 3);
  EXPECT_DOUBLE_EQ(plan.rules().kerf(), 0.003);
  EXPECT_DOUBLE_EQ(plan.total().amount(), 121.88);
  EXPECT_EQ(plan.parameters(0).name(), "length");
  ASSERT_EQ(plan.artifacts_size(), 6 + 3 + 1);
  for (const v1::Artifact& artifact : plan.artifacts()) {
    std::string sha256;
    const std::string bytes = Download(plan, artifact.file_name(), &sha256);
    EXPECT_EQ(static_cast<int64_t>(bytes.size()), artifact.size()) << artifact.file_name();
    EXPECT_EQ(sha256, artifact.sha256());
    EXPECT_EQ(Sha256Hex(bytes), artifact.sha256());
  }
  std::string sha256;
  EXPECT_THAT(Download(plan, "assembly-guide.html", &sha256), HasSubstr("<h1>Table</h1>"));
  EXPECT_EQ(plan.steps(2).picture(), "step-3.png");

  v1::ListPlansResponse list;
  auto context = Context();
  ASSERT_TRUE(Planner()->ListPlans(context.get(), {}, &list).ok());
  ASSERT_EQ(list.plans_size(), 1);
  EXPECT_EQ(list.plans(0).name(), plan.name());
  EXPECT_EQ(list.plans(0).boards_size(), 0);
  EXPECT_EQ(EventsUntil(plan.name(), "plan.created")["plan.created"], 1);
}

TEST_F(FabPlannerServiceTest, ARepeatedRequestMakesOnePlan) {
  const v1::CreatePlanRequest request = TableRequest();
  EXPECT_EQ(CreatePlan(request).name(), CreatePlan(request).name());
}

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

TEST_F(FabPlannerServiceTest, BadPlansAreRefusedWithTheFieldAtFault) {
  const auto refused = [this](const v1::CreatePlanRequest& request) {
    v1::Operation operation;
    auto context = Context();
    const grpc::Status status = Planner()->CreatePlan(context.get(), request, &operation);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
    google::rpc::Status details;
    EXPECT_TRUE(details.ParseFromString(status.error_details()));
    return status.error_details();  // names the field in its BadRequest
  };
  v1::CreatePlanRequest request = TableRequest();
  request.mutable_rules()->set_kerf(std::nan(""));
  EXPECT_THAT(refused(request), HasSubstr("rules.kerf"));
  request = TableRequest();
  request.mutable_rules()->set_board_trim(-0.01);
  EXPECT_THAT(refused(request), HasSubstr("rules.board_trim"));
  request = TableRequest();
  request.set_quantity(1001);
  EXPECT_THAT(refused(request), HasSubstr("quantity"));
  request = TableRequest();
  request.set_quantity(-1);
  EXPECT_THAT(refused(request), HasSubstr("quantity"));
  request = TableRequest();
  request.set_template_("tables/../x");
  EXPECT_THAT(refused(request), HasSubstr("template"));
  request = TableRequest();
  request.clear_request_id();
  EXPECT_THAT(refused(request), HasSubstr("request_id"));

  request = TableRequest();
  request.set_template_("templates/none");
  v1::Operation unknown;
  auto asking = Context();
  EXPECT_EQ(Planner()->CreatePlan(asking.get(), request, &unknown).error_code(),
            grpc::StatusCode::NOT_FOUND);

  v1::ListPlansResponse list;
  auto context = Context();
  ASSERT_TRUE(Planner()->ListPlans(context.get(), {}, &list).ok());
  EXPECT_EQ(list.plans_size(), 0);
}

TEST_F(FabPlannerServiceTest, PlansWhatScrewsHoldTogether) {
  v1::CreatePlanRequest request = TableRequest();
  request.set_template_("templates/screwed");
  const v1::Operation operation = CreatePlan(request);
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.error().message();
  v1::Plan plan;
  ASSERT_TRUE(operation.result().UnpackTo(&plan));
  ASSERT_EQ(plan.parts_size(), 8);
  EXPECT_EQ(plan.parts(0).making(), v1::PlannedPart::OUTLINE);
  EXPECT_EQ(plan.parts(3).making(), v1::PlannedPart::BOUGHT);
  EXPECT_TRUE(plan.parts(3).connecting());
  EXPECT_EQ(plan.holes_size(), 2 * 4);
  int screws = 0;
  for (const v1::AssemblyStep& step : plan.steps()) screws += step.connectors_size();
  EXPECT_EQ(screws, 4);
  ASSERT_EQ(plan.totals_size(), 1);
  EXPECT_EQ(plan.total().amount(), plan.totals(0).amount());
  std::string sha256;
  EXPECT_THAT(Download(plan, "holes.csv", &sha256), HasSubstr("shelf 2 screw right"));

  // What no machine does goes with the order.
  const v1::WorkOrder order = GetOrder(Release(plan).subject());
  EXPECT_EQ(order.cuts_total(), 4);
  EXPECT_EQ(order.handwork_size(), plan.handwork_size());
  EXPECT_GT(order.handwork_size(), 0);
}

TEST_F(FabPlannerServiceTest, PlansWhatIsMadeToDrawing) {
  v1::CreatePlanRequest request = TableRequest();
  request.set_template_("templates/drawn");
  request.set_quantity(2);
  const v1::Operation operation = CreatePlan(request);
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.error().message();
  v1::Plan plan;
  ASSERT_TRUE(operation.result().UnpackTo(&plan));
  EXPECT_EQ(plan.parts(0).making(), v1::PlannedPart::TO_DRAWING);
  const v1::BillLine& line = plan.bill(plan.bill_size() - 1);
  EXPECT_EQ(line.item(), "");
  EXPECT_EQ(line.quantity(), 2);
  EXPECT_EQ(line.material(), "materials/beech");
  EXPECT_GT(line.mass(), 0);
  ASSERT_EQ(plan.parts(0).drawings_size(), 3);
  EXPECT_EQ(line.drawings_size(), 3);
  std::string sha256;
  EXPECT_THAT(Download(plan, plan.parts(0).drawings(0), &sha256), HasSubstr("<svg"));
  // 80 bytes of header, a count, and 50 bytes for each of the box's triangles.
  EXPECT_EQ(Download(plan, plan.parts(0).drawings(1), &sha256).size(), 84 + 12 * 50);
  EXPECT_EQ(Download(plan, "design.step", &sha256), "ISO-10303-21;END-ISO-10303-21;");
}

TEST_F(FabPlannerServiceTest, PlansDesignsThatOutgrowAMessageAndHaveNoStepFile) {
  catalog_.OutgrowMessages();
  catalog_.BreakStep();
  v1::CreatePlanRequest request = TableRequest();
  request.set_template_("templates/drawn");
  const v1::Operation operation = CreatePlan(request);
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.error().message();
  v1::Plan plan;
  ASSERT_TRUE(operation.result().UnpackTo(&plan));
  EXPECT_EQ(plan.parts(0).making(), v1::PlannedPart::TO_DRAWING);
  EXPECT_EQ(plan.parts(0).drawings_size(), 2);
  for (const v1::Artifact& artifact : plan.artifacts())
    EXPECT_NE(artifact.file_name(), "design.step");
  EXPECT_THAT(plan.handwork(),
              ::testing::Contains(AllOf(HasSubstr("design.step"), HasSubstr("gave up"))));
}

TEST_F(FabPlannerServiceTest, APartLongerThanItsStockIsNamedWithTheLengths) {
  Items items = ExampleItems();
  items["items/apron-20"].size.x() = 1.0;
  catalog_.SetItems(items);
  const v1::Operation operation = CreatePlan(TableRequest());
  EXPECT_EQ(operation.state(), v1::Operation::FAILED);
  EXPECT_THAT(operation.error().message(),
              AllOf(HasSubstr("apron_front"), HasSubstr("1110 mm"), HasSubstr("1000 mm")));
}

TEST_F(FabPlannerServiceTest, UnknownResourcesAreNotFound) {
  const auto code = [](const grpc::Status& status) { return status.error_code(); };
  auto context = Context();
  v1::GetPlanRequest get_plan;
  get_plan.set_name("plans/none");
  v1::Plan plan;
  EXPECT_EQ(code(Planner()->GetPlan(context.get(), get_plan, &plan)), grpc::StatusCode::NOT_FOUND);
  v1::ReleaseWorkOrderRequest release;
  release.set_request_id(NewRequestId());
  release.set_plan("plans/none");
  v1::Operation operation;
  context = Context();
  EXPECT_EQ(code(Planner()->ReleaseWorkOrder(context.get(), release, &operation)),
            grpc::StatusCode::NOT_FOUND);
  v1::HoldWorkOrderRequest hold;
  hold.set_request_id(NewRequestId());
  hold.set_name("workOrders/none");
  v1::WorkOrder order;
  context = Context();
  EXPECT_EQ(code(Planner()->HoldWorkOrder(context.get(), hold, &order)),
            grpc::StatusCode::NOT_FOUND);
  hold.set_name("orders/none");
  hold.set_request_id(NewRequestId());
  context = Context();
  EXPECT_EQ(code(Planner()->HoldWorkOrder(context.get(), hold, &order)),
            grpc::StatusCode::INVALID_ARGUMENT);
  v1::ListPlansRequest list;
  list.set_page_size(5000);
  v1::ListPlansResponse plans;
  context = Context();
  EXPECT_EQ(code(Planner()->ListPlans(context.get(), list, &plans)),
            grpc::StatusCode::INVALID_ARGUMENT);
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
