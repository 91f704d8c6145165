// Components turned by right angles: where they stand, in what is composed of them, and in what it
// takes to build it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <memory>
#include <set>
#include <string>

#include "common/base/errors.h"
#include "tests/integration/services/composer/composer_house.h"

namespace mortise::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Stub = v1::ComposerService::Stub;

Eigen::Vector3d SizeOf(const v1::ModelComponent& component) {
  return {component.maximum().x() - component.minimum().x(),
          component.maximum().y() - component.minimum().y(),
          component.maximum().z() - component.minimum().z()};
}

class ComposerTurnsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<ComposerHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  // A model of the table's frame with its top, not connected, and a little wider than drawn.
  static v1::Model Table(const std::string& id) {
    v1::Model model = house_->New(id);
    model = house_->Add(model, "dining-table", "frame", "frame").value_or(model);
    model = house_->Add(model, "dining-table", "top", "top").value_or(model);
    v1::DragControlRequest drag;
    drag.set_component("top");
    drag.set_control("width");
    drag.set_value(1.7);
    const auto wider = house_->Change(&Stub::DragControl, model, drag);
    EXPECT_TRUE(wider.ok()) << wider.status();
    return wider.value_or(model);
  }

  // A bookshelf with its third shelf added by itself, turned or as drawn.
  static v1::Model Bookshelf(const std::string& id, bool turned) {
    const v1::Model empty = house_->New(id);
    v1::AddComponentRequest request;
    request.set_template_("templates/bookshelf");
    request.set_component_id("bookshelf");
    if (turned) request.add_turns(v1::Z);
    auto model = house_->Change(&Stub::AddComponent, empty, request);
    if (model.ok()) model = house_->Remove(*model, "shelf 3");
    EXPECT_TRUE(model.ok()) << model.status();
    request.set_group("shelf 3");
    request.set_component_id("shelf");
    const v1::ModelComponent there = ComponentOf(*model, "bookshelf");
    request.mutable_position()->set_x((there.minimum().x() + there.maximum().x()) / 2 + 0.008);
    request.mutable_position()->set_y((there.minimum().y() + there.maximum().y()) / 2 - 0.011);
    request.mutable_position()->set_z(0.7);
    model = house_->Change(&Stub::AddComponent, *model, request);
    for (const auto step : {&ComposerHouse::Snap, &ComposerHouse::Connect}) {
      EXPECT_TRUE(model.ok()) << model.status();
      model = (house_.get()->*step)(*model, "shelf");
    }
    EXPECT_TRUE(model.ok()) << model.status();
    return model.value_or(empty);
  }

  static std::unique_ptr<ComposerHouse> house_;
};

std::unique_ptr<ComposerHouse> ComposerTurnsTest::house_;

TEST_F(ComposerTurnsTest, FourQuartersGiveTheIdenticalState) {
  for (const v1::Axis axis : {v1::Z, v1::X, v1::Y}) {
    SCOPED_TRACE(v1::Axis_Name(axis));
    v1::Model model = Table(std::string("round-") + (axis == v1::X   ? "x"
                                                     : axis == v1::Y ? "y"
                                                                     : "z"));
    const v1::ModelComponent before = ComponentOf(model, "top");
    std::set<std::string> digests = {model.digest()};
    for (int quarter = 1; quarter <= 4; ++quarter) {
      const auto turned = house_->Turn(model, "top", axis);
      ASSERT_TRUE(turned.ok()) << turned.status();
      const v1::ModelComponent top = ComponentOf(*turned, "top");
      EXPECT_EQ(top.turns_size(), quarter % 4);
      // Its foot stays.
      EXPECT_NEAR(top.minimum().x() + top.maximum().x(),
                  before.minimum().x() + before.maximum().x(), 1e-9);
      EXPECT_NEAR(top.minimum().y() + top.maximum().y(),
                  before.minimum().y() + before.maximum().y(), 1e-9);
      EXPECT_NEAR(top.minimum().z(), before.minimum().z(), 1e-9);
      EXPECT_EQ(digests.insert(turned->digest()).second, quarter < 4);
      if (quarter == 2) house_->KillAndStart();
      model = *turned;
    }
    EXPECT_TRUE(digests.contains(model.digest()));
    EXPECT_THAT(ComponentOf(model, "top").turns(), IsEmpty());
  }
}

