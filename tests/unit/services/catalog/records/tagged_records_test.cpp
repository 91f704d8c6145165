// External ids, labels and creators of the catalog's records: kept, found by, and no content.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/assembly/codec/assembly_codec.h"
#include "common/base/errors.h"
#include "common/resources/collection.h"
#include "services/catalog/records/assembly_records.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/shipped_revisions.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::catalog {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

constexpr int64_t kBegin = 1'700'000'000;  // s
const resources::Author kAda = {.user = "users/ada", .trace_id = ""};
const resources::Author kBob = {.user = "users/bob", .trace_id = ""};

template <typename Message>
Message Parsed(const std::string& text) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

v1::Material Steel() {
  return Parsed<v1::Material>(
      "name: 'materials/steel' title: 'Steel' density: 7850 youngs_modulus: 2e11 "
      "poissons_ratio: 0.3 strength: 2e8");
}

v1::Item Knob() {
  return Parsed<v1::Item>(
      "name: 'items/knob' title: 'Knob' kind: HARDWARE material: 'materials/steel' "
      "dimensions { axis: X size: 0.03 } dimensions { axis: Y size: 0.03 } "
      "dimensions { axis: Z size: 0.02 } price { currency: 'EUR' amount: 2 } "
      "price_basis: PER_PIECE price_date: '2026-01-15'");
}

v1::Assembly Post() {
  return Parsed<v1::Assembly>(
      "name: 'assemblies/post' title: 'Post' parts { name: 'post' size { x: 0.1 y: 0.1 z: 1 } }");
}

v1::Template Disc() {
  return Parsed<v1::Template>(
      "name: 'templates/disc' cad { title: 'Disc' material: 'materials/steel' "
      "parameters { name: 'radius' title: 'Radius' unit: 'm' "
      "             minimum: 0.1 maximum: 0.3 default_value: 0.2 } "
      "features { name: 'base' sketch { profiles { name: 'rim' circle { radius: 'radius' } } } } "
      "features { name: 'disc' extrude { sketch: 'base' from: '0' to: '0.1' } } }");
}

template <typename Message>
void Tag(Message& message) {
  message.add_external_ids("100-4711/A");
  (*message.mutable_labels())["site"] = "Hamburg";
  (*message.mutable_labels())["stocked"] = "";
}

class TaggedRecordsTest : public ::testing::Test {
 protected:
  TaggedRecordsTest() {
    EXPECT_OK(Change<v1::Material>([](store::Transaction& transaction) {
      return CreateMaterial(transaction, Steel(), kAda);
    }));
  }

  // What a change of the store gives, a minute after the one before.
  template <typename Message>
  absl::StatusOr<Message> Change(
      const std::function<absl::StatusOr<Message>(store::Transaction&)>& change) {
    now_ += absl::Minutes(1);
    absl::StatusOr<Message> changed = absl::UnknownError("not run");
    const absl::Status stored = store_->Transact([&](store::Transaction& transaction) {
      changed = change(transaction);
      return changed.status();
    });
    if (!stored.ok()) return stored;
    return changed;
  }

  absl::StatusOr<v1::Item> Create(const v1::Item& item, const resources::Author& author = kAda) {
    return Change<v1::Item>(
        [&](store::Transaction& transaction) { return CreateItem(transaction, item, author); });
  }

  absl::StatusOr<v1::Item> Update(const v1::Item& item, const std::vector<std::string>& mask,
                                  const resources::Author& author = kBob) {
    v1::UpdateItemRequest request;
    *request.mutable_item() = item;
    for (const std::string& path : mask) request.mutable_update_mask()->add_paths(path);
    return Change<v1::Item>(
        [&](store::Transaction& transaction) { return UpdateItem(transaction, request, author); });
  }

  // The revision before and after.
  std::vector<int64_t> Replace(const v1::Item& item) {
    const auto replaced = Change<Replacement>(
        [&](store::Transaction& transaction) { return ReplaceItem(transaction, item, kBob); });
    EXPECT_OK(replaced);
    if (!replaced.ok()) return {};
    return {replaced->before, replaced->revision};
  }

  absl::StatusOr<v1::Assembly> Import(const v1::Assembly& assembly, int64_t expected,
                                      const resources::Author& author = kAda) {
    return Change<v1::Assembly>(
        [&](store::Transaction& transaction) -> absl::StatusOr<v1::Assembly> {
          MORTISE_ASSIGN_OR_RETURN(const v1::AssemblyBundle bundle, Freeze(transaction, assembly));
          return ImportBundle(transaction, bundle, expected, author);
        });
  }

