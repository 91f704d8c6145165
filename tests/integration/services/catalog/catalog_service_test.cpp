// The catalog as a process: what it ships, what it keeps, what it refuses, and what it tells.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/cad/step_reader.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::catalog {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

std::filesystem::path ShippedCollection() {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::path(source == nullptr ? "." : source) / "collection";
}

// What a failed call says: code, reason and field.
struct Failure {
  absl::StatusCode code;
  std::string reason;
  std::string field;
  std::string message;
};

class CatalogServiceTest : public ::testing::Test {
 protected:
  CatalogServiceTest() { Connect(); }

  void Connect() { stub_ = v1::CatalogService::NewStub(process_.channel()); }

  template <typename Request, typename Response>
  grpc::Status Call(grpc::Status (v1::CatalogService::Stub::*method)(grpc::ClientContext*,
                                                                     const Request&, Response*),
                    const Request& request, Response* response) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
    context.set_wait_for_ready(true);
    return ((*stub_).*method)(&context, request, response);
  }

  template <typename Request, typename Response>
  Failure Fail(grpc::Status (v1::CatalogService::Stub::*method)(grpc::ClientContext*,
                                                                const Request&, Response*),
               const Request& request) {
    Response response;
    const absl::Status status = rpc::FromGrpc(Call(method, request, &response));
    EXPECT_FALSE(status.ok());
    return {status.code(), DetailOf(status).reason, DetailOf(status).field,
            std::string(status.message())};
  }

  v1::Item GetItem(const std::string& name, int64_t revision = 0) {
    v1::GetItemRequest request;
    request.set_name(name);
    request.set_revision(revision);
    v1::Item item;
    const grpc::Status status = Call(&v1::CatalogService::Stub::GetItem, request, &item);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return item;
  }

  v1::Template GetTemplate(const std::string& name, int64_t revision = 0) {
    v1::GetTemplateRequest request;
    request.set_name(name);
    request.set_revision(revision);
    v1::Template message;
    const grpc::Status status = Call(&v1::CatalogService::Stub::GetTemplate, request, &message);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return message;
  }

  static std::string NewRequestId() {
    static int count = 0;
    return "request-" + std::to_string(++count);
  }

  v1::ImportTemplateRequest ImportRequest(const v1::Template& message, int64_t expected) {
    v1::ImportTemplateRequest request;
    request.set_request_id(NewRequestId());
    *request.mutable_template_() = message;
    request.set_expected_revision(expected);
    return request;
  }

  absl::StatusOr<std::string> Export(const v1::ExportDesignRequest& request,
                                     v1::Chunk* first = nullptr) {
    grpc::ClientContext context;
    auto reader = stub_->ExportDesign(&context, request);
    std::string bytes, sha256;
    v1::Chunk chunk;
    while (reader->Read(&chunk)) {
      EXPECT_EQ(chunk.offset(), static_cast<int64_t>(bytes.size()));
      if (chunk.offset() == 0) {
        sha256 = chunk.sha256();
        if (first != nullptr) *first = chunk;
      }
      bytes += chunk.data();
    }
    const absl::Status status = rpc::FromGrpc(reader->Finish());
    if (!status.ok()) return status;
    EXPECT_EQ(Sha256Hex(bytes), sha256);
    return bytes;
  }

  testing::ServiceUnderTest process_{"mortise-catalog",
                                     {"--collection=" + ShippedCollection().string()}};
  std::unique_ptr<v1::CatalogService::Stub> stub_;
};

TEST_F(CatalogServiceTest, ShipsACollection) {
  v1::ListTemplatesRequest request;
  v1::ListTemplatesResponse response;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::ListTemplates, request, &response).ok());
  ASSERT_GE(response.templates_size(), 1);
  const v1::Template table = GetTemplate("templates/table");
  EXPECT_EQ(table.revision(), 1);
  EXPECT_EQ(table.digest().size(), 64u);
  EXPECT_GT(table.create_time().seconds(), 0);
  EXPECT_EQ(table.parts_size(), 9);
  for (const v1::Template& listed : response.templates()) EXPECT_EQ(listed.parts_size(), 0);

  v1::GetTemplateBundleRequest bundle_request;
  bundle_request.set_name("templates/table");
  v1::TemplateBundle bundle;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::GetTemplateBundle, bundle_request, &bundle).ok());
  EXPECT_EQ(bundle.items_size(), 3);
  EXPECT_EQ(bundle.materials_size(), 3);
  EXPECT_EQ(bundle.template_().digest(), table.digest());

  v1::GetMaterialRequest material_request;
  material_request.set_name("materials/spruce");
  v1::Material spruce;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::GetMaterial, material_request, &spruce).ok());
  EXPECT_EQ(spruce.density(), 420);
}

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

