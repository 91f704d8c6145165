// Models are asked whether they will stand and hold: mortise-composer as a real process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "common/base/errors.h"
#include "tests/integration/services/composer/composer_house.h"

namespace mortise::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Stub = v1::ComposerService::Stub;

class ComposerCheckTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<ComposerHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  static absl::StatusOr<v1::ModelCheck> Check(const std::string& name) {
    v1::CheckModelRequest request;
    request.set_name(name);
    return Call(house_->composer(), &Stub::CheckModel, request);
  }

  static std::unique_ptr<ComposerHouse> house_;
};

std::unique_ptr<ComposerHouse> ComposerCheckTest::house_;

TEST_F(ComposerCheckTest, ATableStandsAndIsHeldTogether) {
  const v1::Model empty = house_->New("table");
  const auto table = house_->Add(empty, "dining-table", "", "table");
  ASSERT_TRUE(table.ok()) << table.status();
  const auto check = Check(table->name());
  ASSERT_TRUE(check.ok()) << check.status();
  EXPECT_EQ(check->revision(), table->revision());
  EXPECT_GT(check->mass(), 20);
  // Its legs stand 0.71 + 0.07 m apart from front to back, and it is the same on both sides.
  ASSERT_EQ(check->poses_size(), 1);
  EXPECT_NEAR(check->poses(0).margin(), 0.39, 0.001);
  ASSERT_EQ(check->surfaces_size(), 1);
  EXPECT_EQ(check->surfaces(0).kind(), "top");
  EXPECT_THAT(check->surfaces(0).parts(), Contains("top board"));
  EXPECT_EQ(check->surfaces(0).load(), 1000);
  EXPECT_THAT(check->joints(), Not(IsEmpty()));
  for (const v1::CheckFinding& finding : check->findings()) {
    EXPECT_NE(finding.severity(), v1::CheckFinding::FAULT) << finding.ShortDebugString();
    EXPECT_FALSE(finding.source().empty()) << finding.ShortDebugString();
  }
  EXPECT_THAT(check->not_judged(), Contains(HasSubstr("glue")));
}

TEST_F(ComposerCheckTest, WhatIsNotConnectedIsNotJudged) {
  v1::Model model = house_->New("loose");
  model = house_->Add(model, "dining-table", "frame", "frame").value_or(model);
  model = house_->Add(model, "dining-table", "top", "top").value_or(model);
  const auto check = Check(model.name());
  ASSERT_TRUE(check.ok()) << check.status();
  EXPECT_THAT(check->surfaces(), IsEmpty());
  EXPECT_THAT(check->not_judged(), Contains(HasSubstr("'top'")));
}

// What is wider stands no worse, by the same margin from front to back.
TEST_F(ComposerCheckTest, IsOfTheModelAsItIsNow) {
  v1::Model model = house_->New("dragged");
  model = house_->Add(model, "dining-table", "", "table").value_or(model);
  const auto before = Check(model.name());
  ASSERT_TRUE(before.ok()) << before.status();
  const auto wider = house_->Drag(model, "long apron 1", "width", 1.6);
  ASSERT_TRUE(wider.ok()) << wider.status();
  const auto after = Check(model.name());
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_EQ(after->revision(), wider->revision());
  EXPECT_GT(after->mass(), before->mass());
}

// A bookshelf on a table that is called a drawer: no slides of the collection are for it, and it is
// not screwed down instead. That is said when it is connected, by the check, and after it is saved.
TEST_F(ComposerCheckTest, WhatIsToMoveAndIsHeldByNothingIsSaidEverywhere) {
  v1::Model model = house_->New("odd");
  model = house_->Add(model, "dining-table", "", "table").value_or(model);
  v1::AddComponentRequest add;
  add.set_template_("templates/bookshelf");
  add.set_component_id("my-drawer");
  add.mutable_position()->set_x(0.8);
  add.mutable_position()->set_y(0.45);
  add.mutable_position()->set_z(0.74);
  const auto added = house_->Change(&Stub::AddComponent, model, add);
  ASSERT_TRUE(added.ok()) << added.status();
  const auto connected = house_->Connect(*added, "my-drawer");
  ASSERT_TRUE(connected.ok()) << connected.status();
  for (const v1::ModelConnection& made : ComponentOf(*connected, "my-drawer").connections()) {
    EXPECT_THAT(made.parts(), IsEmpty());
  }
  ASSERT_EQ(connected->warnings_size(), 2);
  const v1::ModelWarning& moves = connected->warnings(0);
  EXPECT_THAT(moves.text(), HasSubstr("'my-drawer' is to move"));
  EXPECT_EQ(moves.other_element(), "top board");
  const v1::ModelWarning& unheld = connected->warnings(1);
  EXPECT_EQ(unheld.component(), "my-drawer");
  EXPECT_THAT(unheld.elements(), ::testing::IsSupersetOf({"side 1", "side 2", "shelf 1"}));
  const auto check = Check(model.name());
  ASSERT_TRUE(check.ok()) << check.status();
  const auto finding =
      std::find_if(check->findings().begin(), check->findings().end(),
                   [](const v1::CheckFinding& each) { return each.rule() == "only-touches"; });
  ASSERT_NE(finding, check->findings().end());
  EXPECT_THAT(finding->parts(), ::testing::IsSupersetOf(unheld.elements()));
  const auto saved = house_->Save(*connected, "odd-table");
  ASSERT_TRUE(saved.ok()) << saved.status();
  const auto after = house_->Get(model.name());
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_EQ(after->warnings_size(), 2);
}