  absl::StatusOr<v1::Template> Import(const v1::Template& message, int64_t expected,
                                      const resources::Author& author = kAda) {
    return Change<v1::Template>(
        [&](store::Transaction& transaction) -> absl::StatusOr<v1::Template> {
          MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle, Freeze(transaction, message));
          MORTISE_RETURN_IF_ERROR(templates::FillAndCheck(bundle, templates::Trial::kDefaults));
          return ImportBundle(transaction, bundle, expected, author);
        });
  }

  v1::Item ItemOf(const std::string& name, int64_t revision = 0) {
    const auto item = resources::ReadFrom<v1::Item>(
        *store_,
        [&](store::ReadTransaction& transaction) { return GetItem(transaction, name, revision); });
    EXPECT_OK(item);
    return item.value_or(v1::Item());
  }

  // The names of the items of a list.
  absl::StatusOr<std::vector<std::string>> List(const v1::ListItemsRequest& request) {
    MORTISE_ASSIGN_OR_RETURN(
        const Page<v1::Item> page,
        resources::ReadFrom<Page<v1::Item>>(*store_, [&](store::ReadTransaction& transaction) {
          return ListItems(transaction, request);
        }));
    std::vector<std::string> names;
    for (const v1::Item& item : page.entries) names.push_back(item.name());
    return names;
  }

  const testing::TemporaryFolder folder_;
  absl::Time now_ = absl::FromUnixSeconds(kBegin);
  const std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = "sqlite:" + (folder_.path() / "store.db").string(),
                        .clock = [this] { return now_; }})
          .value();
};

TEST_F(TaggedRecordsTest, ItemsKeepWhatTheyAreFoundByAndWhoCreatedThem) {
  v1::Item knob = Knob();
  Tag(knob);
  knob.set_creator("users/mallory");
  knob.mutable_create_time()->set_seconds(1);
  ASSERT_OK_AND_ASSIGN(const v1::Item created, Create(knob));
  EXPECT_THAT(created.external_ids(), ElementsAre("100-4711/A"));
  EXPECT_EQ(created.labels().at("site"), "Hamburg");
  EXPECT_EQ(created.creator(), "users/ada");
  EXPECT_EQ(created.create_time().seconds(), kBegin + 120);

  v1::Item retitled = created;
  retitled.set_title("Round knob");
  retitled.set_creator("users/mallory");
  ASSERT_OK_AND_ASSIGN(const v1::Item updated, Update(retitled, {}));
  EXPECT_EQ(updated.revision(), 2);
  EXPECT_EQ(updated.creator(), "users/ada");
  EXPECT_EQ(updated.create_time().seconds(), kBegin + 120);
  EXPECT_EQ(updated.update_time().seconds(), kBegin + 180);
  EXPECT_TRUE(resources::HaveSameTags(updated, created));
}

TEST_F(TaggedRecordsTest, OtherTagsAloneAreANewRevision) {
  ASSERT_OK_AND_ASSIGN(v1::Item knob, Create(Knob()));
  Tag(knob);
  ASSERT_OK_AND_ASSIGN(v1::Item tagged, Update(knob, {"labels"}));
  EXPECT_EQ(tagged.revision(), 2);
  EXPECT_EQ(tagged.labels_size(), 2);
  EXPECT_THAT(tagged.external_ids(), IsEmpty()) << "not of the mask";
  tagged.mutable_labels()->clear();
  (*tagged.mutable_labels())["shelf"] = "4";
  ASSERT_OK_AND_ASSIGN(const v1::Item other, Update(tagged, {"labels", "title"}));
  EXPECT_EQ(other.revision(), 3);
  EXPECT_THAT(other.labels_size(), 1) << "those of the mask take the place of all before";
  EXPECT_EQ(ItemOf("items/knob", 2).labels_size(), 2);
}

TEST_F(TaggedRecordsTest, AReplacementThatSaysNothingOfTagsLeavesThem) {
  v1::Item knob = Knob();
  Tag(knob);
  ASSERT_OK(Create(knob));
  EXPECT_THAT(Replace(Knob()), ElementsAre(1, 1)) << "the same again";
  v1::Item dearer = Knob();
  dearer.mutable_price()->set_amount(3);
  EXPECT_THAT(Replace(dearer), ElementsAre(1, 2));
  EXPECT_TRUE(resources::HaveSameTags(ItemOf("items/knob"), knob));
  EXPECT_EQ(ItemOf("items/knob").creator(), "users/ada");
  (*dearer.mutable_labels())["site"] = "Bremen";
  EXPECT_THAT(Replace(dearer), ElementsAre(2, 3));
  EXPECT_THAT(Replace(dearer), ElementsAre(3, 3));
  const v1::Item now = ItemOf("items/knob");
  EXPECT_EQ(now.labels_size(), 1);
  EXPECT_THAT(now.external_ids(), ElementsAre("100-4711/A"));
}

