// The catalog as a process: the items and materials it keeps, what it survives, and what it tells.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/catalog/catalog_service_fixture.h"

namespace mortise::catalog {
namespace {

using ::testing::HasSubstr;

TEST_F(CatalogServiceTest, PagesThroughItems) {
  std::set<std::string> names;
  v1::ListItemsRequest request;
  request.set_page_size(20);
  v1::ListItemsResponse response;
  int pages = 0;
  do {
    ASSERT_TRUE(Call(&v1::CatalogService::Stub::ListItems, request, &response).ok());
    for (const v1::Item& item : response.items()) EXPECT_TRUE(names.insert(item.name()).second);
    request.set_page_token(response.next_page_token());
    ASSERT_LT(++pages, 100);
  } while (!response.next_page_token().empty());
  EXPECT_GE(names.size(), 150u);
}

// Each filter leaves out some items, all together leave what meets each, on every page.
TEST_F(CatalogServiceTest, FiltersItems) {
  const auto list = [this](v1::ListItemsRequest request) {
    std::vector<v1::Item> items;
    request.set_page_size(3);
    v1::ListItemsResponse response;
    do {
      EXPECT_TRUE(Call(&v1::CatalogService::Stub::ListItems, request, &response).ok());
      EXPECT_LE(response.items_size(), 3);
      items.insert(items.end(), response.items().begin(), response.items().end());
      request.set_page_token(response.next_page_token());
    } while (!response.next_page_token().empty());
    return items;
  };
  v1::ListItemsRequest dowels;
  dowels.set_kind(v1::DOWEL);
  const auto all_dowels = list(dowels);
  EXPECT_GE(all_dowels.size(), 10u);
  for (const v1::Item& item : all_dowels) EXPECT_EQ(item.kind(), v1::DOWEL);

  v1::ListItemsRequest oak;
  oak.set_material("materials/oak");
  const auto all_oak = list(oak);
  EXPECT_GE(all_oak.size(), 2u);
  for (const v1::Item& item : all_oak) EXPECT_EQ(item.material(), "materials/oak");

  v1::ListItemsRequest nuts;
  nuts.set_text("iso 4032 M8");
  const auto found = list(nuts);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].name(), "items/hex-nut-m8");
  nuts.set_kind(v1::NUT);
  EXPECT_EQ(list(nuts).size(), 1u);
  nuts.set_kind(v1::BOLT);
  EXPECT_TRUE(list(nuts).empty());
  nuts.set_text("items");  // of the collection of all names, not of any id
  EXPECT_TRUE(list(nuts).empty());
}

TEST_F(CatalogServiceTest, FiltersMaterials) {
  const auto list = [this](v1::ListMaterialsRequest request) {
    std::vector<v1::Material> materials;
    request.set_page_size(2);
    v1::ListMaterialsResponse response;
    do {
      EXPECT_TRUE(Call(&v1::CatalogService::Stub::ListMaterials, request, &response).ok());
      materials.insert(materials.end(), response.materials().begin(), response.materials().end());
      request.set_page_token(response.next_page_token());
    } while (!response.next_page_token().empty());
    return materials;
  };
  v1::ListMaterialsRequest request;
  const std::size_t all = list(request).size();
  request.set_elasticity(v1::ListMaterialsRequest::ORTHOTROPIC);
  const auto woods = list(request);
  for (const v1::Material& wood : woods) EXPECT_TRUE(wood.has_orthotropic()) << wood.name();
  request.set_elasticity(v1::ListMaterialsRequest::ISOTROPIC);
  const auto others = list(request);
  for (const v1::Material& other : others) EXPECT_FALSE(other.has_orthotropic()) << other.name();
  EXPECT_GE(woods.size(), 2u);
  EXPECT_GE(others.size(), 2u);
  EXPECT_EQ(woods.size() + others.size(), all);
  request.set_text("STEEL");
  for (const v1::Material& steel : list(request)) {
    EXPECT_THAT(steel.name(), HasSubstr("steel"));
  }
  EXPECT_FALSE(list(request).empty());
  request.set_elasticity(v1::ListMaterialsRequest::ORTHOTROPIC);
  EXPECT_TRUE(list(request).empty());
}

