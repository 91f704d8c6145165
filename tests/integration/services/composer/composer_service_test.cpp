// A table is taken apart and composed again, and comes out as a template that can be built:
// mortise-composer as a real process, beside a catalog.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>

#include "common/base/errors.h"
#include "tests/integration/services/composer/composer_house.h"

namespace mortise::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;
using Stub = v1::ComposerService::Stub;

class ComposerServiceTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<ComposerHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  // A model of the table's frame, with its top dropped a little off its place.
  static v1::Model Dropped(const std::string& id) {
    const v1::Model empty = house_->New(id);
    const auto frame = house_->Add(empty, "dining-table", "frame", "frame");
    EXPECT_TRUE(frame.ok()) << frame.status();
    v1::AddComponentRequest top;
    top.set_template_("templates/dining-table");
    top.set_group("top");
    top.set_component_id("top");
    top.mutable_position()->set_x(0.8 + 0.02);
    top.mutable_position()->set_y(0.45 - 0.015);
    top.mutable_position()->set_z(0.712 + 0.025);
    const auto dropped = house_->Change(&Stub::AddComponent, frame.value_or(empty), top);
    EXPECT_TRUE(dropped.ok()) << dropped.status();
    return dropped.value_or(empty);
  }

  // The same, snapped and connected.
  static v1::Model Composed(const std::string& id) {
    v1::Model model = Dropped(id);
    for (const auto step : {&ComposerHouse::Snap, &ComposerHouse::Connect}) {
      const auto changed = (house_.get()->*step)(model, "top");
      EXPECT_TRUE(changed.ok()) << changed.status();
      model = changed.value_or(model);
    }
    return model;
  }

  static std::multiset<std::string> ItemsOf(const v1::Model& model) {
    std::multiset<std::string> items;
    for (const v1::ModelPart& part : model.parts()) items.insert(part.item());
    return items;
  }

  static std::unique_ptr<ComposerHouse> house_;
};

std::unique_ptr<ComposerHouse> ComposerServiceTest::house_;

TEST_F(ComposerServiceTest, AComponentStaysLooseUntilItIsConnected) {
  const v1::Model model = Dropped("loose");
  ASSERT_EQ(model.components_size(), 2);
  EXPECT_EQ(ComponentOf(model, "frame").state(), v1::ModelComponent::CONNECTED);
  const v1::ModelComponent top = ComponentOf(model, "top");
  EXPECT_EQ(top.state(), v1::ModelComponent::PLACED);
  EXPECT_EQ(top.template_(), "templates/dining-table");
  EXPECT_EQ(top.template_revision(), 1);
  EXPECT_EQ(top.group(), "top");
  EXPECT_NEAR(top.minimum().x() + top.maximum().x(), 2 * 0.82, 1e-9);
  EXPECT_NEAR(top.minimum().z(), 0.737, 1e-9);
  // The frame comes without what held the top.
  for (const v1::ModelPart& part : model.parts()) {
    EXPECT_THAT(part.name(), Not(::testing::HasSubstr("bracket")));
  }
}

TEST_F(ComposerServiceTest, SnappingPutsTheTopWhereItWas) {
  const v1::Model dropped = Dropped("snapped");
  v1::SnapComponentRequest request;
  request.set_component("top");
  request.set_preview(true);
  const auto preview = house_->Change(&Stub::SnapComponent, dropped, request);
  ASSERT_TRUE(preview.ok()) << preview.status();
  EXPECT_EQ(preview->revision(), dropped.revision());
  EXPECT_EQ(house_->Get(dropped.name())->digest(), dropped.digest());
  const auto snapped = house_->Snap(dropped, "top");
  ASSERT_TRUE(snapped.ok()) << snapped.status();
  const v1::ModelComponent top = ComponentOf(*snapped, "top");
  EXPECT_EQ(top.state(), v1::ModelComponent::SNAPPED);
  EXPECT_THAT(top.alignments(), Not(IsEmpty()));
  EXPECT_NEAR(top.minimum().z(), 0.712, 1e-6);
  const v1::ModelComponent foreseen = ComponentOf(*preview, "top");
  EXPECT_EQ(foreseen.minimum().SerializeAsString(), top.minimum().SerializeAsString());
  EXPECT_EQ(foreseen.maximum().SerializeAsString(), top.maximum().SerializeAsString());
}

TEST_F(ComposerServiceTest, ConnectingBringsWhatHeldTheTop) {
  const v1::Model model = Composed("connected");
  EXPECT_THAT(model.warnings(), IsEmpty());
  const v1::ModelComponent top = ComponentOf(model, "top");
  EXPECT_EQ(top.state(), v1::ModelComponent::CONNECTED);
  EXPECT_THAT(top.connections(), Not(IsEmpty()));
  for (const v1::ModelConnection& connection : top.connections()) {
    EXPECT_EQ(connection.source(), "assemblies/dining-table");
  }
  // All that the table is made of, and nothing else.
  v1::Model whole = house_->New("whole");
  whole = house_->Add(whole, "dining-table", "", "table").value_or(whole);
  EXPECT_EQ(ItemsOf(model), ItemsOf(whole));
}

