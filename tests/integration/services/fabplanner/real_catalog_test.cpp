// Plans of what ships, through the real catalog: an assembly with a drawer, and one drawn in CAD.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "common/base/files.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/integration/services/filled_catalog.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::fabplanner {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

class RealCatalogTest : public ::testing::Test {
 protected:
  static std::unique_ptr<grpc::ClientContext> Context() {
    auto context = std::make_unique<grpc::ClientContext>();
    context->set_deadline(std::chrono::system_clock::now() + std::chrono::minutes(3));
    return context;
  }

  v1::Plan PlanOf(const std::string& name) {
    v1::CreatePlanRequest request;
    request.set_template_(name);
    return PlanOf(request);
  }

  v1::Plan PlanOf(const v1::CreatePlanRequest& request) {
    const v1::Operation operation = Planned(request);
    EXPECT_EQ(operation.state(), v1::Operation::SUCCEEDED) << operation.error().message();
    v1::Plan plan;
    EXPECT_TRUE(operation.result().UnpackTo(&plan));
    return plan;
  }

  // The operation, ended.
  v1::Operation Planned(v1::CreatePlanRequest request) {
    request.set_request_id("plan-" + std::to_string(++plans_));
    v1::Operation operation;
    auto context = Context();
    grpc::Status status = v1::FabPlannerService::NewStub(planner_.channel())
                              ->CreatePlan(context.get(), request, &operation);
    EXPECT_TRUE(status.ok()) << status.error_message();
    v1::WatchOperationRequest watch;
    watch.set_name(operation.name());
    context = Context();
    auto told =
        v1::OperationService::NewStub(planner_.channel())->WatchOperation(context.get(), watch);
    while (operation.state() != v1::Operation::SUCCEEDED &&
           operation.state() != v1::Operation::FAILED && told->Read(&operation)) {
    }
    context->TryCancel();
    return operation;
  }

  // Every part comes in with one step; what is cut is laid out once.
  static void ExpectWhole(const v1::Plan& plan) {
    std::map<std::string, int> added, cut;
    for (const v1::AssemblyStep& step : plan.steps()) {
      for (const std::string& part : step.added_parts()) ++added[part];
      for (const std::string& part : step.connectors()) ++added[part];
    }
    for (const v1::BoardLayout& board : plan.boards()) {
      for (const auto& segment : board.segments()) ++cut[segment.part()];
    }
    for (const v1::SheetLayout& sheet : plan.sheets()) {
      for (const auto& placement : sheet.placements()) ++cut[placement.part()];
    }
    for (const v1::PlannedPart& part : plan.parts()) {
      EXPECT_EQ(added[part.name()], 1) << part.name();
      const bool is_cut =
          part.making() == v1::PlannedPart::CROSSCUT || part.making() == v1::PlannedPart::OUTLINE;
      EXPECT_EQ(cut[part.name()], is_cut ? 1 : 0) << part.name();
    }
    EXPECT_EQ(static_cast<int>(added.size()), plan.parts_size());
  }

  testing::FilledCatalog catalog_;
  testing::ServiceUnderTest planner_{"mortise-fabplanner",
                                     {"--peer=catalog=" + catalog_.address()}};
  int plans_ = 0;
};

TEST_F(RealCatalogTest, AnAssemblyWithADrawer) {
  const v1::Plan plan = PlanOf("templates/tool-cart");
  ExpectWhole(plan);
  std::set<std::string> built;
  for (const v1::AssemblyStep& step : plan.steps()) built.insert(step.subassembly());
  EXPECT_THAT(built, Contains("drawer"));
  EXPECT_GT(plan.holes_size(), 20);
  EXPECT_GT(plan.total().amount(), 0);
}

