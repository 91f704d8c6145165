// Evaluators by what callers attach to them: external ids and labels, which their workers and their
// results do not depend on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/store/store.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/simulator/evaluator_fixture.h"

namespace mortise::simulator {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class EvaluatorTagsTest : public EvaluatorTest {
 protected:
  static v1::Evaluator Tagged(const std::string& id, const std::string& external_id,
                              const std::string& project) {
    v1::Evaluator evaluator = Beam();
    evaluator.set_name("evaluators/" + id);
    if (!external_id.empty()) evaluator.add_external_ids(external_id);
    if (!project.empty()) (*evaluator.mutable_labels())["project"] = project;
    return evaluator;
  }

  v1::Evaluator Get(const std::string& name) {
    v1::GetEvaluatorRequest request;
    request.set_name(name);
    const auto evaluator = testing::Call(*Evaluators(), &Service::GetEvaluator, request);
    EXPECT_TRUE(evaluator.ok()) << evaluator.status();
    return evaluator.value_or(v1::Evaluator());
  }

  std::vector<std::string> Listed(const std::function<void(v1::ResourceFilter&)>& ask) {
    v1::ListEvaluatorsRequest request;
    ask(*request.mutable_filter());
    const auto page = testing::Call(*Evaluators(), &Service::ListEvaluators, request);
    EXPECT_TRUE(page.ok()) << page.status();
    std::vector<std::string> names;
    if (!page.ok()) return names;
    for (const v1::Evaluator& evaluator : page->evaluators()) names.push_back(evaluator.name());
    return names;
  }

