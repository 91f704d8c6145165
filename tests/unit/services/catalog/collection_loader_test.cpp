// A collection in a store: all of it when that is empty; later what is new, and never instead of
// what users changed.
#include "services/catalog/collection_loader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/parametric/collection.h"
#include "services/catalog/catalog_records.h"
#include "services/catalog/shape_records.h"
#include "services/catalog/shape_sweep.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::catalog {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

std::string MaterialText(const std::string& id, double density) {
  return absl::StrCat("materials { name: 'materials/", id, "' title: '", id, "' density: ", density,
                      " youngs_modulus: 2e11 poissons_ratio: 0.3 strength: 2e8 }\n");
}

class CollectionLoaderTest : public ::testing::Test {
 protected:
  // Density of wood and price of the knob; with a second item if that has a price.
  void Ship(double density, double knob, double hook = 0) {
    const std::string head =
        "# proto-file: mortise/v1/template.proto\n# proto-message: mortise.v1.TemplateBundle\n";
    ASSERT_TRUE(
        WriteFile(collection_ / "materials.textproto", head + MaterialText("wood", density)).ok());
    std::string items =
        "name,title,kind,material,length_mm,width_mm,thickness_mm,price,currency,price_date,"
        "price_is_example\n";
    const auto add = [&](const char* id, double price) {
      if (price == 0) return;
      absl::StrAppend(&items, "items/", id, ",", id, ",HARDWARE,materials/wood,30,30,27,", price,
                      ",EUR,2026-01-15,true\n");
    };
    add("knob", knob);
    add("hook", hook);
    ASSERT_TRUE(WriteFile(collection_ / "items" / "hardware.csv", items).ok());
  }

  // A template of one disc of wood.
  void ShipDisc(const std::string& title, const std::string& id = "disc") {
    ASSERT_TRUE(WriteFile(collection_ / "cad_templates" / (id + ".textproto"),
                          absl::StrCat("# proto-file: mortise/v1/cad_template.proto\n"
                                       "# proto-message: mortise.v1.CadTemplate\n"
                                       "name: 'templates/",
                                       id, "' title: '", title, "' material: 'materials/wood'\n",
                                       "parameters { name: 'radius' title: 'Radius' unit: 'm' "
                                       "minimum: 0.1 maximum: 0.3 default_value: 0.2 }\n"
                                       "features { name: 'base' sketch { "
                                       "profiles { name: 'rim' circle { radius: 'radius' } } } }\n"
                                       "features { name: 'disc' extrude { "
                                       "sketch: 'base' from: '0' to: '0.1' } }\n"))
                    .ok());
  }