TEST_F(RealCatalogTest, AFrameOfMitredRailsLiesEndToEndOnOneBoard) {
  const v1::Plan plan = PlanOf("templates/picture-frame");
  ExpectWhole(plan);
  EXPECT_EQ(plan.chop_saw_parts(), 4);
  EXPECT_EQ(plan.jigsaw_parts(), 1);
  EXPECT_EQ(plan.steps_size(), 3);
  ASSERT_EQ(plan.boards_size(), 1);
  const v1::BoardLayout& board = plan.boards(0);
  ASSERT_EQ(board.segments_size(), 4);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(std::abs(board.segments(i).front_cut().mitre()), M_PI / 4, 1e-9);
    EXPECT_NEAR(std::abs(board.segments(i).rear_cut().mitre()), M_PI / 4, 1e-9);
    EXPECT_EQ(board.segments(i).rear_cut().bevel(), 0);
  }
  // 460 and 360 mm along the middle line twice, three cuts of 3 √2 mm, 30 mm over at either end.
  const auto& last = board.segments(3);
  EXPECT_NEAR(last.start() + last.length(), 0.01 + 1.64 + 3 * 0.003 * std::sqrt(2) + 0.06, 1e-6);
  for (const v1::PlannedPart& part : plan.parts()) {
    EXPECT_EQ(part.handwork(), "") << part.name();
    EXPECT_EQ(part.has_front_cut(), part.making() == v1::PlannedPart::CROSSCUT) << part.name();
  }

  v1::CreatePlanRequest request;
  request.set_template_("templates/picture-frame");
  request.mutable_rules()->set_mitre_limit(M_PI / 6);
  const v1::Plan blanks = PlanOf(request);
  ExpectWhole(blanks);
  EXPECT_EQ(blanks.rules().mitre_limit(), M_PI / 6);
  for (const v1::PlannedPart& part : blanks.parts()) {
    if (part.making() != v1::PlannedPart::CROSSCUT) continue;
    ASSERT_EQ(part.beyond_machines_size(), 2) << part.name();
    EXPECT_EQ(part.beyond_machines(0).kind(), v1::MachineLimit::MITRE);
    EXPECT_EQ(part.beyond_machines(0).nearest_parameters_size(), 0);  // no parameter changes it
    EXPECT_THAT(part.handwork(), HasSubstr("is a mitre of 45°, but"));
    EXPECT_THAT(part.drawings(), Contains("design.step"));
  }
}

TEST_F(RealCatalogTest, AnEndThatNoSawCutsTellsTheNearestParameter) {
  v1::ImportTemplateRequest import;
  import.set_request_id("template-brace");
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(
      R"pb(name: "templates/brace"
           title: "Brace"
           parameters {
             name: "lean"
             title: "Lean"
             unit: "rad"
             minimum: 0.1
             maximum: 1.2
             default_value: 1
             step: 0.001
           }
           parts {
             name: "brace"
             title: "Brace"
             item: "items/spruce-planed-2400"
             length_axis: X
             thickness_axis: Z
             prism {
               axis: Z
               outline { u: "0" v: "0" }
               outline { u: "0.6" v: "0" }
               outline { u: "0.6 + 0.06 * tan(lean)" v: "0.06" }
               outline { u: "0.06 * tan(lean)" v: "0.06" }
               extent { from: "0" to: "0.03" }
             }
           })pb",
      import.mutable_template_()));
  v1::Template made;
  const auto context = Context();
  const grpc::Status status =
      v1::CatalogService::NewStub(catalog_.channel())->ImportTemplate(context.get(), import, &made);
  ASSERT_TRUE(status.ok()) << status.error_message();

  const v1::Plan plan = PlanOf("templates/brace");
  ASSERT_EQ(plan.parts_size(), 1);
  ASSERT_EQ(plan.parts(0).beyond_machines_size(), 2);
  for (const v1::MachineLimit& limit : plan.parts(0).beyond_machines()) {
    EXPECT_NEAR(limit.value(), 1, 1e-9);
    ASSERT_EQ(limit.nearest_parameters_size(), 1);
    EXPECT_EQ(limit.nearest_parameters(0).name(), "lean");
    EXPECT_NEAR(limit.nearest_parameters(0).value(), 0.872, 1e-9);
    EXPECT_THAT(limit.message(), HasSubstr("lean = 0.872 rad (50°)"));
  }
  EXPECT_THAT(plan.handwork(), Contains(HasSubstr("is made by machine with lean = 0.872 rad")));

  v1::CreatePlanRequest request;
  request.set_template_("templates/brace");
  v1::ParameterValue* lean = request.add_parameters();
  lean->set_name("lean");
  lean->set_value(0.872);
  EXPECT_EQ(PlanOf(request).parts(0).beyond_machines_size(), 0);
}