TEST_F(TaggedRecordsTest, ReadsItemsThatWereWrittenWithoutACreator) {
  ASSERT_OK(Change<int64_t>([](store::Transaction& transaction) {
    return transaction.Put(kItems, "knob", Knob().SerializeAsString());
  }));
  const v1::Item old = ItemOf("items/knob");
  EXPECT_EQ(old.creator(), "");
  EXPECT_EQ(old.create_time().seconds(), kBegin + 120);
  v1::Item tagged = old;
  Tag(tagged);
  ASSERT_OK_AND_ASSIGN(const v1::Item updated, Update(tagged, {}));
  EXPECT_EQ(updated.creator(), "") << "nobody knows who created it";
  EXPECT_EQ(updated.create_time().seconds(), kBegin + 120);
}

TEST_F(TaggedRecordsTest, TellsAllThatIsWrong) {
  v1::Item knob = Knob();
  knob.set_material("materials/cheese");
  knob.add_external_ids("4711");
  knob.add_external_ids("");
  (*knob.mutable_labels())["two words"] = "";
  const auto fields = [](const absl::Status& status) {
    std::vector<std::string> names;
    for (const FieldViolation& violation : ViolationsOf(status)) names.push_back(violation.field);
    return names;
  };
  EXPECT_THAT(fields(Create(knob).status()),
              UnorderedElementsAre("item.material", "item.external_ids[1]", "item.labels"));
  v1::Material tin = Steel();
  tin.set_name("materials/tin");
  tin.set_density(-1);
  tin.add_external_ids(std::string(201, 'x'));
  EXPECT_THAT(fields(Change<v1::Material>([&](store::Transaction& transaction) {
                       return CreateMaterial(transaction, tin, kAda);
                     }).status()),
              UnorderedElementsAre("material.density", "material.external_ids[0]"));
  ASSERT_OK_AND_ASSIGN(const v1::Item sound, Create(Knob()));
  EXPECT_THAT(fields(Update(sound, {"creator", "create_time.seconds", "labels"}).status()),
              ElementsAre("update_mask", "update_mask"));
}

TEST_F(TaggedRecordsTest, ListsByEveryPartOfAFilter) {
  v1::Item knob = Knob();
  Tag(knob);
  ASSERT_OK(Create(knob));
  v1::Item hook = Knob();
  hook.set_name("items/hook");
  (*hook.mutable_labels())["site"] = "Bremen";
  ASSERT_OK(Create(hook, kBob));
  const auto listed = [&](const std::string& filter) {
    v1::ListItemsRequest request;
    *request.mutable_filter() = Parsed<v1::ResourceFilter>(filter);
    const auto names = List(request);
    EXPECT_OK(names);
    return names.value_or(std::vector<std::string>());
  };
  EXPECT_THAT(listed(""), ElementsAre("items/hook", "items/knob"));
  EXPECT_THAT(listed("external_id: '100-4711/A'"), ElementsAre("items/knob"));
  EXPECT_THAT(listed("external_id: '100-4711'"), IsEmpty());
  EXPECT_THAT(listed("labels { key: 'site' value: '' }"), ElementsAre("items/hook", "items/knob"));
  EXPECT_THAT(listed("labels { key: 'site' value: 'Bremen' }"), ElementsAre("items/hook"));
  EXPECT_THAT(listed("creator: 'users/ada'"), ElementsAre("items/knob"));
  EXPECT_THAT(listed("created_from { seconds: 1700000180 }"), ElementsAre("items/hook"));
  EXPECT_THAT(listed("created_before { seconds: 1700000180 }"), ElementsAre("items/knob"));
  EXPECT_THAT(listed("labels { key: 'site' value: '' } creator: 'users/bob'"),
              ElementsAre("items/hook"));

  v1::ListItemsRequest wrong;
  wrong.set_page_size(-1);
  wrong.set_material("materials/cheese");
  (*wrong.mutable_filter()->mutable_labels())["two words"] = "";
  wrong.mutable_filter()->mutable_created_from()->set_nanos(-1);
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(List(wrong).status())) {
    fields.push_back(violation.field);
  }
  EXPECT_THAT(fields, UnorderedElementsAre("page_size", "material", "filter.labels",
                                           "filter.created_from"));
}

