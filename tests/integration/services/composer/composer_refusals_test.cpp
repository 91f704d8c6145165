// What the composer refuses, for a reason that a person can act on, and leaves the model as it is:
// mortise-composer as a real process, beside a catalog.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "common/base/errors.h"
#include "tests/integration/services/composer/composer_house.h"

namespace mortise::testing {
namespace {

using Stub = v1::ComposerService::Stub;

// A model of a table's frame, and its top, which is not connected.
class ComposerRefusalsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    house_ = std::make_unique<ComposerHouse>();
    v1::Model model = house_->New("table");
    model = house_->Add(model, "dining-table", "frame", "frame").value_or(model);
    v1::AddComponentRequest top;
    top.set_template_("templates/dining-table");
    top.set_group("top");
    top.mutable_position()->set_z(5);
    model = house_->Change(&Stub::AddComponent, model, top).value_or(model);
    EXPECT_EQ(model.components_size(), 2);
    model_ = model;
  }
  static void TearDownTestSuite() { house_.reset(); }

  // After each test: nothing has changed.
  void TearDown() override {
    const auto present = house_->Get(model_.name());
    ASSERT_TRUE(present.ok()) << present.status();
    EXPECT_EQ(present->SerializeAsString(), model_.SerializeAsString());
  }

  static absl::Status Add(const v1::AddComponentRequest& request) {
    return house_->Change(&Stub::AddComponent, model_, request).status();
  }

  static v1::AddComponentRequest Shelf() {
    v1::AddComponentRequest request;
    request.set_template_("templates/bookshelf");
    request.set_group("shelf 3");
    return request;
  }

  static void ExpectField(const absl::Status& status, const std::string& field) {
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    EXPECT_EQ(DetailOf(status).field, field) << status;
  }

  static void ExpectReason(const absl::Status& status, const std::string& reason) {
    EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition) << status;
    EXPECT_EQ(DetailOf(status).reason, reason) << status;
  }

  static std::unique_ptr<ComposerHouse> house_;
  static v1::Model model_;
};

std::unique_ptr<ComposerHouse> ComposerRefusalsTest::house_;
v1::Model ComposerRefusalsTest::model_;

TEST_F(ComposerRefusalsTest, OriginsThatThereAreNot) {
  v1::AddComponentRequest request = Shelf();
  request.set_template_("templates/none");
  EXPECT_EQ(Add(request).code(), absl::StatusCode::kNotFound);
  request = Shelf();
  request.set_template_("none");
  ExpectField(Add(request), "template");
  request = Shelf();
  request.set_template_revision(9);
  EXPECT_EQ(Add(request).code(), absl::StatusCode::kNotFound);
  request = Shelf();
  request.set_group("drawer");
  ExpectField(Add(request), "group");
}

TEST_F(ComposerRefusalsTest, SizesThatTheOriginCannotHave) {
  v1::AddComponentRequest request = Shelf();
  v1::MeasureDemand* const demand = request.add_demands();
  demand->mutable_measure()->set_element("shelf 3");
  demand->mutable_measure()->set_axis(v1::X);
  demand->set_value(40);
  ExpectReason(Add(request), "DEMANDS_CONFLICT");
  demand->set_value(1);
  demand->mutable_measure()->set_element("lid");
  ExpectField(Add(request), "demands[0].measure.element");
}

TEST_F(ComposerRefusalsTest, PlacesAndIdsThatCannotBe) {
  v1::AddComponentRequest request = Shelf();
  request.mutable_position()->set_x(1e5);
  ExpectField(Add(request), "position");
  request = Shelf();
  request.set_component_id("Shelf!");
  ExpectField(Add(request), "component_id");
  request.set_component_id("top");
  ExpectField(Add(request), "component_id");
  v1::MoveComponentRequest move;
  move.set_component("top");
  ExpectField(house_->Change(&Stub::MoveComponent, model_, move).status(), "position");
}

TEST_F(ComposerRefusalsTest, AnotherRevisionThanThePresentOne) {
  v1::Model stale = model_;
  stale.set_revision(1);
  for (const absl::Status& status :
       {house_->Snap(stale, "top").status(), house_->Connect(stale, "top").status(),
        house_->Undo(stale).status(), house_->Save(stale, "stale").status()}) {
    EXPECT_EQ(status.code(), absl::StatusCode::kAborted) << status;
    EXPECT_EQ(DetailOf(status).reason, "STALE_REVISION");
  }
}

TEST_F(ComposerRefusalsTest, ComponentsThatThereAreNotOrAreConnected) {
  ExpectField(house_->Snap(model_, "lid").status(), "component");
  ExpectField(house_->Connect(model_, "lid").status(), "component");
  ExpectReason(house_->Snap(model_, "frame").status(), "COMPONENT_CONNECTED");
  ExpectReason(house_->Connect(model_, "frame").status(), "COMPONENT_CONNECTED");
}

TEST_F(ComposerRefusalsTest, WhatIsFarFromAllElse) {
  ExpectReason(house_->Snap(model_, "top").status(), "SNAP_FAR");
  ExpectReason(house_->Connect(model_, "top").status(), "NOTHING_NEAR");
}

TEST_F(ComposerRefusalsTest, ControlsAndNodesThatThereAreNot) {
  ExpectField(house_->Drag(model_, "", "length", 1).status(), "control");
  ExpectField(house_->Drag(model_, "lid", "width", 1).status(), "node");
  v1::RemoveNodeRequest remove;
  ExpectField(house_->Change(&Stub::RemoveNode, model_, remove).status(), "node");
  remove.set_node("lid");
  ExpectField(house_->Change(&Stub::RemoveNode, model_, remove).status(), "node");
  remove.set_node("frame");
  remove.set_component("top");
  ExpectField(house_->Change(&Stub::RemoveNode, model_, remove).status(), "node");
}

TEST_F(ComposerRefusalsTest, ModelsThatAreNotComplete) {
  ExpectReason(house_->Save(model_, "unfinished").status(), "COMPONENT_NOT_CONNECTED");
  const v1::Model empty = house_->New("empty");
  ExpectReason(house_->Save(empty, "empty").status(), "MODEL_EMPTY");
  v1::DrawModelRequest draw;
  draw.set_name(empty.name());
  ExpectReason(Call(house_->composer(), &Stub::DrawModel, draw).status(), "MODEL_EMPTY");
  ExpectReason(house_->Undo(empty).status(), "NOTHING_TO_UNDO");
}

TEST_F(ComposerRefusalsTest, TemplatesThatAreNotTheModels) {
  v1::Model other = house_->New("other");
  other = house_->Add(other, "dining-table", "", "table").value_or(other);
  EXPECT_EQ(house_->Save(other, "bookshelf").status().code(), absl::StatusCode::kAlreadyExists);
}

}  // namespace
}  // namespace mortise::testing
