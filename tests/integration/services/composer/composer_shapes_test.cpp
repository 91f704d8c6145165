// Shapes of a model's own: a bored board that became longer keeps its bores, is connected again,
// saved, planned and exported.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "common/base/files.h"
#include "tests/integration/services/composer/composer_house.h"

namespace mortise::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ComposerShapesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    house_ = std::make_unique<ComposerHouse>();
    const std::filesystem::path drawings = ShippedCollection() / "drawings";
    v1::ImportAssemblyStepRequest import;
    import.set_request_id("import-shelf");
    import.set_step(*ReadFile(drawings / "wall_shelf.step"));
    ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(
        *ReadFile(drawings / "wall_shelf.textproto"), import.mutable_annotations()));
    const auto imported =
        Call(house_->assemblies(), &v1::AssemblyService::Stub::ImportAssemblyStep, import);
    ASSERT_TRUE(imported.ok()) << imported.status();
    v1::ImportTemplateRequest request;
    request.set_request_id("template-shelf");
    request.mutable_template_()->set_name("templates/wall-shelf");
    request.mutable_template_()->mutable_assembly()->set_assembly(imported->assembly().name());
    const auto made = Call(house_->catalog(), &v1::CatalogService::Stub::ImportTemplate, request);
    ASSERT_TRUE(made.ok()) << made.status();
  }
  static void TearDownTestSuite() { house_.reset(); }

  // The shape that a part of an assembly has of its own.
  static v1::Shape ShapeOf(const std::string& assembly, const std::string& part) {
    v1::GetAssemblyRequest get;
    get.set_name(assembly);
    const auto found = Call(house_->assemblies(), &v1::AssemblyService::Stub::GetAssembly, get);
    EXPECT_TRUE(found.ok()) << found.status();
    v1::GetShapeRequest request;
    for (const v1::AssemblyPart& each : found->parts()) {
      if (each.name() == part) request.set_name(each.shape());
    }
    const auto shape = Call(house_->catalog(), &v1::CatalogService::Stub::GetShape, request);
    EXPECT_TRUE(shape.ok()) << part << ": " << shape.status();
    return shape.value_or(v1::Shape());
  }

  static std::string StepOf(const std::string& assembly) {
    v1::ExportAssemblyRequest request;
    request.set_name(assembly);
    request.set_format(v1::ExportDesignRequest::STEP);
    grpc::ClientContext context;
    Prepare(context);
    const auto reader = house_->assemblies().ExportAssembly(&context, request);
    const auto bytes = ReadChunks(*reader);
    EXPECT_TRUE(bytes.ok()) << bytes.status();
    return bytes.value_or("");
  }

  static std::unique_ptr<ComposerHouse> house_;
};

std::unique_ptr<ComposerHouse> ComposerShapesTest::house_;

TEST_F(ComposerShapesTest, ABoredBoardThatBecameLongerIsStoredWithItsBores) {
  v1::Model model = house_->New("longer");
  model = house_->Add(model, "wall-shelf", "", "shelf").value_or(model);
  const auto longer = house_->Drag(model, "board", "width", 1.1);
  ASSERT_TRUE(longer.ok()) << longer.status();
  // Redrawn, once it is without a bracket, read again from the store, and with it again.
  const auto without = house_->Remove(*longer, "right bracket");
  ASSERT_TRUE(without.ok()) << without.status();
  house_->KillAndStart();
  const auto added = house_->Add(*without, "wall-shelf", "right bracket", "bracket");
  ASSERT_TRUE(added.ok()) << added.status();
  v1::MoveComponentRequest move;
  move.set_component("bracket");
  const v1::ModelComponent drawn = ComponentOf(*added, "bracket");
  // Where it was dropped is somewhat beside where it goes.
  move.mutable_position()->set_x((drawn.minimum().x() + drawn.maximum().x()) / 2 + 0.01);
  move.mutable_position()->set_y((drawn.minimum().y() + drawn.maximum().y()) / 2);
  move.mutable_position()->set_z(drawn.minimum().z() - 0.008);
  const auto dropped = house_->Change(&v1::ComposerService::Stub::MoveComponent, *added, move);
  ASSERT_TRUE(dropped.ok()) << dropped.status();
  const auto snapped = house_->Snap(*dropped, "bracket");
  ASSERT_TRUE(snapped.ok()) << snapped.status();
  const auto connected = house_->Connect(*snapped, "bracket");
  ASSERT_TRUE(connected.ok()) << connected.status();
  EXPECT_THAT(connected->warnings(), IsEmpty());

  const auto saved = house_->Save(*connected, "longer-shelf");
  ASSERT_TRUE(saved.ok()) << saved.status();
  const v1::Shape before = ShapeOf("assemblies/wall-shelf", "board");
  const v1::Shape after = ShapeOf(saved->assembly(), "board");
  EXPECT_NEAR(after.size().x(), 1.1, 1e-9);
  // The bore in its middle, 60 mm wide, is as it was; its two round corners became longer with what
  // lies beside the bore.
  const auto box_of = [](const v1::Shape& shape) {
    return shape.size().x() * shape.size().y() * shape.size().z();
  };
  const double bore = std::acos(-1.0) * 0.03 * 0.03 * 0.018;
  const double corners = box_of(before) - before.volume() - bore;
  const double longer_by = (1.1 - 0.06) / (before.size().x() - 0.06);
  EXPECT_NEAR(after.volume(), box_of(after) - bore - longer_by * corners, 1e-9);
  EXPECT_TRUE(after.exact());
  // The same again is there already.
  const auto again = house_->Save(*house_->Get(connected->name()), "longer-shelf");
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->template_revision(), 1);

  EXPECT_THAT(StepOf(saved->assembly()), HasSubstr("ISO-10303-21"));
  const auto plan = PlanOf(*house_, saved->template_());
  ASSERT_TRUE(plan.ok()) << plan.status();
  int outlines = 0;
  for (const v1::PlannedPart& part : plan->parts()) {
    outlines += part.making() == v1::PlannedPart::OUTLINE ? 1 : 0;
  }
  EXPECT_EQ(outlines, 1);
}

}  // namespace
}  // namespace mortise::testing