// Of the shelf that ships the back comes last; of one whose shelves are to come in after what holds
// them nobody can.
TEST_F(RealCatalogTest, PrioritiesAreFollowedOrTheirContradictionIsNamed) {
  const v1::Plan plan = PlanOf("templates/bookshelf");
  ExpectWhole(plan);
  ASSERT_GT(plan.steps_size(), 0);
  EXPECT_THAT(plan.steps(plan.steps_size() - 1).added_parts(), Contains("back"));

  const auto stub = v1::AssemblyService::NewStub(catalog_.channel());
  v1::GetAssemblyRequest asked;
  asked.set_name("assemblies/bookshelf");
  v1::ImportAssemblyRequest import;
  auto context = Context();
  ASSERT_TRUE(stub->GetAssembly(context.get(), asked, import.mutable_assembly()).ok());
  v1::Assembly& contrary = *import.mutable_assembly();
  contrary.set_name("assemblies/contrary-shelf");
  contrary.clear_revision();
  contrary.clear_create_time();
  contrary.clear_digest();
  contrary.clear_creator();
  for (v1::AssemblyPart& part : *contrary.mutable_parts()) {
    if (part.name() == "shelf") part.set_priority(5);
  }
  import.set_request_id("contrary");
  v1::Assembly imported;
  context = Context();
  grpc::Status status = stub->ImportAssembly(context.get(), import, &imported);
  ASSERT_TRUE(status.ok()) << status.error_message();
  v1::ImportTemplateRequest expose;
  expose.set_request_id("expose-contrary");
  expose.mutable_template_()->set_name("templates/contrary");
  expose.mutable_template_()->mutable_assembly()->set_assembly(imported.name());
  v1::Template made;
  context = Context();
  status =
      v1::CatalogService::NewStub(catalog_.channel())->ImportTemplate(context.get(), expose, &made);
  ASSERT_TRUE(status.ok()) << status.error_message();
  v1::CreatePlanRequest request;
  request.set_template_("templates/contrary");
  const v1::Operation refused = Planned(request);
  EXPECT_EQ(refused.state(), v1::Operation::FAILED);
  EXPECT_THAT(refused.error().message(), ::testing::HasSubstr("(5) comes in after 'screw left"));
}

TEST_F(RealCatalogTest, AnAssemblyDrawnInCad) {
  const std::filesystem::path drawings = testing::ShippedCollection() / "drawings";
  v1::ImportAssemblyStepRequest import;
  import.set_request_id("import-shelf");
  import.set_step(*ReadFile(drawings / "wall_shelf.step"));
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(
      *ReadFile(drawings / "wall_shelf.textproto"), import.mutable_annotations()));
  v1::ImportAssemblyStepResponse imported;
  auto context = Context();
  grpc::Status status = v1::AssemblyService::NewStub(catalog_.channel())
                            ->ImportAssemblyStep(context.get(), import, &imported);
  ASSERT_TRUE(status.ok()) << status.error_message();
  v1::ImportTemplateRequest request;
  request.set_request_id("template-shelf");
  request.mutable_template_()->set_name("templates/wall-shelf");
  request.mutable_template_()->mutable_assembly()->set_assembly(imported.assembly().name());
  v1::Template made;
  context = Context();
  status = v1::CatalogService::NewStub(catalog_.channel())
               ->ImportTemplate(context.get(), request, &made);
  ASSERT_TRUE(status.ok()) << status.error_message();

  const v1::Plan plan = PlanOf("templates/wall-shelf");
  ExpectWhole(plan);
  std::map<v1::PlannedPart::Making, int> parts;
  for (const v1::PlannedPart& part : plan.parts()) ++parts[part.making()];
  EXPECT_EQ(parts[v1::PlannedPart::OUTLINE], 1);  // the board, and a bore that no jigsaw makes
  EXPECT_EQ(parts[v1::PlannedPart::BOUGHT], 2);   // the brackets
  for (const v1::PlannedPart& part : plan.parts()) {
    if (part.making() != v1::PlannedPart::OUTLINE) continue;
    EXPECT_NE(part.handwork(), "");
    EXPECT_THAT(part.drawings(), Contains("design.step"));
  }
}

}  // namespace
}  // namespace mortise::fabplanner
