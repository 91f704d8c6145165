// Assemblies through the catalog as a process: parametrised, dragged, sampled, kept in revisions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/catalog/assembly_parametrization_fixture.h"

namespace mortise::catalog {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

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