TEST_F(TaggedRecordsTest, AssembliesWithOtherTagsAreNewRevisionsOfTheSameDigest) {
  ASSERT_OK_AND_ASSIGN(const v1::Assembly first, Import(Post(), 0));
  EXPECT_EQ(first.creator(), "users/ada");
  v1::Assembly tagged = Post();
  Tag(tagged);
  tagged.set_creator("users/mallory");
  ASSERT_OK_AND_ASSIGN(const v1::Assembly second, Import(tagged, 1, kBob));
  EXPECT_EQ(second.revision(), 2);
  EXPECT_EQ(second.digest(), first.digest());
  EXPECT_EQ(second.creator(), "users/ada");
  EXPECT_TRUE(resources::HaveSameTags(second, tagged));
  ASSERT_OK_AND_ASSIGN(const v1::Assembly again, Import(tagged, 2, kBob));
  EXPECT_EQ(again.revision(), 2) << "the same again";
  ASSERT_OK_AND_ASSIGN(const v1::Assembly bare, Import(Post(), 2, kBob));
  EXPECT_EQ(bare.revision(), 3) << "an import says all of an assembly";
  EXPECT_THAT(bare.external_ids(), IsEmpty());
}

TEST_F(TaggedRecordsTest, TemplatesWithOtherTagsAreNewRevisionsOfTheSameDigest) {
  ASSERT_OK_AND_ASSIGN(const v1::Template first, Import(Disc(), 0));
  v1::Template tagged = Disc();
  Tag(tagged);
  ASSERT_OK_AND_ASSIGN(const v1::Template second, Import(tagged, 1, kBob));
  EXPECT_EQ(second.revision(), 2);
  EXPECT_EQ(second.digest(), first.digest());
  EXPECT_EQ(second.creator(), "users/ada");
  EXPECT_TRUE(resources::HaveSameTags(second, tagged));
  ASSERT_OK_AND_ASSIGN(const v1::Template again, Import(tagged, 2, kBob));
  EXPECT_EQ(again.revision(), 2) << "the same again";
  ASSERT_OK_AND_ASSIGN(
      const Page<v1::Template> page,
      resources::ReadFrom<Page<v1::Template>>(*store_, [&](store::ReadTransaction& transaction) {
        v1::ListTemplatesRequest request;
        request.mutable_filter()->set_external_id("100-4711/A");
        return ListTemplates(transaction, request);
      }));
  ASSERT_EQ(page.entries.size(), 1u);
  EXPECT_TRUE(resources::HaveSameTags(page.entries[0], tagged)) << "summaries have them";
}

TEST_F(TaggedRecordsTest, TagsOfItemsAreNoContentOfWhatUsesThem) {
  ASSERT_OK_AND_ASSIGN(const v1::Template first, Import(Disc(), 0));
  ASSERT_OK(Change<v1::Material>([](store::Transaction& transaction) {
    v1::UpdateMaterialRequest request;
    *request.mutable_material() = Steel();
    request.mutable_material()->set_revision(1);
    Tag(*request.mutable_material());
    return UpdateMaterial(transaction, request, kBob);
  }));
  ASSERT_OK_AND_ASSIGN(const v1::Template again, Import(Disc(), 1));
  EXPECT_EQ(again.revision(), 1);
  EXPECT_EQ(again.digest(), first.digest());
}

TEST_F(TaggedRecordsTest, WhatShippedIsKnownAsThatWithTags) {
  ASSERT_OK(Create(Knob()));
  ASSERT_OK(Change<int64_t>([](store::Transaction& transaction) -> absl::StatusOr<int64_t> {
    MORTISE_ASSIGN_OR_RETURN(const auto present, FindPresent(transaction, kItems, "items/knob"));
    MORTISE_RETURN_IF_ERROR(PutShippedRevision(
        transaction, "items/knob",
        {.digest = "shipped", .revision = 1, .created_at = present->created_at}));
    return 0;
  }));
  const auto is_as_shipped = [&] {
    bool is = false;
    EXPECT_OK(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(const auto shipped, GetShippedRevision(transaction, "items/knob"));
      MORTISE_ASSIGN_OR_RETURN(const auto present, FindPresent(transaction, kItems, "items/knob"));
      is = IsAsShipped(shipped, present);
      return absl::OkStatus();
    }));
    return is;
  };
  ASSERT_TRUE(is_as_shipped());
  v1::Item tagged = ItemOf("items/knob");
  Tag(tagged);
  ASSERT_OK(Update(tagged, {}));
  EXPECT_TRUE(is_as_shipped());
  v1::Item dearer = ItemOf("items/knob");
  dearer.mutable_price()->set_amount(3);
  ASSERT_OK(Update(dearer, {}));
  EXPECT_FALSE(is_as_shipped());
  dearer = ItemOf("items/knob");
  dearer.clear_labels();
  ASSERT_OK(Update(dearer, {}));
  EXPECT_FALSE(is_as_shipped());
}

}  // namespace
}  // namespace mortise::catalog
