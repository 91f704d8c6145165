// Several who change one model at the same time: what does not touch what the other has changed is
// done to the model as it is by then.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "tests/integration/services/composer/composer_house.h"

namespace mortise::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Stub = v1::ComposerService::Stub;

class ComposerRebaseTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<ComposerHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  // A frame with a top and a shelf that are loose.
  static v1::Model Table(const std::string& id) {
    v1::Model model = house_->New(id);
    for (const auto& [from, group, component] :
         {std::tuple("dining-table", "frame", "frame"), std::tuple("dining-table", "top", "top"),
          std::tuple("bookshelf", "shelf 3", "shelf")}) {
      auto added = house_->Add(model, from, group, component);
      EXPECT_TRUE(added.ok()) << added.status();
      model = added.value_or(v1::Model());
    }
    return model;
  }

  static v1::MoveComponentRequest MoveTo(const std::string& component, double x) {
    v1::MoveComponentRequest request;
    request.set_component(component);
    request.mutable_position()->set_x(x);
    request.mutable_position()->set_z(1);
    request.set_rebase(true);
    return request;
  }

  static v1::DragControlRequest Widen(const std::string& node, double value) {
    v1::DragControlRequest request;
    request.set_node(node);
    request.set_control("width");
    request.set_value(value);
    request.set_rebase(true);
    return request;
  }

  static v1::RemoveNodeRequest Without(const std::string& node) {
    v1::RemoveNodeRequest request;
    request.set_node(node);
    request.set_rebase(true);
    return request;
  }

  static void ExpectConflict(const absl::Status& status, const std::string& step,
                             const std::string& part) {
    EXPECT_EQ(status.code(), absl::StatusCode::kAborted) << status;
    EXPECT_EQ(DetailOf(status).reason, "REBASE_CONFLICT");
    EXPECT_THAT(std::string(status.message()), AllOf(HasSubstr(step), HasSubstr(part)));
  }

  static std::unique_ptr<ComposerHouse> house_;
};

std::unique_ptr<ComposerHouse> ComposerRebaseTest::house_;

v1::Model Good(const absl::StatusOr<v1::Model>& model) {
  EXPECT_TRUE(model.ok()) << model.status();
  return model.value_or(v1::Model());
}

TEST_F(ComposerRebaseTest, WhatTheOtherLeftAloneIsDoneToTheNewestRevision) {
  const v1::Model seen = Table("apart");
  const v1::Model other = Good(house_->Change(&Stub::MoveComponent, seen, MoveTo("top", 0.8)));
  v1::MoveComponentRequest without = MoveTo("shelf", 2);
  without.set_rebase(false);
  EXPECT_EQ(DetailOf(house_->Change(&Stub::MoveComponent, seen, without).status()).reason,
            "STALE_REVISION");
  const v1::Model mine = Good(house_->Change(&Stub::MoveComponent, seen, MoveTo("shelf", 2)));
  EXPECT_EQ(mine.revision(), other.revision() + 1);
  // Both changes are in it, and each can be undone.
  for (const v1::ModelComponent& component : mine.components()) {
    const double middle = (component.minimum().x() + component.maximum().x()) / 2;
    if (component.id() == "top") {
      EXPECT_NEAR(middle, 0.8, 1e-9);
    } else if (component.id() == "shelf") {
      EXPECT_NEAR(middle, 2, 1e-9);
    }
  }
  EXPECT_EQ(Good(house_->Undo(mine)).digest(), other.digest());
}

TEST_F(ComposerRebaseTest, WhatTheOtherChangedIsToldOf) {
  const v1::Model seen = Table("together");
  v1::Model model = Good(house_->Change(&Stub::MoveComponent, seen, MoveTo("top", 0.8)));
  model = Good(house_->Change(&Stub::DragControl, model, Widen("", 1.8)));
  ExpectConflict(house_->Change(&Stub::MoveComponent, seen, MoveTo("top", 1)).status(), "move top",
                 "'top'");
  ExpectConflict(house_->Change(&Stub::DragControl, seen, Widen("long apron 1", 1.7)).status(),
                 "drag width", "'long apron 1'");
  ExpectConflict(house_->Change(&Stub::DragControl, seen, Widen("", 1.7)).status(), "drag width",
                 " more");
  EXPECT_EQ(Good(house_->Get(seen.name())).digest(), model.digest());
  // Those of whom only the place of others has changed go on.
  const v1::Model after = Good(house_->Change(&Stub::DragControl, model, Widen("", 1.6)));
  EXPECT_TRUE(house_->Change(&Stub::MoveComponent, model, MoveTo("shelf", 2)).ok());
  EXPECT_GT(after.revision(), model.revision());
}