TEST_F(ComposerTurnsTest, ATurnedTopLiesAsItIsTurned) {
  const v1::Model model = Table("lying");
  const Eigen::Vector3d size = SizeOf(ComponentOf(model, "top"));
  const auto once = house_->Turn(model, "top", v1::Z);
  ASSERT_TRUE(once.ok()) << once.status();
  const Eigen::Vector3d turned = SizeOf(ComponentOf(*once, "top"));
  EXPECT_LT((turned - Eigen::Vector3d(size.y(), size.x(), size.z())).norm(), 1e-9);
  const auto upright = house_->Turn(*once, "top", v1::X);
  ASSERT_TRUE(upright.ok()) << upright.status();
  EXPECT_THAT(ComponentOf(*upright, "top").turns(), ElementsAre(v1::Z, v1::X));
  EXPECT_LT(
      (SizeOf(ComponentOf(*upright, "top")) - Eigen::Vector3d(size.y(), size.z(), size.x())).norm(),
      1e-9);
  // Turned in one step it is the same.
  v1::TurnComponentRequest request;
  request.set_component("top");
  request.add_turns(v1::Z);
  request.add_turns(v1::X);
  const auto at_once =
      house_->Change(&Stub::TurnComponent, *house_->Undo(*house_->Undo(*upright)), request);
  ASSERT_TRUE(at_once.ok()) << at_once.status();
  EXPECT_EQ(at_once->digest(), upright->digest());
  // A fork has all that it takes to turn it back.
  v1::ForkModelRequest fork;
  fork.set_request_id("fork-lying");
  fork.set_name(upright->name());
  fork.set_model_id("lying-fork");
  const auto forked = Call(house_->composer(), &Stub::ForkModel, fork);
  ASSERT_TRUE(forked.ok()) << forked.status();
  house_->KillAndStart();
  auto back = house_->Turn(*forked, "top", v1::X, 3);
  ASSERT_TRUE(back.ok()) << back.status();
  back = house_->Turn(*back, "top", v1::Z, 3);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->digest(), model.digest());
}

// In a bookshelf that stands along y, a shelf that is turned as it is snaps between its sides, is
// screwed as the others are, and takes the same to build.
TEST_F(ComposerTurnsTest, AShelfOfATurnedBookshelfIsBuiltAsOneThatIsNot) {
  const v1::Model straight = Bookshelf("straight", false), turned = Bookshelf("turned", true);
  EXPECT_THAT(turned.warnings(), IsEmpty());
  const Eigen::Vector3d one = SizeOf(ComponentOf(straight, "shelf"));
  const Eigen::Vector3d other = SizeOf(ComponentOf(turned, "shelf"));
  EXPECT_LT((other - Eigen::Vector3d(one.y(), one.x(), one.z())).norm(), 1e-6);
  EXPECT_EQ(ComponentOf(turned, "shelf").connections_size(),
            ComponentOf(straight, "shelf").connections_size());
  EXPECT_EQ(turned.parts_size(), straight.parts_size());

  std::string bill;
  for (const v1::Model& model : {straight, turned}) {
    const auto saved = house_->Save(model, model.name().substr(7) + "-bookshelf");
    ASSERT_TRUE(saved.ok()) << saved.status();
    const auto plan = PlanOf(*house_, saved->template_());
    ASSERT_TRUE(plan.ok()) << plan.status();
    std::string lines;
    for (const v1::BillLine& line : plan->bill()) {
      lines +=
          line.item() + ": " + std::to_string(line.quantity()) + " of " + line.dimensions() + "\n";
    }
    if (bill.empty()) bill = lines;
    EXPECT_EQ(lines, bill);
  }
}

// The brackets below a table top are drawn by themselves; turned they have shapes of their own, and
// the whole is stored with them.
TEST_F(ComposerTurnsTest, ATurnedTableWithShapesOfItsOwnIsStored) {
  const v1::Model empty = house_->New("sideways");
  v1::AddComponentRequest request;
  request.set_template_("templates/dining-table");
  request.set_component_id("table");
  request.add_turns(v1::Z);
  const auto model = house_->Change(&Stub::AddComponent, empty, request);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_THAT(ComponentOf(*model, "table").turns(), ElementsAre(v1::Z));
  const auto saved = house_->Save(*model, "sideways-table");
  ASSERT_TRUE(saved.ok()) << saved.status();
  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name(saved->template_());
  const auto design =
      Call(house_->catalog(), &v1::CatalogService::Stub::EvaluateTemplate, evaluate);
  ASSERT_TRUE(design.ok()) << design.status();
  EXPECT_EQ(design->parts_size(), model->parts_size());
}

TEST_F(ComposerTurnsTest, WhatCannotBeTurnedIsRefused) {
  const v1::Model model = Table("refused");
  EXPECT_EQ(DetailOf(house_->Turn(model, "top", v1::Z, 0).status()).field, "turns");
  EXPECT_EQ(DetailOf(house_->Turn(model, "top", v1::Z, 13).status()).field, "turns");
  EXPECT_EQ(DetailOf(house_->Turn(model, "top", v1::AXIS_UNSPECIFIED).status()).field, "turns[0]");
  EXPECT_EQ(DetailOf(house_->Turn(model, "nothing", v1::Z).status()).field, "component");
  EXPECT_EQ(DetailOf(house_->Turn(model, "frame", v1::Z).status()).reason, "COMPONENT_CONNECTED");
  EXPECT_EQ(house_->Get(model.name())->digest(), model.digest());
}

}  // namespace
}  // namespace mortise::testing