TEST_F(CatalogServiceTest, EvaluatesTheTable) {
  v1::EvaluateTemplateRequest request;
  request.set_name("templates/table");
  auto* length = request.add_parameters();
  length->set_name("length");
  length->set_value(1.6004);  // a workshop sets millimetres
  v1::EvaluatedDesign design;
  const grpc::Status status = Call(&v1::CatalogService::Stub::EvaluateTemplate, request, &design);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(design.parts_size(), 9);
  EXPECT_EQ(design.template_revision(), 1);
  ASSERT_EQ(design.parameters_size(), 6);
  EXPECT_NEAR(design.parameters(0).value(), 1.6, 1e-12);
  EXPECT_NEAR(design.parts(8).size().x(), 1.6, 1e-12);
  EXPECT_GT(design.connectors_size(), 30);
  EXPECT_EQ(design.boundary_conditions_size(), 5);
}

TEST_F(CatalogServiceTest, ExportsStepAndGlb) {
  v1::ExportDesignRequest request;
  request.set_name("templates/table");
  request.set_format(v1::ExportDesignRequest::STEP);
  v1::Chunk first;
  const auto step = Export(request, &first);
  ASSERT_TRUE(step.ok()) << step.status();
  EXPECT_EQ(first.file_name(), "table.step");
  const auto assembly = cad::ReadStep(*step);
  ASSERT_TRUE(assembly.ok()) << assembly.status();
  ASSERT_EQ(assembly->parts.size(), 9u);
  EXPECT_EQ(assembly->parts[8].name, "top");

  request.set_format(v1::ExportDesignRequest::GLB);
  const auto glb = Export(request, &first);
  ASSERT_TRUE(glb.ok()) << glb.status();
  EXPECT_EQ(glb->substr(0, 4), "glTF");
  EXPECT_EQ(first.media_type(), "model/gltf-binary");
}

TEST_F(CatalogServiceTest, TemplatesOfEveryKindAreListedAndEvaluated) {
  v1::ListTemplatesRequest list;
  list.set_page_size(100);
  v1::ListTemplatesResponse listed;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::ListTemplates, list, &listed).ok());
  std::map<v1::Template::KindCase, int> kinds;
  for (const v1::Template& message : listed.templates()) {
    ++kinds[message.kind_case()];
    EXPECT_FALSE(message.title().empty()) << message.name();
    EXPECT_GE(message.parameters_size(), 1) << message.name();
  }
  EXPECT_GE(kinds[v1::Template::KIND_NOT_SET], 1);
  EXPECT_GE(kinds[v1::Template::kAssembly], 14);
  EXPECT_GE(kinds[v1::Template::kCad], 9);
  EXPECT_GE(kinds[v1::Template::kCage], 1);

  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name("templates/wrench");
  auto* length = evaluate.add_parameters();
  length->set_name("handle_length");
  length->set_value(0.2);
  v1::EvaluatedDesign wrench;
  grpc::Status status = Call(&v1::CatalogService::Stub::EvaluateTemplate, evaluate, &wrench);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(wrench.parts_size(), 1);
  EXPECT_EQ(wrench.parts(0).material(), "materials/steel");
  EXPECT_GT(wrench.parts(0).faceted().triangles_size(), 300);
  EXPECT_GT(wrench.mass(), 0.05);

  v1::EvaluatedDesign shelf;
  evaluate.Clear();
  evaluate.set_name("templates/bookshelf");
  status = Call(&v1::CatalogService::Stub::EvaluateTemplate, evaluate, &shelf);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_GT(shelf.parts_size(), 10);
  EXPECT_GT(shelf.mass(), 1);
}

