// Assemblies, and questions about them, that the catalog refuses: what it says of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/violation_lists.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "tests/integration/services/catalog/assembly_parametrization_fixture.h"

namespace mortise::catalog {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

std::vector<std::string> FieldsRefused(const absl::Status& refused) {
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << refused;
  std::vector<std::string> fields;
  for (const FieldViolation& violation : AllViolationsOf(refused)) {
    fields.push_back(violation.field);
  }
  return fields;
}

TEST_F(AssemblyParametrizationTest, SaysWhatIsWrongWithADesignThatBreaksARelationship) {
  const v1::Parametrization found = Parametrized();
  v1::EvaluateAssemblyRequest request;
  request.set_name(kShelf);
  *request.add_points()->mutable_q() = found.q();
  *request.add_points()->mutable_q() = found.q();
  // The last element leaves all it touches.
  request.mutable_points(1)->set_q(6 * (found.elements_size() - 1),
                                   found.q(6 * (found.elements_size() - 1)) + 5);
  const auto designs = Evaluate(request);
  ASSERT_TRUE(designs.ok()) << designs.status();
  ASSERT_EQ(designs->size(), 2u);
  EXPECT_EQ((*designs)[0].faults_size(), 0);
  ASSERT_GT((*designs)[1].faults_size(), 0);
  EXPECT_THAT((*designs)[1].faults(0), HasSubstr("has lost"));
}

TEST_F(AssemblyParametrizationTest, ReportsEverythingThatIsWrongAndStoresNothing) {
  v1::Assembly broken = Get(kShelf);
  broken.set_name("assemblies/broken");
  broken.mutable_parts(0)->set_item("items/nothing-like-it");
  broken.mutable_parts(1)->set_group("nowhere");
  broken.mutable_parts(2)->set_name("");
  const absl::Status refused = Import(broken, 0).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(refused)) {
    fields.push_back(violation.field);
  }
  for (const char* field :
       {"assembly.parts[0].item", "assembly.parts[1].group", "assembly.parts[2].name"}) {
    EXPECT_THAT(fields, Contains(field));
  }

  v1::Assembly loose = Get(kShelf);
  loose.set_name("assemblies/loose");
  v1::AssemblyPart& lamp = *loose.add_parts();
  lamp = loose.parts(0);
  lamp.set_name("lamp");
  lamp.clear_repeat();
  lamp.mutable_position()->set_z(10);
  const absl::Status unbounded = Import(loose, 0).status();
  EXPECT_EQ(DetailOf(unbounded).reason, "FEASIBLE_SET_UNBOUNDED") << unbounded;
  EXPECT_EQ(DetailOf(unbounded).field, "assembly");
  EXPECT_THAT(std::string(unbounded.message()), HasSubstr("'lamp'"));

  for (const char* name : {"assemblies/broken", "assemblies/loose"}) {
    v1::GetAssemblyRequest request;
    request.set_name(name);
    EXPECT_EQ(Call(&Stub::GetAssembly, request).status().code(), absl::StatusCode::kNotFound);
  }
}

TEST_F(AssemblyParametrizationTest, NamesTheFieldAtFault) {
  const auto field = [](const absl::Status& status) {
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field;
  };
  EXPECT_EQ(field(Sample(0, 1).status()), "count");
  EXPECT_EQ(field(Sample(1001, 1).status()), "count");
  v1::EvaluateAssemblyRequest evaluate;
  evaluate.set_name(kShelf);
  EXPECT_EQ(field(Evaluate(evaluate).status()), "points");
  *evaluate.add_points()->mutable_q() = Parametrized().q();
  evaluate.add_points()->add_q(1);
  EXPECT_EQ(field(Evaluate(evaluate).status()), "points[1].q");
  *evaluate.mutable_points(1)->mutable_q() = evaluate.points(0).q();
  evaluate.mutable_points(1)->set_q(3, -1);
  EXPECT_EQ(field(Evaluate(evaluate).status()), "points[1].q[3]");

  v1::AdjustAssemblyRequest adjust;
  adjust.set_name(kShelf);
  adjust.add_demands()->mutable_measure()->set_element("nothing");
  EXPECT_EQ(field(Call(&Stub::AdjustAssembly, adjust).status()), "demands[0].measure.element");
  adjust.mutable_demands(0)->set_value(std::numeric_limits<double>::infinity());
  EXPECT_EQ(field(Call(&Stub::AdjustAssembly, adjust).status()), "demands[0].value");
  adjust.clear_demands();
  adjust.add_q(1);
  EXPECT_EQ(field(Call(&Stub::AdjustAssembly, adjust).status()), "q");
  v1::ParametrizeAssemblyRequest parametrize;
  parametrize.set_name("bookshelf");
  EXPECT_EQ(field(Call(&Stub::ParametrizeAssembly, parametrize).status()), "name");
  v1::ExportAssemblyRequest format;
  format.set_name(kShelf);
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto reader = stub_->ExportAssembly(&context, format);
  v1::Chunk chunk;
  EXPECT_FALSE(reader->Read(&chunk));
  EXPECT_EQ(field(rpc::FromGrpc(reader->Finish())), "format");
}

