// Fronts by what callers attach to them: external ids and labels, from the request to the list.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "common/store/store.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/pareto/pareto_service_fixture.h"

namespace mortise::pareto {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Service = v1::ParetoService::Stub;

class FrontTagsTest : public ParetoServiceTest {
 protected:
  static v1::DiscoverFrontRequest Tagged(int evaluations, const std::string& external_id,
                                         const std::string& project) {
    v1::DiscoverFrontRequest request = Request(evaluations);
    if (!external_id.empty()) request.add_external_ids(external_id);
    if (!project.empty()) (*request.mutable_labels())["project"] = project;
    return request;
  }

  v1::Front Get(const std::string& name) {
    v1::GetFrontRequest request;
    request.set_name(name);
    const auto front = testing::Call(*fronts_, &Service::GetFront, request);
    EXPECT_TRUE(front.ok()) << front.status();
    return front.value_or(v1::Front());
  }

  // The names of the fronts that a list has, as `ask` asks for it.
  std::vector<std::string> Listed(const std::function<void(v1::ListFrontsRequest&)>& ask) {
    v1::ListFrontsRequest request;
    ask(request);
    const auto page = testing::Call(*fronts_, &Service::ListFronts, request);
    EXPECT_TRUE(page.ok()) << page.status();
    std::vector<std::string> names;
    if (!page.ok()) return names;
    for (const v1::Front& front : page->fronts()) names.push_back(front.name());
    return names;
  }

