// Working models survive whatever happens to the process, and every state of them comes back as it
// was: mortise-composer as a real process, beside a catalog.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "tests/integration/services/composer/composer_house.h"

namespace mortise::testing {
namespace {

using Stub = v1::ComposerService::Stub;

class ComposerHistoryTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<ComposerHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  static std::unique_ptr<ComposerHouse> house_;
};

std::unique_ptr<ComposerHouse> ComposerHistoryTest::house_;

// What `status_or` holds; the test fails where it holds nothing.
template <typename T>
T Good(const absl::StatusOr<T>& status_or) {
  EXPECT_TRUE(status_or.ok()) << status_or.status();
  return status_or.value_or(T());
}

TEST_F(ComposerHistoryTest, EveryStateSurvivesTheEndOfTheProcess) {
  v1::Model model = house_->New("restarted");
  std::vector<v1::Model> states = {model};
  const auto keep = [&](const absl::StatusOr<v1::Model>& changed) {
    model = Good(changed);
    states.push_back(model);
    house_->KillAndStart();
    const v1::Model read = Good(house_->Get(model.name()));
    EXPECT_EQ(read.SerializeAsString(), model.SerializeAsString()) << model.last_step();
  };
  keep(house_->Add(model, "dining-table", "frame", "frame"));
  keep(house_->Add(model, "dining-table", "top", "top"));
  keep(house_->Snap(model, "top"));
  keep(house_->Connect(model, "top"));
  keep(house_->Drag(model, "", "width", 1.8));
  keep(house_->Add(model, "bookshelf", "shelf 3", "shelf"));
  for (std::size_t step = states.size() - 1; step > 0; --step) {
    model = Good(house_->Undo(model));
    EXPECT_EQ(model.digest(), states[step - 1].digest()) << states[step].last_step();
    EXPECT_EQ(model.parts_size(), states[step - 1].parts_size());
    house_->KillAndStart();
  }
  for (std::size_t step = 1; step < states.size(); ++step) {
    model = Good(house_->Redo(model));
    EXPECT_EQ(model.digest(), states[step].digest()) << states[step].last_step();
  }
  EXPECT_EQ(house_->Redo(model).status().code(), absl::StatusCode::kFailedPrecondition);
}

TEST_F(ComposerHistoryTest, TheSameStepsGiveTheSameModel) {
  std::vector<std::string> digests;
  for (const char* const id : {"once", "twice"}) {
    v1::Model model = house_->New(id);
    model = Good(house_->Add(model, "dining-table", "frame", "frame"));
    model = Good(house_->Add(model, "dining-table", "top", "top"));
    model = Good(house_->Connect(model, "top"));
    // In a process that knows nothing of what was before.
    house_->KillAndStart();
    model = Good(house_->Drag(model, "", "width", 1.7));
    std::string boxes;
    for (const v1::ModelPart& part : model.parts()) boxes += part.SerializeAsString();
    digests.push_back(boxes);
  }
  EXPECT_EQ(digests[0], digests[1]);
}

TEST_F(ComposerHistoryTest, OfTwoWritersOneLosesNothingAndGoesOn) {
  const v1::Model empty = house_->New("contested");
  const v1::Model seen = Good(house_->Add(empty, "dining-table", "frame", "frame"));
  const v1::Model first = Good(house_->Add(seen, "dining-table", "top", "top"));
  const auto late = house_->Add(seen, "bookshelf", "shelf 3", "shelf");
  EXPECT_EQ(late.status().code(), absl::StatusCode::kAborted);
  EXPECT_EQ(DetailOf(late.status()).reason, "STALE_REVISION");
  EXPECT_EQ(Good(house_->Get(seen.name())).digest(), first.digest());
  EXPECT_TRUE(house_->Add(first, "bookshelf", "shelf 3", "shelf").ok());
}

// Who was refused reads what happened since the revision that they saw.
TEST_F(ComposerHistoryTest, WhatHappenedMeanwhileCanBeRead) {
  const v1::Model empty = house_->New("told");
  const v1::Model seen = Good(house_->Add(empty, "dining-table", "frame", "frame"));
  v1::Model model = Good(house_->Add(seen, "dining-table", "top", "top"));
  model = Good(house_->Drag(model, "", "width", 1.8));
  model = Good(house_->Undo(model));
  v1::ListModelStepsRequest request;
  request.set_name(seen.name());
  request.set_after_revision(seen.revision());
  request.set_page_size(2);
  v1::ListModelStepsResponse page = Good(Call(house_->composer(), &Stub::ListModelSteps, request));
  ASSERT_EQ(page.steps_size(), 2);
  const v1::ModelStep& added = page.steps(0);
  EXPECT_EQ(added.revision(), seen.revision() + 1);
  EXPECT_EQ(added.text(), "add top");
  EXPECT_FALSE(added.user().empty());
  ASSERT_EQ(added.components_size(), 1);
  EXPECT_EQ(added.components(0).id(), "top");
  EXPECT_EQ(added.components(0).change(), v1::ModelStep::ADDED);
  ASSERT_GT(added.parts_size(), 0);
  EXPECT_EQ(added.parts(0).change(), v1::ModelStep::ADDED);
  const v1::ModelStep& dragged = page.steps(1);
  ASSERT_EQ(dragged.components_size(), 1);
  EXPECT_EQ(dragged.components(0).id(), "frame");
  EXPECT_EQ(dragged.components(0).change(), v1::ModelStep::CHANGED);
  request.set_page_token(page.next_page_token());
  page = Good(Call(house_->composer(), &Stub::ListModelSteps, request));
  ASSERT_EQ(page.steps_size(), 1);
  EXPECT_EQ(page.steps(0).text(), "undo drag width");
  EXPECT_EQ(page.steps(0).digest(), model.digest());
  EXPECT_TRUE(page.next_page_token().empty());
  request.clear_page_token();
  request.set_after_revision(-1);
  EXPECT_EQ(DetailOf(Call(house_->composer(), &Stub::ListModelSteps, request).status()).field,
            "after_revision");
  request.set_name("models/never");
  request.set_after_revision(0);
  EXPECT_EQ(Call(house_->composer(), &Stub::ListModelSteps, request).status().code(),
            absl::StatusCode::kNotFound);
}

TEST_F(ComposerHistoryTest, ARepeatedRequestIsDoneOnce) {
  const v1::Model empty = house_->New("repeated");
  v1::AddComponentRequest request;
  request.set_request_id("the-same");
  request.set_name(empty.name());
  request.set_revision(empty.revision());
  request.set_template_("templates/dining-table");
  const v1::Model once = Good(Call(house_->composer(), &Stub::AddComponent, request));
  house_->KillAndStart();
  const v1::Model again = Good(Call(house_->composer(), &Stub::AddComponent, request));
  EXPECT_EQ(again.SerializeAsString(), once.SerializeAsString());
  EXPECT_EQ(Good(house_->Get(empty.name())).revision(), 2);
}

TEST_F(ComposerHistoryTest, AForkGoesItsOwnWay) {
  const v1::Model empty = house_->New("trunk");
  const v1::Model trunk = Good(house_->Add(empty, "dining-table", "", "table"));
  v1::ForkModelRequest request;
  request.set_request_id("fork");
  request.set_name(trunk.name());
  request.set_model_id("branch");
  const v1::Model branch = Good(Call(house_->composer(), &Stub::ForkModel, request));
  EXPECT_EQ(branch.digest(), trunk.digest());
  EXPECT_EQ(branch.undo_steps(), 0);
  const v1::Model changed = Good(house_->Add(branch, "bookshelf", "shelf 3", "shelf"));
  EXPECT_NE(changed.digest(), trunk.digest());
  EXPECT_EQ(Good(house_->Get(trunk.name())).digest(), trunk.digest());
  // What a model is made of is its own.
  v1::DeleteModelRequest remove;
  remove.set_request_id("remove");
  remove.set_name(trunk.name());
  remove.set_revision(trunk.revision());
  EXPECT_TRUE(Call(house_->composer(), &Stub::DeleteModel, remove).ok());
  house_->KillAndStart();
  EXPECT_TRUE(house_->Undo(changed).ok());
  EXPECT_TRUE(house_->Add(changed, "bookshelf", "shelf 2", "other").status().code() ==
              absl::StatusCode::kAborted);
  EXPECT_EQ(house_->Get(trunk.name()).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(ComposerHistoryTest, TitlesAndTagsAreNoStep) {
  const v1::Model model = house_->New("tagged");
  v1::UpdateModelRequest request;
  request.set_request_id("tags");
  request.mutable_model()->set_name(model.name());
  request.mutable_model()->set_title("A table");
  request.mutable_model()->add_external_ids("100-4711/A");
  request.mutable_update_mask()->add_paths("title");
  v1::Model changed = Good(Call(house_->composer(), &Stub::UpdateModel, request));
  EXPECT_EQ(changed.title(), "A table");
  EXPECT_EQ(changed.external_ids_size(), 0);
  EXPECT_EQ(changed.revision(), model.revision());
  request.set_request_id("more-tags");
  request.mutable_model()->clear_title();
  request.clear_update_mask();
  changed = Good(Call(house_->composer(), &Stub::UpdateModel, request));
  EXPECT_EQ(changed.title(), "A table");
  EXPECT_EQ(changed.external_ids_size(), 1);
  v1::ListModelsRequest list;
  list.mutable_filter()->set_external_id("100-4711/A");
  const v1::ListModelsResponse listed = Good(Call(house_->composer(), &Stub::ListModels, list));
  ASSERT_EQ(listed.models_size(), 1);
  EXPECT_EQ(listed.models(0).name(), model.name());
}

}  // namespace
}  // namespace mortise::testing