TEST_F(CatalogServiceTest, FiltersTemplates) {
  const auto list = [this](v1::ListTemplatesRequest request) {
    std::set<std::string> names;
    request.set_page_size(3);
    v1::ListTemplatesResponse response;
    do {
      EXPECT_TRUE(Call(&v1::CatalogService::Stub::ListTemplates, request, &response).ok());
      for (const v1::Template& message : response.templates()) names.insert(message.name());
      request.set_page_token(response.next_page_token());
    } while (!response.next_page_token().empty());
    return names;
  };
  using Request = v1::ListTemplatesRequest;
  const std::size_t all = list(Request()).size();
  std::size_t of_kinds = 0;
  for (const auto& [kind, one] : {std::pair(Request::PARTS, "templates/table"),
                                  {Request::ASSEMBLY, "templates/planter"},
                                  {Request::CAD, "templates/wrench"},
                                  {Request::CAGE, "templates/boat"}}) {
    Request request;
    request.set_kind(kind);
    const auto names = list(request);
    EXPECT_EQ(names.count(one), 1u) << one;
    of_kinds += names.size();
  }
  EXPECT_EQ(of_kinds, all);
  // What has the item, whether a part is made of it or two are joined by it.
  Request pegged;
  pegged.set_item("items/dowel-8x35");
  const auto users = list(pegged);
  EXPECT_EQ(users.count("templates/table"), 1u);
  EXPECT_EQ(users.count("templates/wrench"), 0u);
  EXPECT_LT(users.size(), all);
  pegged.set_kind(Request::CAD);
  EXPECT_TRUE(list(pegged).empty());
  Request worded;
  worded.set_text("WRENCH open-ended");
  EXPECT_EQ(list(worded), std::set<std::string>{"templates/wrench"});
}

TEST_F(CatalogServiceTest, KeepsRevisionsOfItems) {
  v1::UpdateItemRequest update;
  update.set_request_id(NewRequestId());
  *update.mutable_item() = GetItem("items/hex-nut-m8");
  update.mutable_item()->mutable_price()->set_amount(0.07);
  v1::Item updated;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::UpdateItem, update, &updated).ok());
  EXPECT_EQ(GetItem("items/hex-nut-m8").price().amount(), 0.07);
  EXPECT_EQ(GetItem("items/hex-nut-m8", 2).price().amount(), 0.07);
  const v1::Item first = GetItem("items/hex-nut-m8", 1);
  EXPECT_EQ(first.price().amount(), 0.05);
  EXPECT_EQ(first.revision(), 1);
}

TEST_F(CatalogServiceTest, SurvivesKill) {
  v1::CreateItemRequest create;
  create.set_request_id(NewRequestId());
  *create.mutable_item() = GetItem("items/dowel-8x35");
  create.mutable_item()->set_name("items/dowel-8x35-oak");
  create.mutable_item()->set_material("materials/oak");
  v1::Item created;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::CreateItem, create, &created).ok());
  EXPECT_EQ(created.revision(), 1);
  process_.Kill();
  process_.Start();
  Connect();
  EXPECT_EQ(GetItem("items/dowel-8x35-oak").material(), "materials/oak");
  EXPECT_EQ(GetTemplate("templates/table").revision(), 1);  // not loaded a second time
}

TEST_F(CatalogServiceTest, TellsWhatHappened) {
  v1::Template table = GetTemplate("templates/table");
  table.set_name("templates/desk");
  v1::Template desk;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::ImportTemplate, ImportRequest(table, 0), &desk).ok());
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
  const auto events = v1::EventService::NewStub(process_.channel());
  const auto reader = events->FollowEvents(&context, v1::FollowEventsRequest());
  std::multiset<std::string> types;
  v1::Event event;
  while (types.count("template.imported") < 2 && reader->Read(&event)) types.insert(event.type());
  EXPECT_EQ(types.count("template.imported"), 2u);
  EXPECT_GE(types.count("item.created"), 20u);
  EXPECT_GE(types.count("material.created"), 5u);
}