  absl::StatusOr<v1::Front> Update(const v1::Front& changes,
                                   const std::vector<std::string>& mask = {}) {
    v1::UpdateFrontRequest request;
    request.set_request_id(NewIdentifier());
    *request.mutable_front() = changes;
    for (const std::string& path : mask) request.mutable_update_mask()->add_paths(path);
    return testing::Call(*fronts_, &Service::UpdateFront, request);
  }
};

TEST_F(FrontTagsTest, AreThoseOfTheDiscovery) {
  const v1::Operation operation = Wait(Discover(Tagged(40, "100-4711/A", "kitchen")).name());
  v1::Front result;
  ASSERT_TRUE(operation.result().UnpackTo(&result)) << operation.ShortDebugString();
  for (const v1::Front& front : {result, FrontOf(operation)}) {
    EXPECT_THAT(front.external_ids(), ElementsAre("100-4711/A"));
    EXPECT_EQ(front.labels().at("project"), "kitchen");
    EXPECT_EQ(front.creator(), "users/developer");
    EXPECT_GT(front.create_time().seconds(), 0);
  }
}

TEST_F(FrontTagsTest, ListFrontsByFilterAndSubject) {
  const v1::Front kitchen = FrontOf(Wait(Discover(Tagged(40, "100-1", "kitchen")).name()));
  const v1::Front hall = FrontOf(Wait(Discover(Tagged(40, "100-2", "hall")).name()));
  v1::DiscoverFrontRequest request = Tagged(40, "100-2", "");
  request.mutable_specification()->set_subject("evaluators/mixed");
  const v1::Front mixed = FrontOf(Wait(Discover(request).name()));

  const auto all = ElementsAre(mixed.name(), hall.name(), kitchen.name());
  EXPECT_THAT(Listed([](auto&) {}), all);
  EXPECT_THAT(Listed([](auto& list) { list.mutable_filter()->set_external_id("100-2"); }),
              ElementsAre(mixed.name(), hall.name()));
  EXPECT_THAT(Listed([](auto& list) { list.mutable_filter()->set_external_id("100"); }), IsEmpty());
  const auto labelled = [](const std::string& value) {
    return [value](auto& list) { (*list.mutable_filter()->mutable_labels())["project"] = value; };
  };
  EXPECT_THAT(Listed(labelled("hall")), ElementsAre(hall.name()));
  EXPECT_THAT(Listed(labelled("")), ElementsAre(hall.name(), kitchen.name()));
  EXPECT_THAT(Listed([](auto& list) { list.mutable_filter()->set_creator("users/developer"); }),
              all);
  EXPECT_THAT(Listed([](auto& list) { list.mutable_filter()->set_creator("users/ada"); }),
              IsEmpty());
  EXPECT_THAT(Listed([&](auto& list) {
                *list.mutable_filter()->mutable_created_from() = hall.create_time();
              }),
              ElementsAre(mixed.name(), hall.name()));
  EXPECT_THAT(Listed([&](auto& list) {
                *list.mutable_filter()->mutable_created_before() = hall.create_time();
              }),
              ElementsAre(kitchen.name()));
  EXPECT_THAT(Listed([](auto& list) { list.set_subject("evaluators/mixed"); }),
              ElementsAre(mixed.name()));
  EXPECT_THAT(Listed([](auto& list) { list.add_states(v1::Front::CANCELLED); }), IsEmpty());
  EXPECT_THAT(Listed([](auto& list) {
                list.add_states(v1::Front::BUDGET);
                list.add_states(v1::Front::CONVERGED);
              }),
              all);
  EXPECT_THAT(Listed([](auto& list) {
                list.set_subject("templates/zdt1");
                list.mutable_filter()->set_external_id("100-2");
              }),
              ElementsAre(hall.name()));
  EXPECT_THAT(Listed([](auto& list) { list.set_subject("templates/other"); }), IsEmpty());
}

TEST_F(FrontTagsTest, ChangeAndNothingElseDoes) {
  const v1::Front before = FrontOf(Wait(Discover(Tagged(40, "100-1", "kitchen")).name()));
  v1::PickPointRequest pick;
  pick.set_name(before.name());
  pick.set_index(0);
  v1::PickPointResponse picked;
  ASSERT_TRUE(Asked(pick, picked).ok());

  v1::Front changes;
  changes.set_name(before.name());
  changes.add_external_ids("PLM 7");
  changes.set_stop_reason("CONVERGED");
  changes.set_creator("users/eve");
  const auto updated = Update(changes, {"external_ids"});
  ASSERT_TRUE(updated.ok()) << updated.status();
  EXPECT_EQ(updated->points_size(), 0);
  EXPECT_EQ(updated->point_count(), before.points_size());
  v1::Front expected = before;
  expected.clear_external_ids();
  expected.add_external_ids("PLM 7");
  const v1::Front after = Get(before.name());
  EXPECT_EQ(after.DebugString(), expected.DebugString());
  EXPECT_THAT(Listed([](auto& list) { list.mutable_filter()->set_external_id("PLM 7"); }),
              ElementsAre(before.name()));
  v1::PickPointResponse again;
  ASSERT_TRUE(Asked(pick, again).ok());
  EXPECT_EQ(again.SerializeAsString(), picked.SerializeAsString());

  changes.clear_external_ids();
  ASSERT_TRUE(Update(changes).ok());
  pareto_->Kill();
  pareto_->Start();
  Connect();
  EXPECT_TRUE(Get(before.name()).labels().empty());
  EXPECT_THAT(Export(before.name(), v1::ExportFrontRequest::JSON), Not(HasSubstr("PLM 7")));
}

TEST_F(FrontTagsTest, SurviveKillNineAndCancellation) {
  evaluator_.HoldAfter(30);
  const v1::Operation started = Discover(Tagged(60, "100-1", "kitchen"));
  evaluator_.WaitUntilHeld();
  pareto_->Kill();
  evaluator_.Release();
  pareto_->Start();
  Connect();
  EXPECT_THAT(FrontOf(Wait(started.name())).external_ids(), ElementsAre("100-1"));

  evaluator_.HoldAfter(60);
  const v1::Operation endless = Discover(Tagged(5000, "100-2", "hall"));
  evaluator_.WaitUntilHeld();
  v1::CancelOperationRequest cancel;
  cancel.set_request_id(NewIdentifier());
  cancel.set_name(endless.name());
  ASSERT_TRUE(
      testing::Call(*operations_, &v1::OperationService::Stub::CancelOperation, cancel).ok());
  const v1::Front best = FrontOf(Wait(endless.name()));
  EXPECT_EQ(best.stop_reason(), "CANCELLED");
  EXPECT_THAT(best.external_ids(), ElementsAre("100-2"));
  EXPECT_EQ(best.labels().at("project"), "hall");
  EXPECT_EQ(best.creator(), "users/developer");
}

TEST_F(FrontTagsTest, ThatAreWrongAreToldWithAllElse) {
  v1::DiscoverFrontRequest request = Tagged(0, "100-1", "kitchen");
  request.add_external_ids("100-1");
  (*request.mutable_labels())[" "] = "blank";
  const absl::Status refused = testing::Call(*fronts_, &Service::DiscoverFront, request).status();
  EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()),
              AllOf(HasSubstr("specification.evaluations"), HasSubstr("external_ids[1]"),
                    HasSubstr("labels")));
  EXPECT_EQ(evaluator_.evaluations(), 0);

  v1::Front changes;
  changes.set_name("fronts/absent");
  EXPECT_TRUE(absl::IsNotFound(Update(changes).status()));
  changes.add_external_ids("");
  const absl::Status update = Update(changes, {"points"}).status();
  EXPECT_TRUE(absl::IsInvalidArgument(update)) << update;
  EXPECT_THAT(std::string(update.message()),
              AllOf(HasSubstr("front.external_ids[0]"), HasSubstr("update_mask")));
}