TEST_F(CatalogServiceTest, ExportsASolidOfFeaturesExactly) {
  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name("templates/wrench");
  v1::EvaluatedDesign wrench;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::EvaluateTemplate, evaluate, &wrench).ok());
  v1::ExportDesignRequest request;
  request.set_name("templates/wrench");
  request.set_format(v1::ExportDesignRequest::STEP);
  v1::Chunk first;
  const auto step = Export(request, &first);
  ASSERT_TRUE(step.ok()) << step.status();
  const auto read = cad::ReadStep(*step);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->parts.size(), 1u);
  EXPECT_NEAR(read->parts[0].volume / wrench.parts(0).volume(), 1, 1e-6);
  request.set_format(v1::ExportDesignRequest::GLB);
  EXPECT_TRUE(Export(request, &first).ok());
}

TEST_F(CatalogServiceTest, ImportsTemplatesOfEveryKindOrSaysWhyNot) {
  using Stub = v1::CatalogService::Stub;
  v1::Template wrench = GetTemplate("templates/wrench");
  wrench.set_name("templates/spanner");
  wrench.mutable_cad()->clear_name();
  wrench.mutable_cad()->mutable_definitions(0)->set_value("0.017");
  v1::Template spanner;
  ASSERT_TRUE(Call(&Stub::ImportTemplate, ImportRequest(wrench, 0), &spanner).ok());
  EXPECT_EQ(spanner.cad().name(), "templates/spanner");
  EXPECT_NE(spanner.digest(), GetTemplate("templates/wrench").digest());
  wrench.set_name("templates/broken");
  wrench.mutable_cad()->mutable_features(0)->set_name("");
  wrench.mutable_cad()->mutable_definitions(0)->set_value("1 / 0");
  const Failure broken = Fail(&Stub::ImportTemplate, ImportRequest(wrench, 0));
  EXPECT_EQ(broken.code, absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(broken.message, HasSubstr("template.cad.features[0].name"));

  v1::Template shelf;
  shelf.set_name("templates/narrow-shelf");
  shelf.mutable_assembly()->set_assembly("assemblies/bookshelf");
  v1::Template stored;
  ASSERT_TRUE(Call(&Stub::ImportTemplate, ImportRequest(shelf, 0), &stored).ok());
  EXPECT_EQ(stored.assembly().revision(), 1);
  EXPECT_EQ(stored.assembly().handles_size(), stored.parameters_size());
  // What the service filled in may be sent back; it is the same content then.
  v1::Template again;
  ASSERT_TRUE(Call(&Stub::ImportTemplate, ImportRequest(stored, 1), &again).ok());
  EXPECT_EQ(again.revision(), 1);
  shelf.mutable_assembly()->set_assembly("assemblies/none");
  EXPECT_EQ(Fail(&Stub::ImportTemplate, ImportRequest(shelf, 1)).field,
            "template.assembly.assembly");
  shelf.mutable_assembly()->set_assembly("assemblies/bookshelf");
  shelf.mutable_assembly()->set_revision(7);
  EXPECT_EQ(Fail(&Stub::ImportTemplate, ImportRequest(shelf, 1)).field,
            "template.assembly.revision");
}

TEST_F(CatalogServiceTest, KeepsRevisionsAsTheyWere) {
  v1::Template table = GetTemplate("templates/table");
  table.mutable_parameters(0)->set_maximum(1.9);
  v1::Template second;
  const auto request = ImportRequest(table, 1);
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::ImportTemplate, request, &second).ok());
  EXPECT_EQ(second.revision(), 2);
  EXPECT_NE(second.digest(), table.digest());

  // The same request again gets the same answer; another one on the old revision is refused.
  v1::Template repeated;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::ImportTemplate, request, &repeated).ok());
  EXPECT_EQ(repeated.revision(), 2);
  table.mutable_parameters(0)->set_maximum(1.8);
  const Failure stale = Fail(&v1::CatalogService::Stub::ImportTemplate, ImportRequest(table, 1));
  EXPECT_EQ(stale.code, absl::StatusCode::kAborted);
  EXPECT_EQ(stale.reason, "STALE_REVISION");

  // Importing what is there already changes nothing.
  v1::Template same;
  ASSERT_TRUE(
      Call(&v1::CatalogService::Stub::ImportTemplate, ImportRequest(second, 2), &same).ok());
  EXPECT_EQ(same.revision(), 2);

  EXPECT_EQ(GetTemplate("templates/table", 1).parameters(0).maximum(), 2.0);
  EXPECT_EQ(GetTemplate("templates/table").parameters(0).maximum(), 1.9);

  // A change of a material's item is not seen by revisions that exist.
  v1::UpdateItemRequest update;
  update.set_request_id(NewRequestId());
  *update.mutable_item() = GetItem("items/panel-spruce");
  update.mutable_item()->set_material("materials/beech");
  update.mutable_update_mask()->add_paths("material");
  v1::Item changed;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::UpdateItem, update, &changed).ok());
  EXPECT_EQ(changed.revision(), 2);
  EXPECT_EQ(changed.title(), update.item().title());
  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name("templates/table");
  v1::EvaluatedDesign before, after;
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::EvaluateTemplate, evaluate, &before).ok());
  v1::Template third;
  ASSERT_TRUE(
      Call(&v1::CatalogService::Stub::ImportTemplate, ImportRequest(second, 2), &third).ok());
  EXPECT_EQ(third.revision(), 3);
  ASSERT_TRUE(Call(&v1::CatalogService::Stub::EvaluateTemplate, evaluate, &after).ok());
  EXPECT_GT(after.mass(), before.mass());
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

