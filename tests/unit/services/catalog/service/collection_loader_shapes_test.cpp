// The shapes of a collection: brought with the items that name them, and no others.
#include "tests/unit/services/catalog/service/collection_loader_fixture.h"

namespace mortise::catalog {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

TEST_F(CollectionLoaderTest, BringsTheShapesOfItems) {
  Ship(500, 1);
  const std::string shape = ShipShapedKnob(0.03);
  EXPECT_THAT(Load().created,
              UnorderedElementsAre("materials/wood", "items/knob", "items/pyramid"));
  EXPECT_EQ(ItemOf("items/pyramid").shape(), shape);
  EXPECT_THAT(Shapes(), ElementsAre(shape));
  // Neither again, nor lost as unused.
  now_ += 2 * kUnusedShapeLife;
  EXPECT_THAT(Load().updated, IsEmpty());
  ASSERT_OK_AND_ASSIGN(const auto swept, SweepShapes(*store_));
  EXPECT_THAT(swept, IsEmpty());
  EXPECT_THAT(Shapes(), ElementsAre(shape));
}

TEST_F(CollectionLoaderTest, AShapeThatChangedIsANewRevisionOfItsItem) {
  Ship(500, 1);
  const std::string first = ShipShapedKnob(0.03);
  Load();
  const std::string second = ShipShapedKnob(0.04);
  EXPECT_THAT(Load().updated, ElementsAre("items/pyramid"));
  EXPECT_EQ(ItemOf("items/pyramid").shape(), second);
  EXPECT_EQ(ItemOf("items/pyramid").revision(), 2);
  EXPECT_THAT(Shapes(), UnorderedElementsAre(first, second)) << "revision 1 has the first";
}

TEST_F(CollectionLoaderTest, AShapeOfWhatUsersChangedIsNotBrought) {
  Ship(500, 1);
  const std::string first = ShipShapedKnob(0.03);
  Load();
  Reprice("items/pyramid", 2);
  ShipShapedKnob(0.04);
  EXPECT_THAT(Load().kept, ElementsAre("items/pyramid"));
  EXPECT_THAT(Shapes(), ElementsAre(first));
}

TEST_F(CollectionLoaderTest, AShapeOfAnotherSizeIsAFaultOfItsItem) {
  Ship(500, 1);
  ShipShapedKnob(0.03);
  const auto whole = ReadFile(collection_ / "shapes" / "knob.shape");
  ASSERT_OK(whole);
  ShipShapedKnob(0.04);
  ASSERT_OK(WriteFile(collection_ / "shapes" / "knob.shape", *whole));
  const absl::Status status = LoadCollection(*store_, collection_, parametrized_).status();
  EXPECT_THAT(std::string(status.message()), HasSubstr("items/pyramid"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("measures 30 mm along Z"));
  EXPECT_THAT(Shapes(), IsEmpty());
}

TEST_F(CollectionLoaderTest, ADamagedShapeLeavesAFilledStoreAsItIs) {
  Ship(500, 1);
  ShipShapedKnob(0.03);
  Load();
  ASSERT_OK(WriteFile(collection_ / "shapes" / "knob.shape", "no shape"));
  Ship(500, 2);
  const CollectionReport report = LoadWithFaults();
  ASSERT_EQ(report.failed.size(), 1U);
  EXPECT_THAT(report.failed[0], HasSubstr("items/pyramid.shape"));
  EXPECT_THAT(report.failed[0], HasSubstr("knob.shape"));
  EXPECT_EQ(ItemOf("items/knob").price().amount(), 1);
}

}  // namespace
}  // namespace mortise::catalog
