// Builds as operations: which count as under way, which are not started again, whose turn it is.
#include "services/retrieval/service/index_builds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

#include "common/base/errors.h"
#include "common/operations/operation_kinds.h"
#include "common/store/store.h"
#include "tests/support/temporary_folder.h"

namespace mortise::retrieval {
namespace {

using ::testing::HasSubstr;

const Revisions kTemplates = {{"templates/boat", 1}, {"templates/table", 3}};

class IndexBuildsTest : public ::testing::Test {
 protected:
  IndexBuildsTest() {
    store_ = store::OpenStore({.url = "sqlite:" + (folder_.path() / "store.db").string(),
                               .service = "retrieval"})
                 .value();
    operations_ = operations::Operations::Create({.service = "retrieval"}, store_.get()).value();
    operations_->Register(operations::kIndexOperation,
                          [this](operations::OperationContext& context) { return Run(context); });
  }

  // Until Resume none ever runs.
  std::string Start(const std::string& creator, std::vector<v1::ShapeDescriptor> descriptors = {},
                    const Revisions& templates = kTemplates) {
    v1::BuildIndexRequest request;
    for (const v1::ShapeDescriptor each : descriptors) request.add_shape_descriptors(each);
    std::string name;
    const absl::Status started =
        store_->Transact([&](store::Transaction& transaction) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(
              const operations::Operation operation,
              operations_->Start(transaction, {.kind = operations::kIndexOperation,
                                               .request = request.SerializeAsString(),
                                               .subject = "indexes",
                                               .creator = creator,
                                               .tags = TagsOf(templates)}));
          name = operation.name;
          return absl::OkStatus();
        });
    EXPECT_TRUE(started.ok()) << started;
    return name;
  }

  void Cancel(const std::string& name) { EXPECT_TRUE(operations_->Cancel(name).ok()); }

  bool GivenUp(v1::ShapeDescriptor descriptor, const Revisions& templates = kTemplates) {
    const auto given_up = IsGivenUp(*operations_, descriptor, templates);
    EXPECT_TRUE(given_up.ok()) << given_up.status();
    return given_up.value_or(false);
  }

  // Has the turn until it may go.
  absl::StatusOr<std::string> Run(operations::OperationContext& context) {
    MORTISE_ASSIGN_OR_RETURN(const std::unique_lock turn, turn_.Take(context));
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return may_go_; });
    return "";
  }

  const testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_;
  BuildTurn turn_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool may_go_ = false;  // guarded by mutex_
  std::unique_ptr<operations::Operations> operations_;
};

TEST_F(IndexBuildsTest, WhatIsPendingIsUnderWay) {
  EXPECT_EQ(BuildUnderWay(*operations_, v1::D2).value(), std::nullopt);
  const std::string voxel = Start("users/ada", {v1::VOXEL});
  EXPECT_EQ(BuildUnderWay(*operations_, v1::D2).value(), std::nullopt);
  EXPECT_EQ(BuildUnderWay(*operations_, v1::VOXEL).value(), voxel);
  const std::string all = Start("users/ada");
  EXPECT_EQ(BuildUnderWay(*operations_, v1::D2).value(), all);
  Cancel(all);
  EXPECT_EQ(BuildUnderWay(*operations_, v1::D2).value(), std::nullopt);
}

TEST_F(IndexBuildsTest, ACancelledBuildOfTheServiceIsGivenUpUntilATemplateChanges) {
  const std::string own = Start(kUpkeepCreator, {v1::D2, v1::VOXEL});
  EXPECT_FALSE(GivenUp(v1::D2)) << "it is under way";
  Cancel(own);
  EXPECT_TRUE(GivenUp(v1::D2));
  EXPECT_TRUE(GivenUp(v1::VOXEL));
  EXPECT_FALSE(GivenUp(v1::LIGHT_FIELD));
  Revisions changed = kTemplates;
  changed["templates/table"] = 4;
  EXPECT_FALSE(GivenUp(v1::D2, changed));
  changed = kTemplates;
  changed.erase("templates/boat");
  EXPECT_FALSE(GivenUp(v1::D2, changed));
}

TEST_F(IndexBuildsTest, WhoAsksForABuildWantsItAgain) {
  Cancel(Start(kUpkeepCreator, {v1::D2}));
  const std::string asked = Start("users/ada", {v1::D2});
  EXPECT_FALSE(GivenUp(v1::D2));
  Cancel(asked);
  EXPECT_TRUE(GivenUp(v1::D2)) << "they do not want it after all";
}

TEST_F(IndexBuildsTest, ABuildThatWaitsSaysForWhich) {
  const std::string first = Start("users/ada"), second = Start("users/ada");
  std::string message, holder;
  const auto watch = [&](const std::string& name, const std::string& other) {
    return operations_->Watch(name, [&, other](const operations::Operation& now) {
      if (now.progress.message.empty()) return;
      const std::lock_guard lock(mutex_);
      message = now.progress.message;
      holder = other;
      changed_.notify_all();
    });
  };
  const auto one = watch(first, second), two = watch(second, first);
  ASSERT_TRUE(one.ok() && two.ok());
  ASSERT_TRUE(operations_->Resume().ok());
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !message.empty(); });
    EXPECT_THAT(message, HasSubstr("waiting"));
    EXPECT_THAT(message, HasSubstr(holder));
    may_go_ = true;
  }
  changed_.notify_all();
  for (const std::string& name : {first, second}) {
    EXPECT_EQ(operations_->Wait(name, absl::InfiniteFuture())->state,
              operations::OperationState::kSucceeded);
  }
}

TEST(WhoLeftTest, NamesTemplatesThatANewDeltaLeftBehind) {
  v1::ShapeIndex before, after;
  after.set_name("indexes/d2");
  before.set_delta(0.1);
  for (const char* const name : {"templates/boat", "templates/gone", "templates/table"}) {
    before.add_families()->set_template_(name);
  }
  after.set_delta(0.1);
  after.add_families()->set_template_("templates/table");
  EXPECT_EQ(WhoLeft(before, after, kTemplates), "") << "the delta is the same";
  after.set_delta(0.3);
  const std::string note = WhoLeft(before, after, kTemplates);
  EXPECT_THAT(note, HasSubstr("1 template has left indexes/d2"));
  EXPECT_THAT(note, HasSubstr("templates/boat."));
  EXPECT_THAT(note, ::testing::Not(HasSubstr("gone")));
  after.add_families()->set_template_("templates/boat");
  EXPECT_EQ(WhoLeft(before, after, kTemplates), "");
}

}  // namespace
}  // namespace mortise::retrieval
