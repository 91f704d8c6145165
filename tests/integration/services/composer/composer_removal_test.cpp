// What is left when nodes are taken out of a model, and what nothing holds of it any more:
// mortise-composer as a real process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/integration/services/composer/composer_house.h"

namespace mortise::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ComposerRemovalTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<ComposerHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  static std::unique_ptr<ComposerHouse> house_;
};

std::unique_ptr<ComposerHouse> ComposerRemovalTest::house_;

v1::Model Good(const absl::StatusOr<v1::Model>& model) {
  EXPECT_TRUE(model.ok()) << model.status();
  return model.value_or(v1::Model());
}

// What nothing holds, as the model's warnings have it.
std::vector<std::string> UnheldIn(const v1::Model& model) {
  std::vector<std::string> parts;
  for (const v1::ModelWarning& warning : model.warnings()) {
    parts.insert(parts.end(), warning.elements().begin(), warning.elements().end());
  }
  return parts;
}

TEST_F(ComposerRemovalTest, ALegWithoutItsApronsIsWarnedOfUntilItIsHeldAgain) {
  v1::Model model = house_->New("legs");
  model = Good(house_->Add(model, "dining-table", "", "table"));
  const v1::Model one_less = Good(house_->Remove(model, "long apron 1"));
  EXPECT_THAT(one_less.warnings(), IsEmpty());
  const v1::Model loose = Good(house_->Remove(one_less, "short apron 1"));
  ASSERT_EQ(loose.warnings_size(), 1);
  EXPECT_EQ(loose.warnings(0).component(), "table");
  EXPECT_EQ(loose.warnings(0).element(), "leg 1.1");
  EXPECT_THAT(loose.warnings(0).elements(), ElementsAre("leg 1.1"));
  EXPECT_THAT(loose.warnings(0).other_element(), IsEmpty());
  EXPECT_THAT(loose.warnings(0).text(), HasSubstr("nothing"));
  // It is of the revision: read again, undone and done again.
  EXPECT_THAT(UnheldIn(Good(house_->Get(model.name()))), ElementsAre("leg 1.1"));
  model = Good(house_->Undo(loose));
  EXPECT_THAT(model.warnings(), IsEmpty());
  EXPECT_EQ(model.digest(), one_less.digest());
  model = Good(house_->Redo(model));
  EXPECT_EQ(model.digest(), loose.digest());
  EXPECT_THAT(UnheldIn(model), ElementsAre("leg 1.1"));
  // Steps of anything else say it, too.
  model = Good(house_->Add(model, "dining-table", "long apron 1", "apron"));
  EXPECT_THAT(UnheldIn(model), ElementsAre("leg 1.1"));
  model = Good(house_->Connect(model, "apron"));
  EXPECT_THAT(model.warnings(), IsEmpty());
}

// The bookshelf is drawn with a plinth and a back that nothing fastens: they may be glued, and are
// no more loose than before when a side goes.
TEST_F(ComposerRemovalTest, WhatItsDesignDoesNotFastenIsNotWarnedOf) {
  v1::Model model = house_->New("sides");
  model = Good(house_->Add(model, "bookshelf", "", "shelf"));
  model = Good(house_->Remove(model, "side 1"));
  EXPECT_THAT(model.warnings(), IsEmpty());
}

TEST_F(ComposerRemovalTest, ALooseComponentThatGoesLeavesNothingLoose) {
  v1::Model model = house_->New("top");
  model = Good(house_->Add(model, "dining-table", "frame", "frame"));
  model = Good(house_->Add(model, "dining-table", "top", "top"));
  v1::RemoveNodeRequest request;
  request.set_component("top");
  model = Good(house_->Change(&v1::ComposerService::Stub::RemoveNode, model, request));
  EXPECT_THAT(model.warnings(), IsEmpty());
  EXPECT_EQ(model.components_size(), 1);
}

}  // namespace
}  // namespace mortise::testing
