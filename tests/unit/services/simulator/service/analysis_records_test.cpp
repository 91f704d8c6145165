// Analyses in the store: each is written once.
#include "services/simulator/service/analysis_records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "common/base/errors.h"
#include "tests/support/temporary_folder.h"

namespace mortise::simulator {
namespace {

class AnalysisRecordsTest : public ::testing::Test {
 protected:
  static v1::Analysis Found() {
    v1::Analysis analysis;
    analysis.set_name("analyses/a1");
    analysis.set_creator("users/ada");
    analysis.add_external_ids("100-4711/A");
    return analysis;
  }

  absl::StatusOr<v1::Analysis> Keep(const v1::Analysis& analysis) {
    absl::StatusOr<v1::Analysis> kept = absl::UnknownError("not done");
    const absl::Status stored = store_->Transact([&](store::Transaction& transaction) {
      kept = KeepAnalysis(transaction, analysis, "t-1");
      return kept.status();
    });
    return stored.ok() ? kept : stored;
  }

  const testing::TemporaryFolder folder_;
  const std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = "sqlite:" + (folder_.path() / "store.db").string()}).value();
};

TEST_F(AnalysisRecordsTest, AnAnalysisIsKeptWithItsTimeAndTags) {
  const auto kept = Keep(Found());
  ASSERT_TRUE(kept.ok()) << kept.status();
  EXPECT_GT(kept->create_time().seconds(), 0);
  const auto found = kAnalyses.Get(*store_, "analyses/a1");
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->SerializeAsString(), kept->SerializeAsString());
  EXPECT_THAT(found->external_ids(), ::testing::ElementsAre("100-4711/A"));
}

// A process that dies between the analysis and the end of its operation runs the operation again.
TEST_F(AnalysisRecordsTest, TheNextRunOfItsOperationChangesNothing) {
  ASSERT_TRUE(Keep(Found()).ok());
  v1::Analysis changes;
  changes.set_name("analyses/a1");
  changes.add_external_ids("PLM 7");
  absl::StatusOr<v1::Analysis> changed = absl::UnknownError("not done");
  ASSERT_TRUE(store_
                  ->Transact([&](store::Transaction& transaction) {
                    changed = kAnalyses.UpdateTags(transaction, changes, {}, "analysis",
                                                   {.user = "users/ada", .trace_id = "t-2"});
                    return changed.status();
                  })
                  .ok());
  const auto again = Keep(Found());
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->SerializeAsString(), changed->SerializeAsString());
  EXPECT_THAT(kAnalyses.Get(*store_, "analyses/a1")->external_ids(),
              ::testing::ElementsAre("PLM 7"));
}

}  // namespace
}  // namespace mortise::simulator
