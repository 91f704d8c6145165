// ImportCatalog of a process: all or none, whatever is wrong and whenever it dies.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/field_violations.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/catalog/catalog_service_fixture.h"
#include "tests/integration/services/catalog/imported_catalog.h"
#include "tests/support/file_watch.h"
#include "tests/support/status_assertions.h"

namespace mortise::catalog {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Stub = v1::CatalogService::Stub;
using Change = v1::ImportCatalogResponse::Change;

std::vector<std::string> FieldsOf(const absl::Status& status) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(status)) fields.push_back(violation.field);
  if (fields.empty()) fields.push_back(DetailOf(status).field);
  return fields;
}

class ImportCatalogTest : public CatalogServiceTest {
 protected:
  absl::StatusOr<v1::ImportCatalogResponse> Import(v1::ImportCatalogRequest request) {
    if (request.request_id().empty()) request.set_request_id(NewRequestId());
    return testing::Call(*stub_, &Stub::ImportCatalog, request);
  }

  // A wood, a peg of it, and a table that is joined by that peg.
  v1::ImportCatalogRequest WoodPegAndDesk() {
    v1::ImportCatalogRequest request;
    *request.add_materials() = Wood("ash");
    *request.add_items() = Peg("ash-peg", "materials/ash");
    v1::Template& desk = *request.add_templates();
    desk = GetTemplate("templates/table");
    desk.set_name("templates/desk");
    for (v1::Connection& connection : *desk.mutable_connections()) {
      connection.set_item("items/ash-peg");
    }
    return request;
  }

  bool IsThere(const std::string& name) {
    v1::GetItemRequest item;
    item.set_name(name);
    const absl::StatusOr<v1::Item> found = testing::Call(*stub_, &Stub::GetItem, item);
    EXPECT_TRUE(found.ok() || absl::IsNotFound(found.status())) << found.status();
    return found.ok();
  }

  // What has been told, in order, each as "type subject". Events get their numbers after the calls
  // are answered, so one more thing is made, and its event waited for.
  std::vector<std::string> Told() {
    v1::CreateMaterialRequest marker;
    marker.set_request_id(NewRequestId());
    *marker.mutable_material() = Wood(absl::StrCat("marker-", ++markers_));
    EXPECT_OK(testing::Call(*stub_, &Stub::CreateMaterial, marker));
    const std::string last = "material.created " + marker.material().name();
    grpc::ClientContext context;
    testing::Prepare(context);
    const auto events = v1::EventService::NewStub(process_.channel());
    const auto reader = events->FollowEvents(&context, v1::FollowEventsRequest());
    std::vector<std::string> told;
    v1::Event event;
    while ((told.empty() || told.back() != last) && reader->Read(&event)) {
      told.push_back(event.type() + " " + event.subject());
    }
    EXPECT_THAT(told, Contains(last));
    return told;
  }

 private:
  int markers_ = 0;
};

TEST_F(ImportCatalogTest, BringsInWhatUsesEachOtherAndAgainOnlyWhatDiffers) {
  const v1::ImportCatalogRequest request = WoodPegAndDesk();
  ASSERT_OK_AND_ASSIGN(const v1::ImportCatalogResponse first, Import(request));
  EXPECT_EQ(first.created_count(), 3);
  EXPECT_EQ(first.updated_count() + first.unchanged_count(), 0);
  ASSERT_EQ(first.changes_size(), 3);
  EXPECT_EQ(first.changes(0).name(), "materials/ash");
  EXPECT_EQ(first.changes(1).name(), "items/ash-peg");
  EXPECT_EQ(first.changes(2).name(), "templates/desk");
  for (const Change& change : first.changes()) {
    EXPECT_EQ(change.kind(), Change::CREATED);
    EXPECT_EQ(change.revision(), 1);
  }
  // The template's revision has the peg as the catalog has it.
  v1::GetTemplateBundleRequest asked;
  asked.set_name("templates/desk");
  ASSERT_OK_AND_ASSIGN(const v1::TemplateBundle bundle,
                       testing::Call(*stub_, &Stub::GetTemplateBundle, asked));
  const v1::Item peg = GetItem("items/ash-peg");
  int pegs = 0;
  for (const v1::Item& item : bundle.items()) {
    if (item.name() != peg.name()) continue;
    ++pegs;
    EXPECT_EQ(item.ShortDebugString(), peg.ShortDebugString());
  }
  EXPECT_EQ(pegs, 1);

  ASSERT_OK_AND_ASSIGN(const v1::ImportCatalogResponse again, Import(request));
  EXPECT_EQ(again.unchanged_count(), 3);
  EXPECT_EQ(again.created_count() + again.updated_count(), 0);

  v1::ImportCatalogRequest dearer = request;
  dearer.mutable_items(0)->mutable_price()->set_amount(0.09);
  ASSERT_OK_AND_ASSIGN(const v1::ImportCatalogResponse changed, Import(dearer));
  EXPECT_EQ(changed.unchanged_count(), 1);
  EXPECT_EQ(changed.updated_count(), 2);  // what is made of it takes up what is brought with it
  EXPECT_EQ(changed.changes(1).kind(), Change::UPDATED);
  EXPECT_EQ(changed.changes(1).revision(), 2);
  EXPECT_EQ(GetItem("items/ash-peg", 1).price().amount(), peg.price().amount());
  EXPECT_EQ(GetItem("items/ash-peg").price().amount(), 0.09);
}

