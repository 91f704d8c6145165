// A collection in a store: all of it when that is empty; later what is new, and never instead of
// what users changed.
#include "tests/unit/services/catalog/service/collection_loader_fixture.h"

namespace mortise::catalog {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

TEST_F(CollectionLoaderTest, FillsAnEmptyStoreOnce) {
  Ship(500, 1);
  EXPECT_THAT(Load().created, UnorderedElementsAre("materials/wood", "items/knob"));
  const CollectionReport again = Load();
  EXPECT_THAT(again.created, IsEmpty());
  EXPECT_THAT(again.updated, IsEmpty());
}

TEST_F(CollectionLoaderTest, BringsWhatIsNewAndWhatChanged) {
  Ship(500, 1);
  Load();
  Ship(500, 2, 3);
  const CollectionReport report = Load();
  EXPECT_THAT(report.created, ElementsAre("items/hook"));
  EXPECT_THAT(report.updated, ElementsAre("items/knob"));
  EXPECT_EQ(ItemOf("items/knob").price().amount(), 2);
  EXPECT_EQ(ItemOf("items/knob").revision(), 2);
  // And once more: what it brought itself is no user's change.
  Ship(500, 4, 3);
  EXPECT_THAT(Load().updated, ElementsAre("items/knob"));
}

TEST_F(CollectionLoaderTest, KeepsWhatUsersChangedMadeOrRemoved) {
  Ship(500, 1, 1);
  Load();
  Reprice("items/knob", 7);
  Remove("items/hook");
  EXPECT_THAT(Load().kept, IsEmpty());  // the collection has nothing new
  Ship(500, 2, 2);
  const CollectionReport report = Load();
  EXPECT_THAT(report.kept, ElementsAre("items/knob"));
  EXPECT_THAT(report.created, IsEmpty());
  EXPECT_THAT(report.updated, IsEmpty());
  EXPECT_EQ(ItemOf("items/knob").price().amount(), 7);
  EXPECT_THAT(Load().kept, IsEmpty());  // told once
}

TEST_F(CollectionLoaderTest, LeavesTheTagsOfUsersAndGoesOnToBringWhatChanged) {
  Ship(500, 1);
  ShipDisc("Disc");
  Load();
  EXPECT_EQ(ItemOf("items/knob").creator(), "services/catalog");
  TagItem("items/knob");
  TagTemplate("templates/disc");
  EXPECT_THAT(Load().kept, IsEmpty());  // the collection has nothing new
  EXPECT_EQ(ItemOf("items/knob").revision(), 2);

  Ship(500, 2);
  ShipDisc("Better disc");
  const CollectionReport report = Load();
  EXPECT_THAT(report.updated, UnorderedElementsAre("items/knob", "templates/disc"));
  EXPECT_THAT(report.kept, IsEmpty());
  const v1::Item knob = ItemOf("items/knob");
  EXPECT_EQ(knob.price().amount(), 2);
  EXPECT_THAT(knob.external_ids(), ElementsAre("100-4711/A"));
  EXPECT_EQ(knob.labels().at("site"), "Hamburg");
  EXPECT_EQ(TitleOf("templates/disc").value_or(""), "Better disc");
  EXPECT_THAT(TemplateOf("templates/disc").external_ids(), ElementsAre("100-4711/A"));
  EXPECT_EQ(TemplateOf("templates/disc").creator(), "services/catalog");

  // Whoever changes more than that has his own.
  TagItem("items/knob");
  Reprice("items/knob", 7);
  Ship(500, 3);
  EXPECT_THAT(Load().kept, ElementsAre("items/knob"));
}

TEST_F(CollectionLoaderTest, DoesNotBringBackTemplatesThatUsersRemoved) {
  Ship(500, 2);
  ShipDisc("Disc");
  Load();
  v1::DeleteTemplateRequest request;
  request.set_name("templates/disc");
  request.set_revision(1);
  ASSERT_TRUE(Transact([&](store::Transaction& transaction) {
                return DeleteTemplate(transaction, request, kSomebody);
              }).ok());
  ShipDisc("Better disc");
  const CollectionReport report = Load();
  EXPECT_THAT(report.created, IsEmpty());
  EXPECT_THAT(report.updated, IsEmpty());
  EXPECT_TRUE(absl::IsNotFound(TitleOf("templates/disc").status()));
  // Somebody's own of that name is left alone, too.
  ASSERT_TRUE(Transact([&](store::Transaction& transaction) -> absl::Status {
                MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle,
                                         GetBundle(transaction, "templates/disc", 1));
                bundle.mutable_template_()->set_title("My disc");
                return ImportBundle(transaction, bundle, 0, kSomebody).status();
              }).ok());
  ShipDisc("Best disc");
  EXPECT_THAT(Load().kept, ElementsAre("templates/disc"));
  EXPECT_EQ(TitleOf("templates/disc").value_or(""), "My disc");
}

