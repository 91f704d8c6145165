// External ids, labels and creators through the catalog as a process: given, found by, changed, and
// refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "common/base/field_violations.h"
#include "common/store/store.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/catalog/catalog_service_fixture.h"
#include "tests/integration/services/catalog/imported_catalog.h"
#include "tests/support/status_assertions.h"

namespace mortise::catalog {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;
using Stub = v1::CatalogService::Stub;
using AssemblyStub = v1::AssemblyService::Stub;

constexpr char kDeveloper[] = "users/developer";  // who calls a process in development

template <typename Message>
void Tag(Message* message, const std::string& number = "100-4711/A") {
  message->add_external_ids(number);
  (*message->mutable_labels())["site"] = "Hamburg";
}

std::vector<std::string> FieldsOf(const absl::Status& status) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(status)) fields.push_back(violation.field);
  if (fields.empty()) fields.push_back(DetailOf(status).field);
  return fields;
}

template <typename Entries>
std::vector<std::string> NamesOf(const Entries& entries) {
  std::vector<std::string> names;
  for (const auto& entry : entries) names.push_back(entry.name());
  return names;
}

class TagsTest : public CatalogServiceTest {
 protected:
  absl::StatusOr<v1::Item> Create(const v1::Item& item) {
    v1::CreateItemRequest request;
    request.set_request_id(NewRequestId());
    *request.mutable_item() = item;
    return testing::Call(*stub_, &Stub::CreateItem, request);
  }

  absl::StatusOr<v1::Template> Import(const v1::Template& message, int64_t expected) {
    return testing::Call(*stub_, &Stub::ImportTemplate, ImportRequest(message, expected));
  }

  // The names of the items that a filter leaves.
  std::vector<std::string> ItemsOf(const v1::ResourceFilter& filter) {
    v1::ListItemsRequest request;
    *request.mutable_filter() = filter;
    const auto page = testing::Call(*stub_, &Stub::ListItems, request);
    EXPECT_OK(page);
    return NamesOf(page.value_or(v1::ListItemsResponse()).items());
  }
};

TEST_F(TagsTest, ItemsAreFoundByWhatTheyAreTaggedWith) {
  v1::Item peg = Peg("peg", GetItem("items/dowel-8x35").material());
  Tag(&peg);
  peg.set_creator("users/mallory");
  ASSERT_OK_AND_ASSIGN(const v1::Item created, Create(peg));
  EXPECT_THAT(created.external_ids(), ElementsAre("100-4711/A"));
  EXPECT_EQ(created.labels().at("site"), "Hamburg");
  EXPECT_EQ(created.creator(), kDeveloper);
  EXPECT_GT(created.create_time().seconds(), 0);

  v1::ResourceFilter filter;
  filter.set_external_id("100-4711/A");
  EXPECT_THAT(ItemsOf(filter), ElementsAre("items/peg"));
  filter.Clear();
  (*filter.mutable_labels())["site"] = "";
  EXPECT_THAT(ItemsOf(filter), ElementsAre("items/peg"));
  (*filter.mutable_labels())["site"] = "Bremen";
  EXPECT_THAT(ItemsOf(filter), IsEmpty());
  filter.Clear();
  filter.set_creator(kDeveloper);
  EXPECT_THAT(ItemsOf(filter), ElementsAre("items/peg")) << "all others shipped";
  filter.Clear();
  *filter.mutable_created_from() = created.create_time();
  EXPECT_THAT(ItemsOf(filter), ElementsAre("items/peg"));
}

TEST_F(TagsTest, AnUpdateOfTagsIsARevisionThatKeepsTheCreator) {
  v1::UpdateItemRequest request;
  request.set_request_id(NewRequestId());
  *request.mutable_item() = GetItem("items/dowel-8x35");
  const int64_t before = request.item().revision();
  const std::string creator = request.item().creator();
  Tag(request.mutable_item());
  request.mutable_update_mask()->add_paths("external_ids");
  ASSERT_OK_AND_ASSIGN(const v1::Item updated, testing::Call(*stub_, &Stub::UpdateItem, request));
  EXPECT_EQ(updated.revision(), before + 1);
  EXPECT_EQ(updated.creator(), creator);
  EXPECT_EQ(updated.create_time().seconds(), request.item().create_time().seconds());
  EXPECT_THAT(updated.external_ids(), ElementsAre("100-4711/A"));
  EXPECT_THAT(updated.labels(), IsEmpty());

  // The catalog takes its collection again when it starts, and leaves them.
  process_.Kill();
  process_.Start();
  Connect();
  EXPECT_THAT(GetItem("items/dowel-8x35").external_ids(), ElementsAre("100-4711/A"));
}