// Requests that are wrong in several ways: every one of them is told, numbers that are none
// included, and of what belongs to a design that is there.
TEST_F(AssemblyParametrizationTest, TellsAllThatIsWrongWithAnAdjustment) {
  v1::AdjustAssemblyRequest adjust;
  adjust.set_name(kShelf);
  const auto fields = [&] { return FieldsRefused(Call(&Stub::AdjustAssembly, adjust).status()); };
  *adjust.mutable_q() = Parametrized().q();
  adjust.set_q(4, -0.5);  // a size
  adjust.set_q(6, 20e3);  // a place
  const auto demand = [&](const std::string& element, double value) {
    v1::MeasureDemand& added = *adjust.add_demands();
    added.mutable_measure()->set_element(element);
    added.set_value(value);
  };
  demand("nothing", 1);
  demand(Parametrized().elements(0).name(), -20e3);
  EXPECT_THAT(fields(), UnorderedElementsAre("q[4]", "q[6]", "demands[0].measure.element",
                                             "demands[1].value"));
  demand("Nobody", std::numeric_limits<double>::quiet_NaN());
  adjust.mutable_demands(1)->mutable_measure()->set_axis(static_cast<v1::Axis>(9));
  adjust.set_q(0, std::numeric_limits<double>::infinity());
  EXPECT_THAT(fields(), UnorderedElementsAre("q[0]", "q[4]", "q[6]", "demands[0].measure.element",
                                             "demands[1].measure.axis", "demands[1].value",
                                             "demands[2].measure.element", "demands[2].value"));
  adjust.add_q(1);
  for (int i = 0; i < 100; ++i) demand("nothing", 1);
  EXPECT_THAT(fields(), UnorderedElementsAre("q[0]", "demands[1].measure.axis", "demands[2].value"))
      << "of lists at fault no more is said";
  adjust.set_q(0, 0);
  adjust.mutable_demands(1)->mutable_measure()->clear_axis();
  adjust.mutable_demands(2)->set_value(1);
  EXPECT_THAT(fields(), UnorderedElementsAre("q", "demands"));
  adjust.set_name("shelf");
  adjust.set_revision(-1);
  EXPECT_THAT(fields(), UnorderedElementsAre("demands", "name", "revision"));
}