TEST_F(ComposerRebaseTest, WhatIsGoneIsToldOfAsWell) {
  const v1::Model empty = house_->New("gone");
  const v1::Model seen = Good(house_->Add(empty, "dining-table", "", "table"));
  const v1::Model model = Good(house_->Change(&Stub::RemoveNode, seen, Without("long apron 1")));
  ExpectConflict(house_->Change(&Stub::DragControl, seen, Widen("long apron 1", 1.7)).status(),
                 "remove long apron 1", "'long apron 1'");
  ExpectConflict(house_->Change(&Stub::RemoveNode, seen, Without("frame")).status(),
                 "remove long apron 1", "changed '");
  // The other aprons are where they were.
  const v1::Model rest = Good(house_->Change(&Stub::RemoveNode, seen, Without("short apron 1")));
  EXPECT_EQ(rest.revision(), model.revision() + 1);
}

TEST_F(ComposerRebaseTest, ARevisionThatThereNeverWasIsStale) {
  v1::Model seen = Table("never");
  for (const std::int64_t revision : {std::int64_t{-1}, seen.revision() + 1}) {
    seen.set_revision(revision);
    EXPECT_EQ(
        DetailOf(house_->Change(&Stub::MoveComponent, seen, MoveTo("top", 1)).status()).reason,
        "STALE_REVISION");
  }
}

// Writers who all saw the same revision, at the same time: nothing of what they do gets lost.
TEST_F(ComposerRebaseTest, OfManyAtOnceEachIsDone) {
  constexpr int kWriters = 4, kEach = 2;
  const v1::Model seen = Table("raced");
  std::vector<std::thread> writers;
  std::vector<absl::Status> failed(kWriters);
  for (int writer = 0; writer < kWriters; ++writer) {
    writers.emplace_back([&, writer] {
      for (int i = 0; i < kEach && failed[writer].ok(); ++i) {
        v1::AddComponentRequest request;
        request.set_request_id(absl::StrCat("race-", writer, "-", i));
        request.set_name(seen.name());
        request.set_revision(seen.revision());
        request.set_template_("templates/bookshelf");
        request.set_group("shelf 3");
        request.set_component_id(absl::StrCat("shelf-", writer, "-", i));
        request.set_rebase(true);
        failed[writer] = Call(house_->composer(), &Stub::AddComponent, request).status();
      }
    });
  }
  for (std::thread& writer : writers) writer.join();
  for (const absl::Status& status : failed) EXPECT_TRUE(status.ok()) << status;
  const v1::Model after = Good(house_->Get(seen.name()));
  EXPECT_EQ(after.revision(), seen.revision() + kWriters * kEach);
  EXPECT_EQ(after.components_size(), seen.components_size() + kWriters * kEach);
}

// Of two who move the same component at once, one is told of the other.
TEST_F(ComposerRebaseTest, OfTwoAtOneThingOneIsToldOfTheOther) {
  const v1::Model seen = Table("contended");
  for (int round = 0; round < 5; ++round) {
    const v1::Model now = Good(house_->Get(seen.name()));
    std::vector<absl::Status> answers(2);
    std::vector<std::thread> writers;
    for (int writer = 0; writer < 2; ++writer) {
      writers.emplace_back([&, writer] {
        v1::MoveComponentRequest request = MoveTo("top", 2 * round + writer + 1);
        request.set_request_id(absl::StrCat("contended-", round, "-", writer));
        request.set_name(now.name());
        request.set_revision(now.revision());
        answers[writer] = Call(house_->composer(), &Stub::MoveComponent, request).status();
      });
    }
    for (std::thread& writer : writers) writer.join();
    const auto done = std::count_if(answers.begin(), answers.end(),
                                    [](const absl::Status& status) { return status.ok(); });
    EXPECT_EQ(done, 1);
    for (const absl::Status& status : answers) {
      if (!status.ok()) ExpectConflict(status, "move top", "'top'");
    }
    EXPECT_EQ(Good(house_->Get(seen.name())).revision(), now.revision() + 1);
  }
}

}  // namespace
}  // namespace mortise::testing