  absl::StatusOr<v1::Evaluator> Update(const v1::Evaluator& changes,
                                       const std::vector<std::string>& mask = {}) {
    v1::UpdateEvaluatorRequest request;
    request.set_request_id(NewIdentifier());
    *request.mutable_evaluator() = changes;
    for (const std::string& path : mask) request.mutable_update_mask()->add_paths(path);
    return testing::Call(*Evaluators(), &Service::UpdateEvaluator, request);
  }
};

TEST_F(EvaluatorTagsTest, AreKeptWithWhoCreatedIt) {
  v1::Evaluator evaluator = Tagged("beam", "100-1", "kitchen");
  evaluator.set_creator("users/eve");
  evaluator.mutable_create_time()->set_seconds(1);
  const auto created = Create(evaluator);
  ASSERT_TRUE(created.ok()) << created.status();
  for (const v1::Evaluator& found : {*created, Get("evaluators/beam")}) {
    EXPECT_THAT(found.external_ids(), ElementsAre("100-1"));
    EXPECT_EQ(found.labels().at("project"), "kitchen");
    EXPECT_EQ(found.creator(), "users/developer");
    EXPECT_GT(found.create_time().seconds(), 1);
  }
}

// A worker begins with CreateEvaluator at each of its starts, and knows nothing of labels.
TEST_F(EvaluatorTagsTest, MakeNoDifferenceToAWorkerThatBegins) {
  const auto created = Create(Tagged("beam", "100-1", "kitchen"));
  ASSERT_TRUE(created.ok()) << created.status();
  for (const v1::Evaluator& again : {Beam(), Tagged("beam", "100-2", "hall")}) {
    const auto same = Create(again);
    ASSERT_TRUE(same.ok()) << same.status();
    EXPECT_EQ(same->DebugString(), created->DebugString());
  }
  EXPECT_EQ(Get("evaluators/beam").DebugString(), created->DebugString());
  v1::Evaluator other = Tagged("beam", "100-1", "kitchen");
  other.set_version("2");
  EXPECT_TRUE(absl::IsAlreadyExists(Create(other).status()));
}

TEST_F(EvaluatorTagsTest, MakeNoDifferenceToResults) {
  ASSERT_TRUE(Create(Beam()).ok());
  v1::Evaluator changes;
  changes.set_name("evaluators/beam");
  const v1::EvaluateBatchRequest request = Batch(1, {"mass"});
  const absl::Status outcome = OutcomeOf(request, [&] {
    const v1::Task task = LeaseOne();
    changes.add_external_ids("100-1");
    EXPECT_TRUE(Update(changes).ok());
    EXPECT_TRUE(Report(task, Answer(task)).ok());
  });
  EXPECT_TRUE(outcome.ok()) << outcome;
  (*changes.mutable_labels())["project"] = "kitchen";
  ASSERT_TRUE(Update(changes).ok());
  // From memory; and after kill -9, from the store.
  for (int round = 0; round < 2; ++round) {
    if (round == 1) {
      service_.Kill();
      service_.Start();
    }
    const auto results = Evaluate(request);
    ASSERT_TRUE(results.ok()) << results.status();
    EXPECT_TRUE(results->at(0).cached());
  }
}

TEST_F(EvaluatorTagsTest, ListEvaluatorsByFilter) {
  const auto beam = Create(Tagged("beam", "100-2", "kitchen"));
  const auto arch = Create(Tagged("arch", "100-1", "hall"));
  const auto cable = Create(Tagged("cable", "100-2", ""));
  ASSERT_TRUE(beam.ok() && arch.ok() && cable.ok());
  EXPECT_THAT(Listed([](auto&) {}),
              ElementsAre("evaluators/arch", "evaluators/beam", "evaluators/cable"));
  EXPECT_THAT(Listed([](auto& filter) { filter.set_external_id("100-2"); }),
              ElementsAre("evaluators/beam", "evaluators/cable"));
  EXPECT_THAT(Listed([](auto& filter) { (*filter.mutable_labels())["project"] = ""; }),
              ElementsAre("evaluators/arch", "evaluators/beam"));
  EXPECT_THAT(Listed([](auto& filter) { (*filter.mutable_labels())["project"] = "hall"; }),
              ElementsAre("evaluators/arch"));
  EXPECT_THAT(Listed([](auto& filter) { filter.set_creator("users/ada"); }), IsEmpty());
  EXPECT_THAT(Listed([](auto& filter) { filter.set_creator("users/developer"); }),
              ElementsAre("evaluators/arch", "evaluators/beam", "evaluators/cable"));
  EXPECT_THAT(Listed([&](auto& filter) { *filter.mutable_created_from() = arch->create_time(); }),
              ElementsAre("evaluators/arch", "evaluators/cable"));
  EXPECT_THAT(Listed([&](auto& filter) { *filter.mutable_created_before() = arch->create_time(); }),
              ElementsAre("evaluators/beam"));
}

TEST_F(EvaluatorTagsTest, ChangeAndNothingElseDoes) {
  const auto created = Create(Tagged("beam", "100-1", "kitchen"));
  ASSERT_TRUE(created.ok()) << created.status();
  v1::Evaluator changes;
  changes.set_name("evaluators/beam");
  changes.set_title("Another");
  changes.set_creator("users/eve");
  (*changes.mutable_labels())["project"] = "hall";
  const auto updated = Update(changes, {"labels"});
  ASSERT_TRUE(updated.ok()) << updated.status();
  v1::Evaluator expected = *created;
  (*expected.mutable_labels())["project"] = "hall";
  EXPECT_EQ(updated->DebugString(), expected.DebugString());
  service_.Kill();
  service_.Start();
  EXPECT_EQ(Get("evaluators/beam").DebugString(), expected.DebugString());
}

TEST_F(EvaluatorTagsTest, ThatAreWrongAreToldWithAllElse) {
  v1::Evaluator evaluator = Tagged("beam", "100-1", "kitchen");
  evaluator.add_external_ids("100-1");
  (*evaluator.mutable_labels())["a b"] = "";
  evaluator.mutable_space()->mutable_parameters(0)->set_maximum(0);
  const absl::Status refused = Create(evaluator).status();
  EXPECT_TRUE(absl::IsInvalidArgument(refused)) << refused;
  EXPECT_THAT(std::string(refused.message()),
              AllOf(HasSubstr("evaluator.space.parameters[0].maximum"),
                    HasSubstr("evaluator.external_ids[1]"), HasSubstr("evaluator.labels")));

  v1::Evaluator changes;
  changes.set_name("evaluators/absent");
  EXPECT_TRUE(absl::IsNotFound(Update(changes).status()));
  changes.add_external_ids("");
  const absl::Status update = Update(changes, {"space"}).status();
  EXPECT_TRUE(absl::IsInvalidArgument(update)) << update;
  EXPECT_THAT(std::string(update.message()),
              AllOf(HasSubstr("evaluator.external_ids[0]"), HasSubstr("update_mask")));

  v1::ListEvaluatorsRequest list;
  list.mutable_filter()->set_external_id("a\tb");
  EXPECT_TRUE(absl::IsInvalidArgument(
      testing::Call(*Evaluators(), &Service::ListEvaluators, list).status()));
}

// Records that were stored when nobody knew of creators.
TEST(EarlierSimulatorRecords, AreListedAndGetTags) {
  const testing::TemporaryFolder folder;
  {
    v1::Analysis analysis;
    analysis.set_name("analyses/earlier");
    analysis.set_template_("templates/table");
    v1::Evaluator evaluator;
    ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(kBeam, &evaluator));
    evaluator.mutable_space()->set_subject("evaluators/beam");
    evaluator.mutable_space()->set_revision(1);
    const auto store = store::OpenStore({.url = "sqlite:" + (folder.path() / "store.db").string()});
    ASSERT_TRUE(store.ok()) << store.status();
    const absl::Status put =
        (*store)->Transact([&](store::Transaction& transaction) -> absl::Status {
          MORTISE_RETURN_IF_ERROR(
              transaction.Put("analyses", "earlier", analysis.SerializeAsString()).status());
          return transaction.Put("evaluators", "beam", evaluator.SerializeAsString()).status();
        });
    ASSERT_TRUE(put.ok()) << put;
  }
  const testing::ServiceUnderTest simulator("mortise-simulator", {"--peer=catalog=127.0.0.1:1"}, "",
                                            folder.path());
  const auto analyses = v1::SimulatorService::NewStub(simulator.channel());
  v1::ListAnalysesRequest list;
  list.set_subject("templates/table");
  const auto page = testing::Call(*analyses, &v1::SimulatorService::Stub::ListAnalyses, list);
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_EQ(page->analyses_size(), 1);
  EXPECT_EQ(page->analyses(0).creator(), "");
  const auto evaluators = v1::EvaluatorService::NewStub(simulator.channel());
  v1::UpdateEvaluatorRequest update;
  update.set_request_id("update-1");
  update.mutable_evaluator()->set_name("evaluators/beam");
  update.mutable_evaluator()->add_external_ids("100-1");
  const auto updated =
      testing::Call(*evaluators, &v1::EvaluatorService::Stub::UpdateEvaluator, update);
  ASSERT_TRUE(updated.ok()) << updated.status();
  // A worker of that time still begins.
  v1::CreateEvaluatorRequest create;
  create.set_request_id("create-1");
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(kBeam, create.mutable_evaluator()));
  const auto again =
      testing::Call(*evaluators, &v1::EvaluatorService::Stub::CreateEvaluator, create);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->DebugString(), updated->DebugString());
}

}  // namespace
}  // namespace mortise::simulator