TEST_F(FrontTagsTest, OfListsThatCannotBeAreToldTogether) {
  for (const char* subject :
       {"zdt1", "templates/", "evaluators/A B", "fronts/zdt1", "templates/a/b"}) {
    v1::ListFrontsRequest list;
    list.set_subject(subject);
    list.set_page_size(-1);
    list.mutable_filter()->set_external_id("a\tb");
    const absl::Status refused = testing::Call(*fronts_, &Service::ListFronts, list).status();
    EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
    EXPECT_THAT(std::string(refused.message()),
                AllOf(HasSubstr("subject: must have the form templates/{id} or evaluators/{id}"),
                      HasSubstr("page_size"), HasSubstr("filter.external_id")));
  }
}

// Fronts that were stored when nobody knew of creators.
TEST(EarlierFronts, AreListedAndGetTags) {
  const testing::TemporaryFolder folder;
  {
    v1::Front front;
    front.set_name("fronts/earlier");
    front.mutable_specification()->set_subject("templates/table");
    front.mutable_create_time()->set_seconds(1'700'000'000);
    const auto store = store::OpenStore({.url = "sqlite:" + (folder.path() / "store.db").string()});
    ASSERT_TRUE(store.ok()) << store.status();
    const absl::Status put = (*store)->Transact([&](store::Transaction& transaction) {
      return transaction.Put("fronts", "earlier", front.SerializeAsString()).status();
    });
    ASSERT_TRUE(put.ok()) << put;
  }
  const testing::ServiceUnderTest pareto("mortise-pareto", {"--peer=simulator=127.0.0.1:1"}, "",
                                         folder.path());
  const auto stub = v1::ParetoService::NewStub(pareto.channel());
  v1::ListFrontsRequest list;
  list.set_subject("templates/table");
  list.mutable_filter()->mutable_created_before()->set_seconds(1'700'000'001);
  const auto page = testing::Call(*stub, &Service::ListFronts, list);
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_EQ(page->fronts_size(), 1);
  EXPECT_EQ(page->fronts(0).creator(), "");
  v1::UpdateFrontRequest update;
  update.set_request_id("update-1");
  update.mutable_front()->set_name("fronts/earlier");
  update.mutable_front()->add_external_ids("100-1");
  const auto updated = testing::Call(*stub, &Service::UpdateFront, update);
  ASSERT_TRUE(updated.ok()) << updated.status();
  EXPECT_THAT(updated->external_ids(), ElementsAre("100-1"));
  list.mutable_filter()->set_creator("users/developer");
  EXPECT_EQ(testing::Call(*stub, &Service::ListFronts, list)->fronts_size(), 0);
}

}  // namespace
}  // namespace mortise::pareto