TEST_F(CatalogServiceTest, DeletesOnlyWhatNobodyUses) {
  v1::DeleteItemRequest request;
  request.set_request_id(NewRequestId());
  request.set_name("items/panel-spruce");
  request.set_revision(1);
  const Failure used = Fail(&v1::CatalogService::Stub::DeleteItem, request);
  EXPECT_EQ(used.code, absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(used.reason, "ITEM_IN_USE");
  EXPECT_THAT(used.message, HasSubstr("templates/table"));

  v1::CreateItemRequest create;
  create.set_request_id(NewRequestId());
  *create.mutable_item() = GetItem("items/hex-nut-m8");
  create.mutable_item()->set_name("items/nobodys-nut");
  v1::Item created;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::CreateItem, create, &created).ok());
  request.set_request_id(NewRequestId());
  request.set_name(created.name());
  request.set_revision(7);
  EXPECT_EQ(Fail(&v1::CatalogService::Stub::DeleteItem, request).code, absl::StatusCode::kAborted);
  request.set_request_id(NewRequestId());
  request.set_revision(1);
  v1::DeleteItemResponse response;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::DeleteItem, request, &response).ok());
  v1::GetItemRequest gone;
  gone.set_name(created.name());
  EXPECT_EQ(Fail(&v1::CatalogService::Stub::GetItem, gone).code, absl::StatusCode::kNotFound);
}

TEST_F(CatalogServiceTest, MaterialsHaveRevisionsAndGoWhenNothingIsMadeOfThem) {
  using Stub = v1::CatalogService::Stub;
  v1::GetMaterialRequest get;
  get.set_name("materials/spruce");
  v1::Material spruce;
  ASSERT_TRUE(Call(&Stub::GetMaterial, get, &spruce).ok());
  v1::GetTemplateBundleRequest bundle_request;
  bundle_request.set_name("templates/table");
  v1::TemplateBundle before;
  ASSERT_TRUE(Call(&Stub::GetTemplateBundle, bundle_request, &before).ok());

  v1::UpdateMaterialRequest update;
  update.set_request_id(NewRequestId());
  *update.mutable_material() = spruce;
  update.mutable_material()->set_density(450);
  update.mutable_material()->set_title("not in the mask");
  update.mutable_update_mask()->add_paths("density");
  v1::Material changed;
  ASSERT_TRUE(Call(&Stub::UpdateMaterial, update, &changed).ok());
  EXPECT_EQ(changed.revision(), 2);
  EXPECT_EQ(changed.density(), 450);
  EXPECT_EQ(changed.title(), spruce.title());
  get.set_revision(1);
  ASSERT_TRUE(Call(&Stub::GetMaterial, get, &changed).ok());
  EXPECT_EQ(changed.density(), 420);
  v1::TemplateBundle after;
  ASSERT_TRUE(Call(&Stub::GetTemplateBundle, bundle_request, &after).ok());
  EXPECT_EQ(after.SerializeAsString(), before.SerializeAsString()) << "designs do not change";

  update.set_request_id(NewRequestId());
  EXPECT_EQ(Fail(&Stub::UpdateMaterial, update).code, absl::StatusCode::kAborted);
  update.mutable_material()->set_revision(2);
  update.mutable_material()->set_density(-1);
  EXPECT_EQ(Fail(&Stub::UpdateMaterial, update).field, "material.density");
  update.mutable_update_mask()->set_paths(0, "name");
  EXPECT_EQ(Fail(&Stub::UpdateMaterial, update).field, "update_mask");

  v1::DeleteMaterialRequest remove;
  remove.set_request_id(NewRequestId());
  remove.set_name("materials/spruce");
  remove.set_revision(2);
  const Failure used = Fail(&Stub::DeleteMaterial, remove);
  EXPECT_EQ(used.reason, "MATERIAL_IN_USE");
  EXPECT_THAT(used.message, HasSubstr("items/"));
  v1::CreateMaterialRequest create;
  create.set_request_id(NewRequestId());
  *create.mutable_material() = spruce;
  create.mutable_material()->set_name("materials/nothings");
  ASSERT_TRUE(Call(&Stub::CreateMaterial, create, &changed).ok());
  EXPECT_EQ(changed.revision(), 1);
  remove.set_name("materials/nothings");
  EXPECT_EQ(Fail(&Stub::DeleteMaterial, remove).code, absl::StatusCode::kAborted);
  remove.set_revision(1);
  v1::DeleteMaterialResponse removed;
  ASSERT_TRUE(Call(&Stub::DeleteMaterial, remove, &removed).ok());
  get.set_name("materials/nothings");
  get.set_revision(0);
  EXPECT_EQ(Fail(&Stub::GetMaterial, get).code, absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace mortise::catalog