TEST_F(TagsTest, TellsAllThatIsWrongAtOnce) {
  v1::Item peg = Peg("peg", "materials/cheese");
  peg.add_external_ids("4711");
  peg.add_external_ids("4711");
  (*peg.mutable_labels())["two words"] = "";
  EXPECT_THAT(FieldsOf(Create(peg).status()),
              UnorderedElementsAre("item.material", "item.external_ids[1]", "item.labels"));

  v1::Template table = GetTemplate("templates/table");
  table.mutable_parts(0)->set_item("items/nothing");
  table.add_external_ids("");
  EXPECT_THAT(FieldsOf(Import(table, 7).status()),
              UnorderedElementsAre("template.parts[0].item", "template.external_ids[0]",
                                   "expected_revision"));

  v1::ImportCatalogRequest import;
  import.set_request_id(NewRequestId());
  *import.add_materials() = Wood("ash");
  import.mutable_materials(0)->set_density(-1);
  import.mutable_materials(0)->add_external_ids("\n");
  *import.add_templates() = GetTemplate("templates/table");
  (*import.mutable_templates(0)->mutable_labels())[""] = "";
  EXPECT_THAT(FieldsOf(testing::Call(*stub_, &Stub::ImportCatalog, import).status()),
              UnorderedElementsAre("materials[0].density", "materials[0].external_ids[0]",
                                   "templates[0].labels"));

  v1::ListTemplatesRequest templates;
  templates.set_item("items/nothing");
  templates.set_page_size(-1);
  (*templates.mutable_filter()->mutable_labels())["two words"] = "";
  EXPECT_THAT(FieldsOf(testing::Call(*stub_, &Stub::ListTemplates, templates).status()),
              UnorderedElementsAre("item", "page_size", "filter.labels"));
  v1::ListMaterialsRequest materials;
  materials.set_text(std::string(201, 'x'));
  materials.mutable_filter()->set_external_id("\t");
  EXPECT_THAT(FieldsOf(testing::Call(*stub_, &Stub::ListMaterials, materials).status()),
              UnorderedElementsAre("text", "filter.external_id"));
}

TEST_F(TagsTest, TemplatesWithOtherTagsHaveTheSameDigest) {
  v1::Template table = GetTemplate("templates/table");
  const std::string digest = table.digest();
  const int64_t shipped = table.revision();
  Tag(&table);
  ASSERT_OK_AND_ASSIGN(const v1::Template tagged, Import(table, shipped));
  EXPECT_EQ(tagged.revision(), shipped + 1);
  EXPECT_EQ(tagged.digest(), digest);
  ASSERT_OK_AND_ASSIGN(const v1::Template again, Import(table, shipped + 1));
  EXPECT_EQ(again.revision(), shipped + 1);
  v1::ListTemplatesRequest request;
  request.mutable_filter()->set_external_id("100-4711/A");
  ASSERT_OK_AND_ASSIGN(const v1::ListTemplatesResponse page,
                       testing::Call(*stub_, &Stub::ListTemplates, request));
  EXPECT_THAT(NamesOf(page.templates()), ElementsAre("templates/table"));
}

TEST_F(TagsTest, AnImportOfManyThingsLeavesTagsThatItSaysNothingOf) {
  v1::ImportCatalogRequest request;
  request.set_request_id(NewRequestId());
  *request.add_materials() = Wood("ash");
  *request.add_items() = Peg("peg", "materials/ash");
  *request.add_templates() = GetTemplate("templates/table");
  request.mutable_templates(0)->set_name("templates/desk");
  request.mutable_templates(0)->clear_labels();
  v1::ImportCatalogRequest tagged = request;
  Tag(tagged.mutable_materials(0), "W-17");
  Tag(tagged.mutable_items(0));
  Tag(tagged.mutable_templates(0), "T-1");
  ASSERT_OK(testing::Call(*stub_, &Stub::ImportCatalog, tagged));
  request.set_request_id(NewRequestId());
  ASSERT_OK_AND_ASSIGN(const v1::ImportCatalogResponse again,
                       testing::Call(*stub_, &Stub::ImportCatalog, request));
  EXPECT_EQ(again.unchanged_count(), 3);
  EXPECT_THAT(GetItem("items/peg").external_ids(), ElementsAre("100-4711/A"));
  EXPECT_THAT(GetTemplate("templates/desk").external_ids(), ElementsAre("T-1"));
  EXPECT_EQ(GetTemplate("templates/desk").creator(), kDeveloper);
  v1::ListMaterialsRequest materials;
  materials.mutable_filter()->set_external_id("W-17");
  ASSERT_OK_AND_ASSIGN(const v1::ListMaterialsResponse found,
                       testing::Call(*stub_, &Stub::ListMaterials, materials));
  EXPECT_THAT(NamesOf(found.materials()), ElementsAre("materials/ash"));
}