TEST_F(CatalogServiceTest, RefusesBadReads) {
  using Stub = v1::CatalogService::Stub;
  v1::GetMaterialRequest material;
  material.set_name("cheese");
  EXPECT_EQ(Fail(&Stub::GetMaterial, material).field, "name");
  v1::GetItemRequest item;
  item.set_name("items/unobtainium");
  EXPECT_EQ(Fail(&Stub::GetItem, item).code, absl::StatusCode::kNotFound);
  item.set_name("items/../../etc/passwd");
  EXPECT_EQ(Fail(&Stub::GetItem, item).field, "name");
  v1::ListMaterialsRequest materials;
  materials.set_page_size(-1);
  EXPECT_EQ(Fail(&Stub::ListMaterials, materials).field, "page_size");
  v1::ListItemsRequest items;
  items.set_page_size(1001);
  EXPECT_EQ(Fail(&Stub::ListItems, items).field, "page_size");
  items.set_page_size(1);
  items.set_page_token("'; drop table");
  EXPECT_EQ(Fail(&Stub::ListItems, items).field, "page_token");
  items.Clear();
  items.set_kind(static_cast<v1::ItemKind>(99));
  EXPECT_EQ(Fail(&Stub::ListItems, items).field, "kind");
  items.Clear();
  for (const char* unknown :
       {"materials/unobtainium", "oak", "items/screw-4x40", "materials/../x"}) {
    items.set_material(unknown);
    const Failure failure = Fail(&Stub::ListItems, items);
    EXPECT_EQ(failure.code, absl::StatusCode::kInvalidArgument) << unknown;
    EXPECT_EQ(failure.field, "material") << unknown;
  }
  items.Clear();
  items.set_text(std::string(201, 'x'));
  EXPECT_EQ(Fail(&Stub::ListItems, items).field, "text");
  item.set_name("items/screw-4x40");
  item.set_revision(-1);
  EXPECT_EQ(Fail(&Stub::GetItem, item).field, "revision");
  item.set_revision(2);
  EXPECT_EQ(Fail(&Stub::GetItem, item).code, absl::StatusCode::kNotFound);
  v1::ListTemplatesRequest templates;
  templates.set_page_token("NOT A TOKEN");
  EXPECT_EQ(Fail(&Stub::ListTemplates, templates).field, "page_token");
  v1::GetTemplateRequest revision;
  revision.set_name("templates/table");
  revision.set_revision(-1);
  EXPECT_EQ(Fail(&Stub::GetTemplate, revision).field, "revision");
  revision.set_revision(99);
  EXPECT_EQ(Fail(&Stub::GetTemplate, revision).code, absl::StatusCode::kNotFound);
  v1::GetTemplateBundleRequest bundle;
  bundle.set_name("");
  EXPECT_EQ(Fail(&Stub::GetTemplateBundle, bundle).field, "name");
}

