// The fabplanner as a process: plans and their files, and requests that are refused.
#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "tests/integration/services/fabplanner/fabplanner_service_fixture.h"
#include "tests/support/printed_pages.h"

namespace mortise::fabplanner {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

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
  ASSERT_EQ(plan.artifacts_size(), 6 + 3 + 3 + 4);
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

TEST_F(FabPlannerServiceTest, TellsTheBillAsATreeInFiles) {
  const v1::Plan plan = PlanTable();
  const v1::BillTree& tree = plan.bill_tree();
  EXPECT_EQ(tree.template_(), "templates/table");
  EXPECT_EQ(tree.template_revision(), 3);
  EXPECT_GT(tree.effective_from().seconds(), 0);
  EXPECT_LE(tree.effective_from().seconds(), plan.create_time().seconds());
  ASSERT_GT(tree.nodes_size(), 9);
  EXPECT_EQ(tree.nodes(0).kind(), v1::BillNode::ASSEMBLY);
  EXPECT_EQ(tree.nodes(0).title(), "Table");
  EXPECT_DOUBLE_EQ(tree.nodes(0).price().amount(), plan.total().amount());
  double pegs = 0;
  for (const v1::BillNode& node : tree.nodes()) {
    if (node.item() == "items/dowel-8x35") pegs += node.total_quantity();
    for (const std::string& file : node.artifacts()) {
      EXPECT_THAT(plan.artifacts(),
                  ::testing::Contains(::testing::Property(&v1::Artifact::file_name, file)));
    }
  }
  EXPECT_EQ(pegs, plan.pegs());

  std::string sha256;
  EXPECT_THAT(Download(plan, "bill.csv", &sha256),
              AllOf(HasSubstr("level,id,parent,kind,"), HasSubstr("\r\n2,1.1.1,1.1,stock,")));
  EXPECT_THAT(Download(plan, "bill.xlsx", &sha256), ::testing::StartsWith("PK"));
  v1::Plan read;
  ASSERT_TRUE(
      google::protobuf::util::JsonStringToMessage(Download(plan, "bill.json", &sha256), &read)
          .ok());
  EXPECT_EQ(read.name(), plan.name());
  EXPECT_EQ(read.bill_tree().SerializeAsString(), tree.SerializeAsString());
}

TEST_F(FabPlannerServiceTest, ARepeatedRequestMakesOnePlan) {
  const v1::CreatePlanRequest request = TableRequest();
  EXPECT_EQ(CreatePlan(request).name(), CreatePlan(request).name());
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

TEST_F(FabPlannerServiceTest, CodesOnLabelsNameThePlan) {
  v1::CreatePlanRequest request = TableRequest();
  request.set_label_address("https://shop.example.com");
  const v1::Operation operation = CreatePlan(request);
  ASSERT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.error().message();
  v1::Plan plan;
  ASSERT_TRUE(operation.result().UnpackTo(&plan));
  std::string sha256;
  const std::vector<std::string> codes = testing::CodesOn(Download(plan, "labels.pdf", &sha256), 1);
  EXPECT_EQ(codes.size(), 9u);
  EXPECT_THAT(codes, ::testing::Contains(absl::StrCat("https://shop.example.com/", plan.name(),
                                                      "/parts/top?step=3")));
  for (const char* file : {"assembly-guide.pdf", "cut-list.pdf"}) {
    EXPECT_THAT(Download(plan, file, &sha256), ::testing::StartsWith("%PDF-")) << file;
  }
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
  for (const v1::Artifact& artifact : plan.artifacts()) {
    EXPECT_NE(artifact.file_name(), "design.step");
  }
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

// A long and a short apron are together as long as a board, which takes a saw without kerf and
// trim.
TEST_F(FabPlannerServiceTest, RulesOfZeroAreZero) {
  Items items = ExampleItems();
  items["items/apron-20"].size.x() = 1.110 + 0.610;
  catalog_.SetItems(items);
  const auto aprons = [this](const v1::CreatePlanRequest& request) {
    const v1::Operation operation = CreatePlan(request);
    EXPECT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.error().message();
    v1::Plan plan;
    EXPECT_TRUE(operation.result().UnpackTo(&plan));
    int boards = 0;
    for (const v1::BoardLayout& board : plan.boards()) {
      boards += board.item() == "items/apron-20" ? 1 : 0;
    }
    return std::make_pair(plan, boards);
  };
  const auto [usual, usual_boards] = aprons(TableRequest());
  v1::CreatePlanRequest request = TableRequest();
  request.mutable_rules()->set_kerf(0);
  request.mutable_rules()->set_board_trim(0);
  request.mutable_rules()->set_sheet_trim(0);
  request.mutable_rules()->set_sheet_spacing(0);
  const auto [bare, bare_boards] = aprons(request);
  EXPECT_EQ(usual_boards, 3);
  EXPECT_EQ(bare_boards, 2);
  EXPECT_TRUE(bare.rules().has_kerf());
  EXPECT_EQ(bare.rules().kerf(), 0);
  EXPECT_EQ(bare.rules().board_trim(), 0);
  EXPECT_EQ(bare.rules().sheet_trim(), 0);
  EXPECT_EQ(bare.rules().sheet_spacing(), 0);
  EXPECT_EQ(bare.boards(0).segments(0).start(), 0);
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
  request.set_quantity(0);
  EXPECT_THAT(refused(request), HasSubstr("quantity"));
  request = TableRequest();
  request.mutable_rules()->set_sheet_spacing(0);
  EXPECT_THAT(refused(request), HasSubstr("rules.sheet_spacing"));
  // Everything at once.
  request.mutable_rules()->set_kerf(-1);
  request.mutable_rules()->set_sheet_trim(-1);
  request.set_quantity(-1);
  request.set_template_revision(-1);
  request.set_label_address("shop.example.com");
  const std::string all = refused(request);
  for (const char* field :
       {"rules.kerf", "rules.sheet_trim", "quantity", "template_revision", "label_address"}) {
    EXPECT_THAT(all, HasSubstr(field));
  }
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

}  // namespace
}  // namespace mortise::fabplanner