TEST_F(TagsTest, AssembliesAreFoundByWhatTheyAreTaggedWith) {
  const auto assemblies = v1::AssemblyService::NewStub(process_.channel());
  v1::ImportAssemblyRequest import;
  import.set_request_id(NewRequestId());
  v1::Assembly& post = *import.mutable_assembly();
  post.set_name("assemblies/post");
  v1::AssemblyPart& part = *post.add_parts();
  part.set_name("post");
  part.mutable_size()->set_x(0.1);
  part.mutable_size()->set_y(0.1);
  part.mutable_size()->set_z(1);
  v1::ImportAssemblyRequest wrong = import;
  wrong.set_request_id(NewRequestId());
  wrong.mutable_assembly()->mutable_parts(0)->set_item("items/nothing");
  wrong.mutable_assembly()->add_external_ids("");
  EXPECT_THAT(FieldsOf(testing::Call(*assemblies, &AssemblyStub::ImportAssembly, wrong).status()),
              UnorderedElementsAre("assembly.parts[0].item", "assembly.external_ids[0]"));

  Tag(&post);
  ASSERT_OK_AND_ASSIGN(const v1::Assembly imported,
                       testing::Call(*assemblies, &AssemblyStub::ImportAssembly, import));
  EXPECT_EQ(imported.creator(), kDeveloper);
  v1::ListAssembliesRequest list;
  (*list.mutable_filter()->mutable_labels())["site"] = "Hamburg";
  ASSERT_OK_AND_ASSIGN(const v1::ListAssembliesResponse page,
                       testing::Call(*assemblies, &AssemblyStub::ListAssemblies, list));
  EXPECT_THAT(NamesOf(page.assemblies()), ElementsAre("assemblies/post"));
  EXPECT_THAT(page.assemblies(0).external_ids(), ElementsAre("100-4711/A"));

  v1::ImportAssemblyStepRequest step;
  step.set_request_id(NewRequestId());
  step.set_step("ISO-10303-21;");
  step.mutable_annotations()->set_name("assemblies/drawn");
  step.mutable_annotations()->add_external_ids("");
  EXPECT_THAT(
      FieldsOf(testing::Call(*assemblies, &AssemblyStub::ImportAssemblyStep, step).status()),
      UnorderedElementsAre("step", "annotations.external_ids[0]"));
}

// What a catalog wrote before resources said who created them.
TEST(TagsOfOldStores, AreNoneAndTheTimeIsThatOfTheRecord) {
  const testing::TemporaryFolder folder;
  const absl::Time written = absl::FromUnixSeconds(1'700'000'000);
  {
    ASSERT_OK_AND_ASSIGN(const auto store,
                         store::OpenStore({.url = "sqlite:" + (folder.path() / "store.db").string(),
                                           .blob_folder = folder.path() / "blobs",
                                           .service = "catalog",
                                           .clock = [written] { return written; }}));
    ASSERT_OK(store->Transact([](store::Transaction& transaction) -> absl::Status {
      MORTISE_RETURN_IF_ERROR(
          transaction.Put("materials", "ash", Wood("ash").SerializeAsString()).status());
      return transaction.Put("items", "peg", Peg("peg", "materials/ash").SerializeAsString())
          .status();
    }));
  }
  testing::ServiceUnderTest process("mortise-catalog", {}, {}, folder.path());
  const auto stub = v1::CatalogService::NewStub(process.channel());
  v1::GetItemRequest asked;
  asked.set_name("items/peg");
  ASSERT_OK_AND_ASSIGN(const v1::Item peg, testing::Call(*stub, &Stub::GetItem, asked));
  EXPECT_EQ(peg.creator(), "");
  EXPECT_EQ(peg.create_time().seconds(), absl::ToUnixSeconds(written));
  v1::ListMaterialsRequest materials;
  materials.mutable_filter()->mutable_created_before()->set_seconds(absl::ToUnixSeconds(written) +
                                                                    1);
  ASSERT_OK_AND_ASSIGN(const v1::ListMaterialsResponse page,
                       testing::Call(*stub, &Stub::ListMaterials, materials));
  EXPECT_THAT(NamesOf(page.materials()), ElementsAre("materials/ash"));

  v1::UpdateItemRequest update;
  update.set_request_id("tag");
  *update.mutable_item() = peg;
  Tag(update.mutable_item());
  ASSERT_OK_AND_ASSIGN(const v1::Item tagged, testing::Call(*stub, &Stub::UpdateItem, update));
  EXPECT_EQ(tagged.revision(), 2);
  EXPECT_EQ(tagged.creator(), "") << "nobody knows who created it";
  EXPECT_EQ(tagged.create_time().seconds(), absl::ToUnixSeconds(written));
}

}  // namespace
}  // namespace mortise::catalog