TEST_F(ComposerServiceTest, WhatIsComposedIsOneDesign) {
  const v1::Model model = Composed("dragged");
  const auto wider = house_->Drag(model, "long apron 1", "width", 1.5);
  ASSERT_TRUE(wider.ok()) << wider.status();
  const v1::ModelComponent frame = ComponentOf(*wider, "frame");
  // Two legs of 70 mm at the ends of the apron.
  EXPECT_NEAR(frame.maximum().x() - frame.minimum().x(), 1.64, 1e-6);
  // The top is large enough for it, and lies on it.
  const v1::ModelComponent top = ComponentOf(*wider, "top");
  EXPECT_LE(top.minimum().x(), frame.minimum().x() + 1e-6);
  EXPECT_GE(top.maximum().x(), frame.maximum().x() - 1e-6);
  EXPECT_NEAR(top.minimum().z(), frame.maximum().z(), 1e-6);
  v1::GetNodeControlsRequest request;
  request.set_name(wider->name());
  request.set_node("long apron 1");
  const auto controls = Call(house_->composer(), &Stub::GetNodeControls, request);
  ASSERT_TRUE(controls.ok()) << controls.status();
  EXPECT_EQ(controls->revision(), wider->revision());
  bool found = false;
  for (const v1::NodeControl& control : controls->controls()) {
    EXPECT_LT(control.minimum(), control.maximum()) << control.name();
    if (control.name() != "width") continue;
    found = true;
    EXPECT_NEAR(control.value(), 1.5, 1e-6);
  }
  EXPECT_TRUE(found);
}

TEST_F(ComposerServiceTest, WhatIsRemovedTakesItsConnectionsAlong) {
  const v1::Model model = Composed("removed");
  v1::RemoveNodeRequest request;
  request.set_node(ComponentOf(model, "top").node());
  const auto rest = house_->Change(&Stub::RemoveNode, model, request);
  ASSERT_TRUE(rest.ok()) << rest.status();
  EXPECT_EQ(rest->components_size(), 1);
  v1::Model frame = house_->New("frame");
  frame = house_->Add(frame, "dining-table", "frame", "frame").value_or(frame);
  EXPECT_EQ(ItemsOf(*rest), ItemsOf(frame));
}

TEST_F(ComposerServiceTest, WhatIsSavedIsATemplateLikeAnyOther) {
  const v1::Model model = Composed("saved");
  const auto saved = house_->Save(model, "composed-table");
  ASSERT_TRUE(saved.ok()) << saved.status();
  EXPECT_EQ(saved->template_(), "templates/composed-table");
  EXPECT_EQ(saved->template_revision(), 1);
  EXPECT_EQ(house_->Get(model.name())->saved().digest(), model.digest());
  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name(saved->template_());
  const auto design =
      Call(house_->catalog(), &v1::CatalogService::Stub::EvaluateTemplate, evaluate);
  ASSERT_TRUE(design.ok()) << design.status();
  EXPECT_EQ(design->parts_size(), model.parts_size());
  // It is composed of like any other.
  v1::Model next = house_->New("next");
  EXPECT_TRUE(house_->Add(next, "composed-table", "", "table").ok());
  // The same again is the revision that is there.
  const auto again = house_->Save(*house_->Get(model.name()), "composed-table");
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->template_revision(), 1);
  const auto wider = house_->Drag(model, "long apron 1", "width", 1.5);
  ASSERT_TRUE(wider.ok()) << wider.status();
  const auto next_revision = house_->Save(*wider, "composed-table");
  ASSERT_TRUE(next_revision.ok()) << next_revision.status();
  EXPECT_EQ(next_revision->template_revision(), 2);
}

TEST_F(ComposerServiceTest, WhatIsSavedCanBeMade) {
  const auto saved = house_->Save(Composed("planned"), "planned-table");
  ASSERT_TRUE(saved.ok()) << saved.status();
  const auto plan = PlanOf(*house_, saved->template_());
  ASSERT_TRUE(plan.ok()) << plan.status();
  EXPECT_GT(plan->parts_size(), 0);
}

TEST_F(ComposerServiceTest, IsDrawnWithAColourForEachComponent) {
  const v1::Model model = Dropped("drawn");
  v1::DrawModelRequest request;
  request.set_name(model.name());
  request.set_width(320);
  const auto picture = Call(house_->composer(), &Stub::DrawModel, request);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->revision(), model.revision());
  EXPECT_EQ(picture->png().substr(1, 3), "PNG");
}

}  // namespace
}  // namespace mortise::testing