TEST_F(AssemblyParametrizationTest, TellsAllThatIsWrongWithPoints) {
  v1::EvaluateAssemblyRequest evaluate;
  evaluate.set_name(kShelf);
  const auto fields = [&] { return FieldsRefused(Evaluate(evaluate).status()); };
  for (int i = 0; i < 4; ++i) *evaluate.add_points()->mutable_q() = Parametrized().q();
  evaluate.mutable_points(0)->add_q(1);
  evaluate.mutable_points(1)->set_q(3, 0);
  evaluate.mutable_points(1)->set_q(5, -1);
  evaluate.mutable_points(3)->set_q(1, 11e3);
  EXPECT_THAT(fields(), UnorderedElementsAre("points[0].q", "points[1].q[3]", "points[1].q[5]",
                                             "points[3].q[1]"));
  evaluate.mutable_points(2)->set_q(7, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(fields(), UnorderedElementsAre("points[0].q", "points[1].q[3]", "points[1].q[5]",
                                             "points[2].q[7]", "points[3].q[1]"));
  evaluate.clear_points();
  evaluate.set_revision(-1);
  evaluate.set_name("shelf");
  EXPECT_THAT(fields(), UnorderedElementsAre("points", "name", "revision"));

  v1::SampleAssemblyRequest sample;
  sample.set_name("shelf");
  sample.set_revision(-1);
  grpc::ClientContext context;
  testing::Prepare(context);
  EXPECT_THAT(FieldsRefused(ReadAll(stub_->SampleAssembly(&context, sample)).status()),
              UnorderedElementsAre("count", "name", "revision"));
}

TEST_F(AssemblyParametrizationTest, TellsAllThatIsWrongWithAnExport) {
  v1::ExportAssemblyRequest file;
  file.set_name(kShelf);
  const auto fields = [&] {
    grpc::ClientContext context;
    testing::Prepare(context);
    const auto reader = stub_->ExportAssembly(&context, file);
    v1::Chunk chunk;
    EXPECT_FALSE(reader->Read(&chunk));
    return FieldsRefused(rpc::FromGrpc(reader->Finish()));
  };
  *file.mutable_q() = Parametrized().q();
  file.set_q(3, -1);
  file.set_rest_pose("lid: open");
  EXPECT_THAT(fields(), UnorderedElementsAre("format", "q[3]", "rest_pose"));
  file.set_format(static_cast<v1::ExportDesignRequest::Format>(99));
  file.set_q(9, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(fields(), UnorderedElementsAre("format", "q[3]", "q[9]", "rest_pose"));
  file.set_name("shelf");
  EXPECT_THAT(fields(), UnorderedElementsAre("format", "q[9]", "name"));
}

TEST_F(AssemblyParametrizationTest, TellsNumbersThatAreNoneWithAllElse) {
  v1::Assembly shelf = Get(kShelf);
  shelf.set_name("assemblies/no-numbers");
  const auto fields = [&] {
    v1::ImportAssemblyRequest request;
    request.set_request_id("no-numbers");
    *request.mutable_assembly() = shelf;
    const absl::Status refused = Call(&Stub::ImportAssembly, request).status();
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << refused;
    std::vector<std::string> all;
    for (const FieldViolation& violation : AllViolationsOf(refused)) all.push_back(violation.field);
    return all;
  };
  shelf.mutable_parts(0)->mutable_position()->set_x(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(fields(), UnorderedElementsAre("assembly.parts[0].position.x"));
  shelf.mutable_parts(1)->set_item("items/none");
  v1::Joint& joint = *shelf.add_joints();
  joint.set_name("turn");
  joint.set_group("nowhere");
  joint.set_kind(v1::Joint::HINGE);
  joint.mutable_axis()->set_z(1);
  joint.set_lower(-std::numeric_limits<double>::infinity());
  joint.add_rest_poses();
  EXPECT_THAT(fields(),
              UnorderedElementsAre("assembly.parts[0].position.x", "assembly.parts[1].item",
                                   "assembly.joints[0].group", "assembly.joints[0].lower",
                                   "assembly.joints[0].rest_poses[0].name"));
}

TEST_F(AssemblyParametrizationTest, TellsARevisionThatCannotBeWithAllElse) {
  v1::ImportAssemblyRequest request;
  request.set_request_id("no-revision");
  request.set_expected_revision(-1);
  *request.mutable_assembly() = Get(kShelf);
  request.mutable_assembly()->set_name("assemblies/no-revision");
  const auto fields = [&] {
    std::vector<std::string> all;
    for (const FieldViolation& violation :
         AllViolationsOf(Call(&Stub::ImportAssembly, request).status())) {
      all.push_back(violation.field);
    }
    return all;
  };
  EXPECT_THAT(fields(), UnorderedElementsAre("expected_revision"));
  request.mutable_assembly()->mutable_parts(1)->set_item("items/none");
  EXPECT_THAT(fields(), UnorderedElementsAre("expected_revision", "assembly.parts[1].item"));
  // One that is not the latest is a fault among others; by itself it only comes too late.
  request.set_expected_revision(7);
  EXPECT_THAT(fields(), UnorderedElementsAre("expected_revision", "assembly.parts[1].item"));
  request.mutable_assembly()->mutable_parts(2)->set_group("nowhere");
  request.set_expected_revision(0);
  EXPECT_THAT(fields(), UnorderedElementsAre("assembly.parts[1].item", "assembly.parts[2].group"));
  *request.mutable_assembly() = Get(kShelf);
  request.set_expected_revision(7);
  EXPECT_EQ(DetailOf(Call(&Stub::ImportAssembly, request).status()).reason, "STALE_REVISION");
}

}  // namespace
}  // namespace mortise::catalog
