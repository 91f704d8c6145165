// Assemblies through the catalog as a process: parametrised, dragged, sampled, kept in revisions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/violation_lists.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/catalog/assembly_service_fixture.h"

namespace mortise::catalog {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

class AssemblyParametrizationTest : public AssemblyServiceTest {
 protected:
  absl::StatusOr<std::vector<v1::AdjustedAssembly>> Evaluate(
      const v1::EvaluateAssemblyRequest& request) {
    grpc::ClientContext context;
    testing::Prepare(context);
    return ReadAll(stub_->EvaluateAssembly(&context, request));
  }

  v1::Parametrization Parametrized() { return ParametrizationOf(kShelf); }

  absl::StatusOr<v1::Assembly> Import(const v1::Assembly& assembly, int64_t expected) {
    v1::ImportAssemblyRequest request;
    request.set_request_id("import-" + std::to_string(++requests_));
    *request.mutable_assembly() = assembly;
    request.set_expected_revision(expected);
    return Call(&Stub::ImportAssembly, request);
  }
};

std::vector<std::string> FieldsRefused(const absl::Status& refused) {
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << refused;
  std::vector<std::string> fields;
  for (const FieldViolation& violation : AllViolationsOf(refused)) {
    fields.push_back(violation.field);
  }
  return fields;
}

double Extent(const v1::AdjustedAssembly& design, const std::string& element, v1::Axis axis) {
  for (const v1::PlacedPart& part : design.parts()) {
    if (part.element() != element) continue;
    if (axis == v1::X) return part.maximum().x() - part.minimum().x();
    if (axis == v1::Y) return part.maximum().y() - part.minimum().y();
    return part.maximum().z() - part.minimum().z();
  }
  ADD_FAILURE() << "no part of " << element;
  return 0;
}

// A size of an element of one part, that can be changed.
v1::MeasureRange SizeOfOnePart(const v1::Parametrization& parametrization) {
  for (const v1::MeasureRange& range : parametrization.sizes()) {
    for (const v1::ParametricElement& element : parametrization.elements()) {
      if (element.name() == range.measure().element() && element.parts_size() == 1) return range;
    }
  }
  ADD_FAILURE() << "no size can be changed";
  return {};
}

TEST_F(AssemblyParametrizationTest, ListsWhatTheFiltersSay) {
  const auto list = [this](v1::ListAssembliesRequest request) {
    std::vector<std::string> names;
    request.set_page_size(2);
    do {
      const auto page = Call(&Stub::ListAssemblies, request);
      EXPECT_TRUE(page.ok()) << page.status();
      if (!page.ok()) break;
      for (const v1::Assembly& listed : page->assemblies()) names.push_back(listed.name());
      request.set_page_token(page->next_page_token());
    } while (!request.page_token().empty());
    return names;
  };
  const std::vector<std::string> all = list({});
  v1::ListAssembliesRequest request;
  request.set_text("BOOKSHELF");
  EXPECT_THAT(list(request), Contains(kShelf));
  EXPECT_LT(list(request).size(), all.size());
  request.set_text("no such words");
  EXPECT_TRUE(list(request).empty());
  request.Clear();
  const v1::Assembly shelf = Get(kShelf);
  for (const v1::AssemblyPart& part : shelf.parts()) {
    if (!part.item().empty()) request.set_item(part.item());
  }
  ASSERT_FALSE(request.item().empty());
  const std::vector<std::string> users = list(request);
  EXPECT_THAT(users, Contains(kShelf));
  for (const std::string& name : all) {
    const v1::Assembly assembly = Get(name);
    const bool uses =
        std::any_of(assembly.parts().begin(), assembly.parts().end(),
                    [&](const v1::AssemblyPart& part) { return part.item() == request.item(); });
    EXPECT_EQ(std::count(users.begin(), users.end(), name), uses ? 1 : 0) << name;
  }
  request.set_item("items/none");
  EXPECT_EQ(DetailOf(Call(&Stub::ListAssemblies, request).status()).field, "item");
}

TEST_F(AssemblyParametrizationTest, ShipsAssembliesInPages) {
  v1::ListAssembliesRequest request;
  request.set_page_size(2);
  std::vector<std::string> names;
  do {
    const auto page = Call(&Stub::ListAssemblies, request);
    ASSERT_TRUE(page.ok()) << page.status();
    for (const v1::Assembly& listed : page->assemblies()) {
      names.push_back(listed.name());
      EXPECT_FALSE(listed.title().empty());
      EXPECT_EQ(listed.parts_size(), 0);
      EXPECT_EQ(listed.revision(), 1);
    }
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  EXPECT_GE(names.size(), 3u);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  EXPECT_THAT(names, Contains(kShelf));
  const v1::Assembly shelf = Get(kShelf);
  EXPECT_GT(shelf.parts_size(), 3);
  EXPECT_EQ(shelf.digest().size(), 64u);
  EXPECT_GT(shelf.create_time().seconds(), 0);
}

TEST_F(AssemblyParametrizationTest, TellsWhatParametrisationFinds) {
  const v1::Parametrization found = Parametrized();
  EXPECT_EQ(found.assembly(), kShelf);
  EXPECT_EQ(found.revision(), 1);
  EXPECT_GT(found.tolerance(), 0);
  EXPECT_LT(found.tolerance(), 1e-4);
  ASSERT_GT(found.nodes_size(), 0);
  EXPECT_EQ(found.nodes(0).group(), "");
  EXPECT_EQ(found.nodes(0).elements(), found.elements_size());
  EXPECT_EQ(found.nodes(0).degrees_of_freedom(), found.degrees_of_freedom() + 3);
  EXPECT_EQ(found.q_size(), 6 * found.elements_size());
  EXPECT_GT(found.contacts_size(), 3);
  EXPECT_GT(found.relationships_size(), 10);
  EXPECT_GE(found.sizes_size(), 3);
  for (const v1::MeasureRange& range : found.sizes()) {
    EXPECT_LE(range.minimum(), range.drawn() + 1e-9);
    EXPECT_GE(range.maximum(), range.drawn() - 1e-9);
    EXPECT_LT(range.minimum(), range.maximum());
  }
  int parts = 0;
  for (const v1::ParametricElement& element : found.elements()) parts += element.parts_size();
  EXPECT_GE(parts, Get(kShelf).parts_size());
}

TEST_F(AssemblyParametrizationTest, DragsAPart) {
  const v1::MeasureRange range = SizeOfOnePart(Parametrized());
  v1::AdjustAssemblyRequest request;
  request.set_name(kShelf);
  *request.add_demands()->mutable_measure() = range.measure();
  std::vector<double> last;
  for (const double share : {0.2, 0.5, 0.8}) {
    const double wanted = range.minimum() + share * (range.maximum() - range.minimum());
    request.mutable_demands(0)->set_value(wanted);
    request.set_strict(true);
    const auto design = Call(&Stub::AdjustAssembly, request);
    ASSERT_TRUE(design.ok()) << design.status();
    ASSERT_EQ(design->reached_size(), 1);
    EXPECT_NEAR(design->reached(0), wanted, 1e-9);
    EXPECT_NEAR(Extent(*design, range.measure().element(), range.measure().axis()), wanted, 1e-9);
    EXPECT_EQ(design->faults_size(), 0);
    EXPECT_EQ(design->revision(), 1);
    *request.mutable_q() = design->q();
  }
}

TEST_F(AssemblyParametrizationTest, ComesAsNearAsItCanOrRefuses) {
  const v1::MeasureRange range = SizeOfOnePart(Parametrized());
  v1::AdjustAssemblyRequest request;
  request.set_name(kShelf);
  *request.add_demands()->mutable_measure() = range.measure();
  request.mutable_demands(0)->set_value(range.maximum() + 0.5);
  const auto near = Call(&Stub::AdjustAssembly, request);
  ASSERT_TRUE(near.ok()) << near.status();
  EXPECT_NEAR(near->reached(0), range.maximum(), 1e-7);
  EXPECT_EQ(near->faults_size(), 0);

  request.set_strict(true);
  const absl::Status refused = Call(&Stub::AdjustAssembly, request).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(refused).reason, "DEMANDS_CONFLICT");
  EXPECT_THAT(std::string(refused.message()), HasSubstr(range.measure().element()));
}

TEST_F(AssemblyParametrizationTest, SamplesAndEvaluatesAlike) {
  const auto samples = Sample(20, 7);
  ASSERT_TRUE(samples.ok()) << samples.status();
  ASSERT_EQ(samples->size(), 20u);
  const auto again = Sample(20, 7);
  ASSERT_TRUE(again.ok()) << again.status();
  const auto other = Sample(20, 8);
  ASSERT_TRUE(other.ok()) << other.status();
  v1::EvaluateAssemblyRequest request;
  request.set_name(kShelf);
  for (std::size_t i = 0; i < samples->size(); ++i) {
    EXPECT_EQ((*samples)[i].SerializeAsString(), (*again)[i].SerializeAsString());
    EXPECT_NE((*samples)[i].SerializeAsString(), (*other)[i].SerializeAsString());
    EXPECT_EQ((*samples)[i].faults_size(), 0);
    *request.add_points()->mutable_q() = (*samples)[i].q();
  }
  const auto evaluated = Evaluate(request);
  ASSERT_TRUE(evaluated.ok()) << evaluated.status();
  ASSERT_EQ(evaluated->size(), 20u);
  for (std::size_t i = 0; i < samples->size(); ++i) {
    EXPECT_EQ((*evaluated)[i].SerializeAsString(), (*samples)[i].SerializeAsString());
  }
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

TEST_F(AssemblyParametrizationTest, KeepsRevisionsAndTellsOfThem) {
  v1::Assembly shelf = Get(kShelf);
  const auto same = Import(shelf, 1);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_EQ(same->revision(), 1) << "nothing has changed";
  shelf.set_title("Another bookshelf");
  const auto second = Import(shelf, 1);
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(second->revision(), 2);
  const absl::Status stale = Import(shelf, 1).status();
  EXPECT_EQ(stale.code(), absl::StatusCode::kAborted);
  EXPECT_EQ(DetailOf(stale).reason, "STALE_REVISION");

  process_.Kill();
  process_.Start();
  Connect();
  EXPECT_EQ(Get(kShelf).title(), "Another bookshelf");
  EXPECT_NE(Get(kShelf, 1).title(), "Another bookshelf");

  const auto events = v1::EventService::NewStub(process_.channel());
  v1::FollowEventsRequest follow;
  follow.add_type_prefixes("assembly.imported");
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto reader = events->FollowEvents(&context, follow);
  v1::Event event;
  bool told = false;
  while (!told && reader->Read(&event)) {
    told = event.subject() == kShelf && event.data().find("\"revision\":2") != std::string::npos;
  }
  EXPECT_TRUE(told);
  context.TryCancel();
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

TEST_F(AssemblyParametrizationTest, ItemsOfAssembliesStay) {
  const auto catalog = v1::CatalogService::NewStub(process_.channel());
  v1::DeleteItemRequest request;
  request.set_request_id("delete-1");
  request.set_name(Get(kShelf).parts(0).item());
  request.set_revision(1);
  v1::DeleteItemResponse response;
  grpc::ClientContext context;
  testing::Prepare(context);
  const absl::Status kept = rpc::FromGrpc(catalog->DeleteItem(&context, request, &response));
  EXPECT_EQ(DetailOf(kept).reason, "ITEM_IN_USE") << kept;
}

}  // namespace
}  // namespace mortise::catalog