TEST_F(CatalogServiceTest, RefusesBadParameters) {
  using Stub = v1::CatalogService::Stub;
  const auto evaluate = [&](const std::string& name, double value) {
    v1::EvaluateTemplateRequest request;
    request.set_name("templates/table");
    request.add_parameters()->set_name(name);
    request.mutable_parameters(0)->set_value(value);
    const Failure failure = Fail(&Stub::EvaluateTemplate, request);
    EXPECT_EQ(failure.code, absl::StatusCode::kInvalidArgument);
    return failure.field;
  };
  EXPECT_EQ(evaluate("depth", 1), "parameters[0].name");
  EXPECT_EQ(evaluate("length", -1), "parameters[0].value");
  EXPECT_EQ(evaluate("length", NAN), "parameters[0].value");
  EXPECT_EQ(evaluate("length", std::numeric_limits<double>::infinity()), "parameters[0].value");

  v1::ExportDesignRequest request;
  request.set_name("templates/table");
  EXPECT_EQ(DetailOf(Export(request).status()).field, "format");
  request.set_format(static_cast<v1::ExportDesignRequest::Format>(9));
  EXPECT_EQ(DetailOf(Export(request).status()).field, "format");
  request.set_format(v1::ExportDesignRequest::GLB);
  request.set_name("templates/none");
  EXPECT_EQ(Export(request).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(CatalogServiceTest, RefusesBadItemsAndMaterials) {
  using Stub = v1::CatalogService::Stub;
  const v1::Item dowel = GetItem("items/dowel-8x35");
  const auto create = [&](const std::function<void(v1::Item&)>& spoil) {
    v1::CreateItemRequest request;
    request.set_request_id(NewRequestId());
    *request.mutable_item() = dowel;
    request.mutable_item()->set_name("items/new-dowel");
    spoil(*request.mutable_item());
    return Fail(&Stub::CreateItem, request);
  };
  EXPECT_EQ(create([](v1::Item& item) { item.set_name("items/dowel-8x35"); }).code,
            absl::StatusCode::kAlreadyExists);
  EXPECT_EQ(create([](v1::Item& item) { item.set_name("Dowel"); }).field, "item.name");
  EXPECT_EQ(create([](v1::Item& item) { item.set_material("materials/air"); }).field,
            "item.material");
  EXPECT_EQ(create([](v1::Item& item) { item.mutable_dimensions(0)->set_size(-0.035); }).field,
            "item.dimensions[X].size");
  EXPECT_EQ(create([](v1::Item& item) { item.mutable_dimensions(0)->set_size(NAN); }).field,
            "item.dimensions[0].size");
  EXPECT_EQ(create([](v1::Item& item) { item.mutable_dimensions()->RemoveLast(); }).field,
            "item.dimensions");
  EXPECT_EQ(create([](v1::Item& item) { item.set_kind(v1::ITEM_KIND_UNSPECIFIED); }).field,
            "item.kind");
  EXPECT_EQ(create([](v1::Item& item) { item.set_title(std::string(5000, 'x')); }).field,
            "item.title");
  EXPECT_EQ(create([](v1::Item& item) { item.add_measures()->set_size(-1); }).field,
            "item.measures[0].size");
  EXPECT_EQ(create([](v1::Item& item) { item.add_stock_sizes()->set_length(1); }).field,
            "item.stock_sizes");
  EXPECT_EQ(create([](v1::Item& item) { item.add_more_suppliers()->set_url("file:x"); }).field,
            "item.more_suppliers[0].url");
  v1::CreateItemRequest without_id;
  *without_id.mutable_item() = dowel;
  EXPECT_EQ(Fail(&Stub::CreateItem, without_id).field, "request_id");
  v1::CreateItemRequest huge;
  huge.set_request_id(NewRequestId());
  *huge.mutable_item() = dowel;
  huge.mutable_item()->set_title(std::string(5 << 20, 'x'));
  EXPECT_EQ(Fail(&Stub::CreateItem, huge).code, absl::StatusCode::kResourceExhausted);

  v1::UpdateItemRequest update;
  update.set_request_id(NewRequestId());
  *update.mutable_item() = dowel;
  update.mutable_item()->set_revision(5);
  EXPECT_EQ(Fail(&Stub::UpdateItem, update).code, absl::StatusCode::kAborted);
  update.mutable_item()->set_revision(1);
  update.mutable_update_mask()->add_paths("colour");
  EXPECT_EQ(Fail(&Stub::UpdateItem, update).field, "update_mask");
  update.mutable_update_mask()->set_paths(0, "name");
  EXPECT_EQ(Fail(&Stub::UpdateItem, update).field, "update_mask");
  update.clear_update_mask();
  update.mutable_item()->mutable_price()->set_amount(-1);
  EXPECT_EQ(Fail(&Stub::UpdateItem, update).field, "item.price.amount");
  EXPECT_EQ(GetItem("items/dowel-8x35").revision(), 1);

  v1::CreateMaterialRequest material;
  material.set_request_id(NewRequestId());
  material.mutable_material()->set_name("materials/glass");
  material.mutable_material()->set_density(2500);
  const Failure unfinished = Fail(&Stub::CreateMaterial, material);
  EXPECT_EQ(unfinished.field, "material.youngs_modulus");
  EXPECT_THAT(unfinished.message, HasSubstr("strength"));  // all findings at once
  v1::GetMaterialRequest spruce;
  spruce.set_name("materials/spruce");
  ASSERT_TRUE(Call(&Stub::GetMaterial, spruce, material.mutable_material()).ok());
  material.mutable_material()->set_name("materials/perpetual");
  material.mutable_material()->mutable_orthotropic()->set_poissons_ratio_lr(4);
  EXPECT_EQ(Fail(&Stub::CreateMaterial, material).field, "material.orthotropic.poissons_ratio_lr");
}

TEST_F(CatalogServiceTest, RefusesBadTemplatesAndSaysAllThatIsWrong) {
  using Stub = v1::CatalogService::Stub;
  const v1::Template table = GetTemplate("templates/table");
  const auto import = [&](const std::function<void(v1::Template&)>& spoil) {
    v1::Template spoilt = table;
    spoilt.set_name("templates/spoilt");
    spoil(spoilt);
    const Failure failure = Fail(&Stub::ImportTemplate, ImportRequest(spoilt, 0));
    EXPECT_EQ(failure.code, absl::StatusCode::kInvalidArgument) << failure.message;
    return failure;
  };
  EXPECT_EQ(import([](v1::Template& t) { t.set_name("spoilt"); }).field, "template.name");
  EXPECT_EQ(import([](v1::Template& t) { t.clear_parts(); }).field, "template.parts");
  EXPECT_EQ(import([](v1::Template& t) { t.mutable_parameters(0)->set_minimum(NAN); }).field,
            "template.parameters[0].minimum");
  EXPECT_EQ(import([](v1::Template& t) {
              t.mutable_parts(0)->set_length_axis(static_cast<v1::Axis>(12));
            }).field,
            "template.parts[0].length_axis");
  EXPECT_EQ(import([](v1::Template& t) { t.mutable_parts(1)->set_item("items/none"); }).field,
            "template.parts[1].item");
  const Failure several = import([](v1::Template& t) {
    t.mutable_parameters(2)->set_maximum(0);
    t.mutable_parts(0)->mutable_box()->mutable_x()->set_from("length +");
    t.mutable_connections(3)->set_face("nose");
  });
  EXPECT_EQ(several.field, "template.parameters[2].maximum");
  EXPECT_THAT(several.message, HasSubstr("3 findings"));
  EXPECT_THAT(several.message, HasSubstr("parts[0].box.x.from"));
  EXPECT_THAT(several.message, HasSubstr("connections[3].face"));
  v1::GetTemplateRequest request;
  request.set_name("templates/spoilt");
  EXPECT_EQ(Fail(&Stub::GetTemplate, request).code, absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace mortise::catalog
