// The two records of a plan: created and changed together.
#include "services/fabplanner/shop_floor/plan_records.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "common/base/errors.h"
#include "common/resources/resource_tags.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::fabplanner {
namespace {

class PlanRecordsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    v1::Plan plan;
    plan.set_name("plans/p1");
    plan.set_template_("templates/table");
    plan.set_creator("users/ada");
    plan.add_external_ids("100-4711/A");
    (*plan.mutable_labels())["project"] = "loft";
    plan.add_boards()->set_label("board-1");
    plan.add_artifacts()->set_file_name("cut-list.csv");
    ASSERT_OK(store_->Transact(
        [&](store::Transaction& transaction) { return CreatePlanRecords(transaction, plan); }));
  }

  absl::StatusOr<v1::Plan> Update(const v1::UpdatePlanRequest& request) {
    absl::StatusOr<v1::Plan> updated = absl::UnknownError("not done");
    const absl::Status stored = store_->Transact([&](store::Transaction& transaction) {
      updated = UpdatePlanTags(transaction, request, {.user = "users/ben", .trace_id = "t-1"});
      return updated.status();
    });
    return stored.ok() ? updated : stored;
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = "sqlite:" + (folder_.path() / "store.db").string()}).value();
};

TEST_F(PlanRecordsTest, TheSummaryHasWhatPlansAreFoundBy) {
  const auto summary = kPlanSummaries.Get(*store_, "plans/p1");
  ASSERT_OK(summary);
  EXPECT_EQ(summary->template_(), "templates/table");
  EXPECT_EQ(summary->external_ids(0), "100-4711/A");
  EXPECT_EQ(summary->labels().at("project"), "loft");
  EXPECT_EQ(summary->creator(), "users/ada");
  EXPECT_EQ(summary->boards_size(), 0);
  EXPECT_EQ(summary->artifacts_size(), 0);
}

TEST_F(PlanRecordsTest, BothRecordsGetNewTags) {
  v1::UpdatePlanRequest request;
  request.mutable_plan()->set_name("plans/p1");
  request.mutable_plan()->set_creator("users/eve");
  request.mutable_plan()->set_template_("templates/chair");
  (*request.mutable_plan()->mutable_labels())["project"] = "shed";
  request.mutable_update_mask()->add_paths("labels");
  const auto updated = Update(request);
  ASSERT_OK(updated);
  const auto whole = kPlans.Get(*store_, "plans/p1");
  const auto summary = kPlanSummaries.Get(*store_, "plans/p1");
  ASSERT_OK(whole);
  ASSERT_OK(summary);
  EXPECT_TRUE(resources::HaveSameTags(*updated, *whole));
  EXPECT_TRUE(resources::HaveSameTags(*summary, *whole));
  for (const v1::Plan* plan : {&*updated, &*whole, &*summary}) {
    EXPECT_EQ(plan->labels().at("project"), "shed");
    EXPECT_EQ(plan->external_ids(0), "100-4711/A");
    EXPECT_EQ(plan->creator(), "users/ada");
    EXPECT_EQ(plan->template_(), "templates/table");
  }
  EXPECT_EQ(whole->boards_size(), 1);
  EXPECT_EQ(summary->boards_size(), 0);
}

TEST_F(PlanRecordsTest, AChangeThatIsRefusedChangesNeither) {
  v1::UpdatePlanRequest request;
  request.mutable_plan()->set_name("plans/p1");
  request.mutable_plan()->add_external_ids("");
  EXPECT_EQ(DetailOf(Update(request).status()).field, "plan.external_ids[0]");
  request.mutable_plan()->set_name("plans/none");
  request.mutable_plan()->clear_external_ids();
  EXPECT_TRUE(absl::IsNotFound(Update(request).status()));
  EXPECT_EQ(kPlans.Get(*store_, "plans/p1")->external_ids_size(), 1);
  EXPECT_EQ(kPlanSummaries.Get(*store_, "plans/p1")->external_ids_size(), 1);
}

TEST_F(PlanRecordsTest, APlanIsCreatedOnce) {
  v1::Plan plan;
  plan.set_name("plans/p1");
  EXPECT_EQ(DetailOf(store_->Transact([&](store::Transaction& transaction) {
              return CreatePlanRecords(transaction, plan);
            })).reason,
            "STALE_REVISION");
}

}  // namespace
}  // namespace mortise::fabplanner
