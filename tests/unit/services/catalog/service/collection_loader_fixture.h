// A collection that tests write, and a store to bring it into.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/files/collection.h"
#include "common/resources/author.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/shape_records.h"
#include "services/catalog/records/shape_sweep.h"
#include "services/catalog/service/collection_loader.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::catalog {

inline const resources::Author kSomebody = {.user = "users/somebody", .trace_id = ""};

inline std::string MaterialText(const std::string& id, double density) {
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
    EXPECT_THAT(report->failed, ::testing::IsEmpty());
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
                  return UpdateItem(transaction, update, kSomebody).status();
                }).ok());
  }

  template <typename Message>
  static void Tag(Message* message) {
    message->clear_external_ids();
    message->add_external_ids("100-4711/A");
    (*message->mutable_labels())["site"] = "Hamburg";
  }

  // Somebody's own number and label for what ships.
  void TagItem(const std::string& name) {
    v1::UpdateItemRequest update;
    *update.mutable_item() = ItemOf(name);
    Tag(update.mutable_item());
    ASSERT_OK(Transact([&](store::Transaction& transaction) {
      return UpdateItem(transaction, update, kSomebody).status();
    }));
  }

  void TagTemplate(const std::string& name) {
    ASSERT_OK(Transact([&](store::Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle, GetBundle(transaction, name, 0));
      const int64_t present = bundle.template_().revision();
      Tag(bundle.mutable_template_());
      return ImportBundle(transaction, bundle, present, kSomebody).status();
    }));
  }

  v1::Template TemplateOf(const std::string& name) {
    v1::Template found;
    EXPECT_OK(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(const v1::TemplateBundle bundle, GetBundle(transaction, name, 0));
      found = bundle.template_();
      return absl::OkStatus();
    }));
    return found;
  }

  void Remove(const std::string& name) {
    v1::DeleteItemRequest request;
    request.set_name(name);
    request.set_revision(ItemOf(name).revision());
    ASSERT_TRUE(Transact([&](store::Transaction& transaction) {
                  return DeleteItem(transaction, request, kSomebody);
                }).ok());
  }

  // Forgets what was shipped, as stores that were filled before that was kept.
  void ForgetMarks() {
    ASSERT_TRUE(Transact([&](store::Transaction& transaction) -> absl::Status {
                  store::ListOptions all;
                  MORTISE_ASSIGN_OR_RETURN(const auto marks, transaction.List("shipped", all));
                  EXPECT_FALSE(marks.empty());
                  for (const store::Record& mark : marks) {
                    MORTISE_RETURN_IF_ERROR(transaction.Delete("shipped", mark.key));
                  }
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

}  // namespace mortise::catalog