TEST_F(ImportCatalogTest, WhatIsSentTwiceIsDoneOnce) {
  v1::ImportCatalogRequest request = WoodPegAndDesk();
  request.set_request_id("once");
  ASSERT_OK_AND_ASSIGN(const v1::ImportCatalogResponse first, Import(request));
  ASSERT_OK_AND_ASSIGN(const v1::ImportCatalogResponse again, Import(request));
  EXPECT_EQ(again.ShortDebugString(), first.ShortDebugString());
  const std::vector<std::string> told = Told();
  for (const char* once : {"material.created materials/ash", "item.created items/ash-peg",
                           "template.imported templates/desk"}) {
    EXPECT_EQ(std::count(told.begin(), told.end(), once), 1) << once;
  }
  EXPECT_THAT(told, Not(Contains(HasSubstr("updated"))));
  request.mutable_items(0)->set_title("Another");
  EXPECT_EQ(DetailOf(Import(request).status()).field, "request_id");
}

TEST_F(ImportCatalogTest, NamesEveryFaultAndStoresNothing) {
  v1::ImportCatalogRequest request;
  *request.add_materials() = Wood("ash");
  *request.add_materials() = Wood("elm");
  request.mutable_materials(1)->set_density(-1);
  *request.add_items() = Peg("sound-peg", "materials/ash");
  *request.add_items() = Peg("free-peg", "materials/ash");
  request.mutable_items(1)->mutable_price()->set_amount(-1);
  *request.add_items() = Peg("sound-peg", "materials/ash");
  *request.add_items() = Peg("airy-peg", "materials/air");
  *request.add_items() = Peg("Peg", "materials/oak");
  *request.add_items() = Peg("shaped-peg", "materials/oak");
  request.mutable_items(5)->set_shape("shapes/" + std::string(64, '0'));
  const std::size_t events = Told().size();
  const absl::Status refused = Import(request).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(FieldsOf(refused),
              ElementsAre("materials[1].density", "items[1].price.amount", "items[2].name",
                          "items[3].material", "items[4].name", "items[5].shape"));
  EXPECT_FALSE(IsThere("items/sound-peg"));
  EXPECT_EQ(Told().size(), events + 1);  // the next marker
}

TEST_F(ImportCatalogTest, NamesFaultsOfTemplatesAndStoresNothing) {
  v1::ImportCatalogRequest request = WoodPegAndDesk();
  *request.add_templates() = request.templates(0);  // the same name
  v1::Template& airy = *request.add_templates();
  airy = request.templates(0);
  airy.set_name("templates/airy");
  airy.mutable_parts(1)->set_item("items/none");
  v1::Template& exposed = *request.add_templates();
  exposed.set_name("templates/exposed");
  exposed.mutable_assembly()->set_assembly("assemblies/none");
  v1::Template& nameless = *request.add_templates();
  nameless = request.templates(0);
  nameless.set_name("desk");
  EXPECT_THAT(FieldsOf(Import(request).status()),
              ElementsAre("templates[1].name", "templates[3].assembly.assembly",
                          "templates[4].name", "templates[2].parts[1].item"));
  EXPECT_FALSE(IsThere("items/ash-peg"));
  // Templates are not judged by what is at fault itself; others are.
  request.mutable_materials(0)->set_strength(0);
  v1::Template& apart = *request.add_templates();
  apart = GetTemplate("templates/table");
  apart.set_name("templates/apart");
  apart.mutable_parts(1)->set_item("items/none");
  EXPECT_THAT(
      FieldsOf(Import(request).status()),
      ElementsAre("materials[0].strength", "templates[1].name", "templates[3].assembly.assembly",
                  "templates[4].name", "templates[5].parts[1].item"));
}