// What its design screws is called a drawer: it is screwed here as there, and neither connecting
// nor the check takes it for one.
TEST_F(ComposerCheckTest, WhatItsDesignFastensIsNoDrawerByItsName) {
  v1::Model model = house_->New("named");
  model = house_->Add(model, "bookshelf", "", "shelves").value_or(model);
  const auto without = house_->Remove(model, "shelf 3");
  ASSERT_TRUE(without.ok()) << without.status();
  const auto added = house_->Add(*without, "bookshelf", "shelf 3", "drawer");
  ASSERT_TRUE(added.ok()) << added.status();
  const auto connected = house_->Connect(*added, "drawer");
  ASSERT_TRUE(connected.ok()) << connected.status();
  EXPECT_EQ(ComponentOf(*connected, "drawer").node(), "drawer");
  for (const v1::ModelWarning& warning : connected->warnings()) {
    EXPECT_THAT(warning.text(), Not(HasSubstr("move"))) << warning.ShortDebugString();
  }
  const auto check = Check(model.name());
  ASSERT_TRUE(check.ok()) << check.status();
  for (const v1::CheckFinding& finding : check->findings()) {
    EXPECT_NE(finding.rule(), "cannot-move") << finding.text();
  }
}

// A template that is saved with its loads can be evaluated with them.
TEST_F(ComposerCheckTest, IsSavedWithSupportsAndLoads) {
  v1::Model model = house_->New("loaded");
  model = house_->Add(model, "dining-table", "", "table").value_or(model);
  v1::SaveModelRequest save;
  save.set_request_id("save-loaded");
  save.set_name(model.name());
  save.set_revision(model.revision());
  save.set_template_id("loaded-table");
  save.set_with_loads(true);
  const auto saved = Call(house_->composer(), &Stub::SaveModel, save);
  ASSERT_TRUE(saved.ok()) << saved.status();
  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name(saved->template_());
  const auto design =
      Call(house_->catalog(), &v1::CatalogService::Stub::EvaluateTemplate, evaluate);
  ASSERT_TRUE(design.ok()) << design.status();
  int supports = 0;
  double load = 0;
  for (const v1::EvaluatedBoundaryCondition& condition : design->boundary_conditions()) {
    if (condition.kind() == v1::BoundaryCondition::FIXED) ++supports;
    if (condition.kind() == v1::BoundaryCondition::FORCE) load += condition.force().z();
  }
  EXPECT_EQ(supports, 4);
  EXPECT_NEAR(load, -1000, 1e-3);
}

TEST_F(ComposerCheckTest, IsDrawnOnRequest) {
  v1::Model model = house_->New("pictured");
  model = house_->Add(model, "dining-table", "frame", "frame").value_or(model);
  v1::CheckModelRequest request;
  request.set_name(model.name());
  EXPECT_THAT(Call(house_->composer(), &Stub::CheckModel, request)->png(), IsEmpty());
  request.set_width(160);
  const auto check = Call(house_->composer(), &Stub::CheckModel, request);
  ASSERT_TRUE(check.ok()) << check.status();
  EXPECT_EQ(check->png().substr(1, 3), "PNG");
  request.set_width(5);
  EXPECT_EQ(DetailOf(Call(house_->composer(), &Stub::CheckModel, request).status()).field, "width");
}

TEST_F(ComposerCheckTest, RefusesWhatItCannotJudge) {
  EXPECT_EQ(Check("models/none").status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(Check("").status().code(), absl::StatusCode::kInvalidArgument);
  const absl::Status empty = Check(house_->New("empty").name()).status();
  EXPECT_EQ(empty.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(empty).reason, "MODEL_EMPTY");
}

}  // namespace
}  // namespace mortise::testing