TEST_F(CollectionLoaderTest, BringsATemplateOfANameThatAUserTookAndGaveUp) {
  Ship(500, 2);
  ShipDisc("Disc");
  Load();
  v1::TemplateBundle bundle;
  ASSERT_TRUE(Transact([&](store::Transaction& transaction) -> absl::Status {
                MORTISE_ASSIGN_OR_RETURN(bundle, GetBundle(transaction, "templates/disc", 1));
                bundle.mutable_template_()->set_name("templates/puck");
                MORTISE_RETURN_IF_ERROR(ImportBundle(transaction, bundle, 0, kSomebody).status());
                v1::DeleteTemplateRequest request;
                request.set_name("templates/puck");
                request.set_revision(1);
                return DeleteTemplate(transaction, request, kSomebody);
              }).ok());
  ShipDisc("Puck", "puck");
  EXPECT_THAT(Load().created, ElementsAre("templates/puck"));
  EXPECT_EQ(TitleOf("templates/puck").value_or(""), "Puck");
}

TEST_F(CollectionLoaderTest, KeepsWhatUsersMadeInPlaceOfWhatTheyRemoved) {
  Ship(500, 1);
  Load();
  v1::Item own = ItemOf("items/knob");
  Remove("items/knob");
  own.mutable_price()->set_amount(9);
  own.clear_update_time();
  own.clear_revision();
  ASSERT_TRUE(Transact([&](store::Transaction& transaction) {
                return CreateItem(transaction, own, kSomebody).status();
              }).ok());
  ASSERT_EQ(ItemOf("items/knob").revision(), 1);  // as what was shipped had
  Ship(500, 2);
  EXPECT_THAT(Load().kept, ElementsAre("items/knob"));
  EXPECT_EQ(ItemOf("items/knob").price().amount(), 9);
}

TEST_F(CollectionLoaderTest, DoesNotReplaceWhatUsersMadeBefore) {
  Ship(600, 1);
  v1::Material own;
  own.set_name("materials/wood");
  own.set_title("Our wood");
  own.set_density(450);
  own.set_youngs_modulus(9e9);
  own.set_poissons_ratio(0.3);
  own.set_strength(2e7);
  ASSERT_TRUE(Transact([&](store::Transaction& transaction) {
                return CreateMaterial(transaction, own, kSomebody).status();
              }).ok());
  now_ += absl::Seconds(1);
  const CollectionReport report = Load();
  EXPECT_THAT(report.kept, ElementsAre("materials/wood"));
  EXPECT_THAT(report.created, ElementsAre("items/knob"));
}

TEST_F(CollectionLoaderTest, BringsStoresUpToDateThatWereFilledBeforeMarksWereKept) {
  Ship(500, 1, 1);
  Load();
  ForgetMarks();
  Reprice("items/hook", 7);
  Ship(510, 2, 2);
  now_ += absl::Seconds(1);
  const CollectionReport report = Load();
  EXPECT_THAT(report.updated, UnorderedElementsAre("materials/wood", "items/knob"));
  EXPECT_THAT(report.kept, ElementsAre("items/hook"));
  EXPECT_EQ(ItemOf("items/hook").price().amount(), 7);
}

TEST_F(CollectionLoaderTest, MakesNoRevisionsOfWhatIsTheSame) {
  Ship(500, 1);
  Load();
  ForgetMarks();
  EXPECT_THAT(Load().updated, IsEmpty());
  EXPECT_EQ(ItemOf("items/knob").revision(), 1);
  Ship(500, 2);
  EXPECT_THAT(Load().updated, ElementsAre("items/knob"));
}

TEST_F(CollectionLoaderTest, ACollectionThatCannotBeReadLeavesAFilledStoreAsItIs) {
  Ship(500, 1);
  Load();
  ASSERT_TRUE(WriteFile(collection_ / "items" / "hardware.csv", "not a table\n1,2\n").ok());
  const auto report = LoadCollection(*store_, collection_, parametrized_);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->failed.size(), 1u);
  EXPECT_EQ(ItemOf("items/knob").price().amount(), 1);
}

TEST_F(CollectionLoaderTest, AFaultOfTheCollectionStoresNothingInAnEmptyStore) {
  Ship(500, 1);
  ASSERT_TRUE(WriteFile(collection_ / "items" / "more.csv",
                        "name,title,kind,material,length_mm,width_mm,thickness_mm,price,currency,"
                        "price_date,price_is_example\n"
                        "items/odd,odd,HARDWARE,materials/absent,1,1,1,1,EUR,2026-01-15,true\n")
                  .ok());
  EXPECT_EQ(LoadCollection(*store_, collection_, parametrized_).status().code(),
            absl::StatusCode::kInvalidArgument);
  std::filesystem::remove(collection_ / "items" / "more.csv");
  EXPECT_THAT(Load().created, UnorderedElementsAre("materials/wood", "items/knob"));
}

TEST_F(CollectionLoaderTest, OneFaultDoesNotKeepTheRestFromAFilledStore) {
  Ship(500, 1);
  Load();
  ShipOddItem("odd");
  Ship(500, 1, 5);
  const CollectionReport report = LoadWithFaults();
  ASSERT_EQ(report.failed.size(), 1u);
  EXPECT_TRUE(report.failed[0].starts_with("items/odd: ")) << report.failed[0];
  EXPECT_THAT(report.created, ElementsAre("items/hook"));
}