TEST_F(ImportCatalogTest, HasLimits) {
  v1::ImportCatalogRequest request;
  for (int i = 0; i < 10'001; ++i) request.add_materials();
  EXPECT_EQ(DetailOf(Import(request).status()).field, "materials");
  request.mutable_materials()->DeleteSubrange(1, 10'000);
  for (int i = 0; i < 10'000; ++i) request.add_items();
  EXPECT_EQ(DetailOf(Import(request).status()).field, "items");
  request.Clear();
  for (int i = 0; i < 101; ++i) request.add_templates();
  EXPECT_EQ(DetailOf(Import(request).status()).field, "templates");
  request.Clear();
  *request.add_items() = Peg("peg", "materials/oak");
  request.mutable_items(0)->set_title(std::string(5 << 20, 'x'));
  EXPECT_EQ(Import(request).status().code(), absl::StatusCode::kResourceExhausted);
  ASSERT_OK_AND_ASSIGN(const v1::ImportCatalogResponse nothing, Import({}));
  EXPECT_THAT(nothing.changes(), IsEmpty());
}

// 0 where there is no such file.
std::uintmax_t SizeOf(const std::string& file) {
  std::error_code missing;
  const std::uintmax_t size = std::filesystem::file_size(file, missing);
  return missing ? 0 : size;
}

// Killed once its log has grown by so many bytes, which it does while the import is committed. What
// becomes of one that dies earlier: import_catalog_postgresql_test.cpp. Whatever came of it, the
// same request again completes it.
TEST(ImportCatalogFaults, KilledMidwayLeavesAllOrNothing) {
  v1::ImportCatalogRequest request = ManyPegs(3000);
  for (v1::Item& item : *request.mutable_items()) {
    item.set_title(std::string(200, 'x'));
    item.set_supplier(std::string(200, 'y'));
    item.set_supplier_url("https://example.com/" + std::string(400, 'z'));
  }
  for (const std::uintmax_t bytes : {1u, 500'000u, 1'000'000u}) {
    const testing::TemporaryFolder folder;
    const std::string database = (folder.path() / "store.db").string();
    testing::ServiceUnderTest process("mortise-catalog", {}, "sqlite:" + database);
    const auto before = SizeOf(database + "-wal");
    absl::StatusOr<v1::ImportCatalogResponse> answer;
    std::thread client([&] {
      const auto stub = v1::CatalogService::NewStub(process.channel());
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(200));
      v1::ImportCatalogResponse response;
      const grpc::Status status = stub->ImportCatalog(&context, request, &response);
      answer =
          status.ok() ? absl::StatusOr<v1::ImportCatalogResponse>(response) : rpc::FromGrpc(status);
    });
    EXPECT_TRUE(testing::WaitForFiles(
        folder.path(), [&] { return SizeOf(database + "-wal") >= before + bytes; },
        absl::Minutes(2)));
    process.Kill();
    client.join();
    process.Start();
    const auto stub = v1::CatalogService::NewStub(process.channel());
    const std::size_t there = CountItems(*stub);
    EXPECT_TRUE(there == 0 || there == 3000) << there << " after " << bytes << " bytes";
    EXPECT_TRUE(!answer.ok() || there == 3000) << "it was answered, and is gone";
    ASSERT_OK_AND_ASSIGN(const v1::ImportCatalogResponse again,
                         testing::Call(*stub, &Stub::ImportCatalog, request));
    EXPECT_EQ(again.created_count(), 3001);  // the same answer, whenever it was done
    EXPECT_EQ(CountItems(*stub), 3000u);
    for (const Change& change : again.changes()) EXPECT_EQ(change.revision(), 1);
  }
}

}  // namespace
}  // namespace mortise::catalog