  absl::StatusOr<std::string> TitleOf(const std::string& name) {
    std::string title;
    MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(const v1::TemplateBundle bundle, GetBundle(transaction, name, 0));
      title = bundle.template_().title();
      return absl::OkStatus();
    }));
    return title;
  }

  // Gives what was shipped last a number.
  void Number(int64_t number) {
    const auto shipped = parametric::ReadCollection(collection_);
    ASSERT_TRUE(shipped.ok()) << shipped.status();
    ASSERT_TRUE(WriteFile(collection_ / "versions.csv",
                          absl::StrCat("number,digest\n", number, ",",
                                       parametric::ContentDigest(*shipped), "\n"))
                    .ok());
  }

  // An item of a material that there is not.
  void ShipOddItem(const std::string& title) {
    ASSERT_TRUE(
        WriteFile(collection_ / "items" / "a.csv",
                  absl::StrCat("name,title,kind,material,length_mm,width_mm,thickness_mm,price,"
                               "currency,price_date,price_is_example\n"
                               "items/odd,",
                               title, ",HARDWARE,materials/absent,1,1,1,1,EUR,2026-01-15,true\n"))
            .ok());
  }

  // A knob that looks like a pyramid of this height, m, in its box; its name.
  std::string ShipShapedKnob(double height) {
    mesh::SurfaceMesh pyramid;
    pyramid.vertices.resize(3, 4);
    pyramid.vertices << 0, 0.03, 0, 0, 0, 0, 0.03, 0, 0, 0, 0, height;
    pyramid.triangles.resize(3, 4);
    pyramid.triangles << 0, 0, 1, 0, 2, 1, 2, 3, 1, 3, 3, 2;
    const v1::Shape shape = NamedShape(mesh::ShapeOfMesh(pyramid).value());
    EXPECT_OK(WriteFile(collection_ / "shapes" / "knob.shape", shape.SerializeAsString()));
    EXPECT_OK(WriteFile(
        collection_ / "items" / "knobs.csv",
        absl::StrCat("name,title,kind,material,length_mm,width_mm,thickness_mm,price,currency,"
                     "price_date,price_is_example,shape\nitems/pyramid,Knob,HARDWARE,"
                     "materials/wood,30,30,",
                     1000 * height, ",1,EUR,2026-01-15,true,../shapes/knob.step\n")));
    return shape.name();
  }

  // The names of all shapes in the store.
  std::vector<std::string> Shapes() {
    std::vector<std::string> names;
    EXPECT_OK(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
      names.clear();
      MORTISE_ASSIGN_OR_RETURN(const auto records, transaction.List(kShapes, {}));
      for (const store::Record& record : records) names.push_back("shapes/" + record.key);
      return absl::OkStatus();
    }));
    return names;
  }

  CollectionReport LoadWithFaults() {
    auto report = LoadCollection(*store_, collection_, parametrized_);
    EXPECT_TRUE(report.ok()) << report.status();
    return *std::move(report);
  }

  CollectionReport Load() {
    auto report = LoadCollection(*store_, collection_, parametrized_);
    EXPECT_TRUE(report.ok()) << report.status();
    EXPECT_THAT(report->failed, IsEmpty());
    return *std::move(report);
  }

  absl::Status Transact(const std::function<absl::Status(store::Transaction&)>& change) {
    now_ += absl::Seconds(1);
    return store_->Transact(change);
  }

  v1::Item ItemOf(const std::string& name) {
    v1::Item item;
    EXPECT_TRUE(store_
                    ->Read([&](store::ReadTransaction& transaction) -> absl::Status {
                      MORTISE_ASSIGN_OR_RETURN(item, GetItem(transaction, name));
                      return absl::OkStatus();
                    })
                    .ok());
    return item;
  }

  // Somebody's own price for an item.
  void Reprice(const std::string& name, double price) {
    v1::UpdateItemRequest update;
    *update.mutable_item() = ItemOf(name);
    update.mutable_item()->mutable_price()->set_amount(price);
    ASSERT_TRUE(Transact([&](store::Transaction& transaction) {
                  return UpdateItem(transaction, update, "somebody").status();
                }).ok());
  }

  void Remove(const std::string& name) {
    v1::DeleteItemRequest request;
    request.set_name(name);
    request.set_revision(ItemOf(name).revision());
    ASSERT_TRUE(Transact([&](store::Transaction& transaction) {
                  return DeleteItem(transaction, request, "somebody");
                }).ok());
  }

  // Forgets what was shipped, as stores that were filled before that was kept.
  void ForgetMarks() {
    ASSERT_TRUE(Transact([&](store::Transaction& transaction) -> absl::Status {
                  store::ListOptions all;
                  MORTISE_ASSIGN_OR_RETURN(const auto marks, transaction.List("shipped", all));
                  EXPECT_FALSE(marks.empty());
                  for (const store::Record& mark : marks)
                    MORTISE_RETURN_IF_ERROR(transaction.Delete("shipped", mark.key));
                  return absl::OkStatus();
                }).ok());
  }

  testing::TemporaryFolder folder_;
  const std::filesystem::path collection_ = folder_.path() / "collection";
  absl::Time now_ = absl::FromUnixSeconds(1'700'000'000);
  ParametrizationCache parametrized_{std::size_t{64} << 20};
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = absl::StrCat("sqlite:", (folder_.path() / "store.db").string()),
                        .clock = [this] { return now_; }})
          .value();
};

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

TEST_F(CollectionLoaderTest, DoesNotBringBackTemplatesThatUsersRemoved) {
  Ship(500, 2);
  ShipDisc("Disc");
  Load();
  v1::DeleteTemplateRequest request;
  request.set_name("templates/disc");
  request.set_revision(1);
  ASSERT_TRUE(Transact([&](store::Transaction& transaction) {
                return DeleteTemplate(transaction, request, "somebody");
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
                return ImportBundle(transaction, bundle, 0, "somebody").status();
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
                MORTISE_RETURN_IF_ERROR(ImportBundle(transaction, bundle, 0, "somebody").status());
                v1::DeleteTemplateRequest request;
                request.set_name("templates/puck");
                request.set_revision(1);
                return DeleteTemplate(transaction, request, "somebody");
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
                return CreateItem(transaction, own, "somebody").status();
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
                return CreateMaterial(transaction, own, "somebody").status();
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