TEST_F(CollectionLoaderTest, WhatCannotBeBroughtInIsToldOncePerVersion) {
  Ship(500, 1);
  Number(1);
  Load();
  ShipOddItem("odd");
  Number(2);
  EXPECT_EQ(LoadWithFaults().failed.size(), 1u);
  EXPECT_THAT(LoadWithFaults().failed, IsEmpty());
  // Another version, in which it is the same.
  Ship(500, 1, 5);
  Number(3);
  CollectionReport report = LoadWithFaults();
  EXPECT_EQ(report.failed.size(), 1u);
  EXPECT_THAT(report.created, ElementsAre("items/hook"));
  EXPECT_THAT(LoadWithFaults().failed, IsEmpty());
  // It changes, in a collection without numbers.
  std::filesystem::remove(collection_ / "versions.csv");
  ShipOddItem("stranger");
  EXPECT_EQ(LoadWithFaults().failed.size(), 1u);
  EXPECT_THAT(LoadWithFaults().failed, IsEmpty());
  // And goes in when what it lacked has come with the next version.
  const auto materials = ReadFile(collection_ / "materials.textproto");
  ASSERT_TRUE(materials.ok());
  ASSERT_TRUE(
      WriteFile(collection_ / "materials.textproto", *materials + MaterialText("absent", 700))
          .ok());
  Number(4);
  EXPECT_THAT(Load().created, UnorderedElementsAre("materials/absent", "items/odd"));
}

TEST_F(CollectionLoaderTest, WhatUsersRemovedStaysRemovedThoughAnUpdateOfItFailed) {
  Ship(500, 1);
  Number(1);
  Load();
  // The knob is made of something that there is not.
  const std::filesystem::path items = collection_ / "items" / "hardware.csv";
  std::string text = ReadFile(items).value();
  text.replace(text.find("materials/wood"), 14, "materials/gone");
  ASSERT_TRUE(WriteFile(items, text).ok());
  Number(2);
  EXPECT_EQ(LoadWithFaults().failed.size(), 1u);
  EXPECT_EQ(ItemOf("items/knob").revision(), 1);
  Remove("items/knob");
  Ship(500, 3);
  Number(3);
  EXPECT_THAT(Load().created, IsEmpty());
}

TEST_F(CollectionLoaderTest, AFailedUpdateDoesNotMakeAThingTheUsers) {
  Ship(500, 1);
  Number(1);
  Load();
  const std::filesystem::path items = collection_ / "items" / "hardware.csv";
  std::string text = ReadFile(items).value();
  text.replace(text.find("materials/wood"), 14, "materials/gone");
  ASSERT_TRUE(WriteFile(items, text).ok());
  Number(2);
  EXPECT_EQ(LoadWithFaults().failed.size(), 1u);
  Ship(500, 3);
  Number(3);
  EXPECT_THAT(Load().updated, ElementsAre("items/knob"));
  EXPECT_EQ(ItemOf("items/knob").price().amount(), 3);
}

TEST_F(CollectionLoaderTest, AnOlderCollectionChangesNothing) {
  Ship(500, 2);
  Number(2);
  Load();
  Ship(400, 1, 1);  // an older replica's, with something that the newer has no more
  Number(1);
  const CollectionReport report = Load();
  EXPECT_THAT(report.created, IsEmpty());
  EXPECT_THAT(report.updated, IsEmpty());
  EXPECT_EQ(ItemOf("items/knob").price().amount(), 2);
  Ship(500, 3);
  Number(3);
  EXPECT_THAT(Load().updated, ElementsAre("items/knob"));
}

// What was once shipped may be shipped again: the order is that of the numbers.
TEST_F(CollectionLoaderTest, AContentThatComesAgainIsNewerAllTheSame) {
  for (const auto& [number, price] : {std::pair{1, 1.0}, {2, 2.0}, {3, 1.0}}) {
    Ship(500, price);
    Number(number);
    Load();
  }
  Ship(500, 2);
  Number(2);
  EXPECT_THAT(Load().updated, IsEmpty());
  EXPECT_EQ(ItemOf("items/knob").price().amount(), 1);
}

TEST_F(CollectionLoaderTest, StoresThatKnowNoNumbersGoOn) {
  Ship(500, 1, 1);
  Load();
  Reprice("items/hook", 7);
  Ship(500, 2, 2);
  Number(5);
  const CollectionReport report = Load();
  EXPECT_THAT(report.updated, ElementsAre("items/knob"));
  EXPECT_THAT(report.kept, ElementsAre("items/hook"));
  // A folder without a number has no order, and is taken as before.
  std::filesystem::remove(collection_ / "versions.csv");
  Ship(500, 3, 2);
  EXPECT_THAT(Load().updated, ElementsAre("items/knob"));
}

}  // namespace
}  // namespace mortise::catalog
