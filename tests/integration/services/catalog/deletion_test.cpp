// Templates and assemblies that are deleted: gone by their names, there for whoever has a revision.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/catalog/catalog_service_fixture.h"
#include "tests/integration/services/catalog/imported_catalog.h"
#include "tests/support/status_assertions.h"

namespace mortise::catalog {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using Stub = v1::CatalogService::Stub;
using AssemblyStub = v1::AssemblyService::Stub;

class DeletionTest : public CatalogServiceTest {
 protected:
  absl::Status DeleteTemplate(const std::string& name, int64_t revision) {
    v1::DeleteTemplateRequest request;
    request.set_request_id(NewRequestId());
    request.set_name(name);
    request.set_revision(revision);
    return testing::Call(*stub_, &Stub::DeleteTemplate, request).status();
  }

  absl::Status DeleteAssembly(const std::string& name, int64_t revision) {
    v1::DeleteAssemblyRequest request;
    request.set_request_id(NewRequestId());
    request.set_name(name);
    request.set_revision(revision);
    const auto assemblies = v1::AssemblyService::NewStub(process_.channel());
    return testing::Call(*assemblies, &AssemblyStub::DeleteAssembly, request).status();
  }

  absl::Status DeleteItem(const std::string& name) {
    v1::DeleteItemRequest request;
    request.set_request_id(NewRequestId());
    request.set_name(name);
    request.set_revision(1);
    return testing::Call(*stub_, &Stub::DeleteItem, request).status();
  }

  absl::Status DeleteMaterial(const std::string& name) {
    v1::DeleteMaterialRequest request;
    request.set_request_id(NewRequestId());
    request.set_name(name);
    request.set_revision(1);
    return testing::Call(*stub_, &Stub::DeleteMaterial, request).status();
  }

  absl::StatusOr<v1::Template> Find(const std::string& name, int64_t revision = 0) {
    v1::GetTemplateRequest request;
    request.set_name(name);
    request.set_revision(revision);
    return testing::Call(*stub_, &Stub::GetTemplate, request);
  }

  absl::StatusOr<v1::EvaluatedDesign> Evaluate(const std::string& name, int64_t revision) {
    v1::EvaluateTemplateRequest request;
    request.set_name(name);
    request.set_revision(revision);
    return testing::Call(*stub_, &Stub::EvaluateTemplate, request);
  }

  std::vector<std::string> Templates() {
    v1::ListTemplatesRequest request;
    request.set_page_size(1000);
    std::vector<std::string> names;
    const auto page = testing::Call(*stub_, &Stub::ListTemplates, request);
    EXPECT_OK(page);
    for (const v1::Template& message : page->templates()) names.push_back(message.name());
    return names;
  }

  // templates/desk, with a peg and a wood of its own.
  void ImportDesk() {
    v1::ImportCatalogRequest request;
    request.set_request_id(NewRequestId());
    *request.add_materials() = Wood("ash");
    *request.add_items() = Peg("ash-peg", "materials/ash");
    v1::Template& desk = *request.add_templates();
    desk = GetTemplate("templates/table");
    desk.set_name("templates/desk");
    for (v1::Connection& connection : *desk.mutable_connections()) {
      connection.set_item("items/ash-peg");
    }
    ASSERT_OK(testing::Call(*stub_, &Stub::ImportCatalog, request));
  }
};

TEST_F(DeletionTest, WhatWasMadeOfATemplateOutlivesIt) {
  ImportDesk();
  ASSERT_OK_AND_ASSIGN(const v1::EvaluatedDesign before, Evaluate("templates/desk", 1));
  const absl::Status stale = DeleteTemplate("templates/desk", 7);
  EXPECT_EQ(stale.code(), absl::StatusCode::kAborted) << stale;
  EXPECT_EQ(DetailOf(stale).reason, "STALE_REVISION");
  EXPECT_EQ(DetailOf(DeleteItem("items/ash-peg")).reason, "ITEM_IN_USE");

  ASSERT_OK(DeleteTemplate("templates/desk", 1));
  EXPECT_TRUE(absl::IsNotFound(Find("templates/desk").status()));
  EXPECT_THAT(Templates(), Not(Contains("templates/desk")));
  EXPECT_TRUE(absl::IsNotFound(Evaluate("templates/desk", 0).status()));
  EXPECT_TRUE(absl::IsNotFound(DeleteTemplate("templates/desk", 1)));
  // What it used may go now, and what was planned of it is as it was.
  ASSERT_OK(DeleteItem("items/ash-peg"));
  ASSERT_OK(DeleteMaterial("materials/ash"));
  process_.Kill();  // so that nothing is remembered
  process_.Start();
  Connect();
  ASSERT_OK_AND_ASSIGN(const v1::EvaluatedDesign after, Evaluate("templates/desk", 1));
  EXPECT_EQ(after.ShortDebugString(), before.ShortDebugString());
  v1::GetTemplateBundleRequest bundle;
  bundle.set_name("templates/desk");
  bundle.set_revision(1);
  EXPECT_OK(testing::Call(*stub_, &Stub::GetTemplateBundle, bundle));
  // Revision 2 is its absence.
  EXPECT_TRUE(absl::IsNotFound(Find("templates/desk", 2).status()));
}

TEST_F(DeletionTest, ANameThatIsTakenAgainDoesNotRepeatRevisions) {
  v1::Template desk = GetTemplate("templates/table");
  desk.set_name("templates/desk");
  v1::Template imported;
  ASSERT_TRUE(Call(&Stub::ImportTemplate, ImportRequest(desk, 0), &imported).ok());
  ASSERT_OK(DeleteTemplate("templates/desk", 1));
  desk.set_title("Another");
  EXPECT_EQ(Fail(&Stub::ImportTemplate, ImportRequest(desk, 1)).code, absl::StatusCode::kAborted);
  ASSERT_TRUE(Call(&Stub::ImportTemplate, ImportRequest(desk, 0), &imported).ok());
  EXPECT_EQ(imported.revision(), 3);
  EXPECT_EQ(GetTemplate("templates/desk").title(), "Another");
  EXPECT_EQ(GetTemplate("templates/desk", 1).title(), "Table");
  EXPECT_THAT(Templates(), Contains("templates/desk"));
  ASSERT_OK(DeleteTemplate("templates/desk", 3));
  EXPECT_TRUE(absl::IsNotFound(Find("templates/desk").status()));
}

TEST_F(DeletionTest, AnAssemblyGoesAfterTheTemplatesThatExposeIt) {
  const absl::Status used = DeleteAssembly("assemblies/planter", 1);
  EXPECT_EQ(used.code(), absl::StatusCode::kFailedPrecondition) << used;
  EXPECT_EQ(DetailOf(used).reason, "ASSEMBLY_IN_USE");
  EXPECT_THAT(std::string(used.message()), HasSubstr("templates/planter"));
  EXPECT_EQ(DeleteAssembly("assemblies/planter", 9).code(), absl::StatusCode::kAborted);
  ASSERT_OK_AND_ASSIGN(const v1::EvaluatedDesign before, Evaluate("templates/planter", 1));
  v1::Template exposing = GetTemplate("templates/planter");

  ASSERT_OK(DeleteTemplate("templates/planter", 1));
  ASSERT_OK(DeleteAssembly("assemblies/planter", 1));
  EXPECT_TRUE(absl::IsNotFound(DeleteAssembly("assemblies/planter", 1)));
  const auto assemblies = v1::AssemblyService::NewStub(process_.channel());
  v1::GetAssemblyRequest get;
  get.set_name("assemblies/planter");
  EXPECT_TRUE(
      absl::IsNotFound(testing::Call(*assemblies, &AssemblyStub::GetAssembly, get).status()));
  get.set_revision(1);
  ASSERT_OK_AND_ASSIGN(v1::Assembly planter,
                       testing::Call(*assemblies, &AssemblyStub::GetAssembly, get));
  v1::ParametrizeAssemblyRequest parametrize;
  parametrize.set_name("assemblies/planter");
  parametrize.set_revision(1);
  EXPECT_OK(testing::Call(*assemblies, &AssemblyStub::ParametrizeAssembly, parametrize));
  ASSERT_OK_AND_ASSIGN(const v1::EvaluatedDesign after, Evaluate("templates/planter", 1));
  EXPECT_EQ(after.ShortDebugString(), before.ShortDebugString());

  // It cannot be exposed any more, until it is there again.
  exposing.mutable_assembly()->set_revision(1);
  EXPECT_EQ(Fail(&Stub::ImportTemplate, ImportRequest(exposing, 0)).field,
            "template.assembly.assembly");
  v1::ImportAssemblyRequest import;
  import.set_request_id(NewRequestId());
  *import.mutable_assembly() = planter;
  ASSERT_OK_AND_ASSIGN(planter, testing::Call(*assemblies, &AssemblyStub::ImportAssembly, import));
  EXPECT_EQ(planter.revision(), 3);
}

TEST_F(DeletionTest, StaysDeletedWhenTheCatalogStartsAgain) {
  const std::size_t before = Templates().size();
  ASSERT_OK(DeleteTemplate("templates/table", 1));
  ASSERT_OK(DeleteTemplate("templates/planter", 1));
  ASSERT_OK(DeleteAssembly("assemblies/planter", 1));
  process_.Kill();
  process_.Start();
  Connect();
  EXPECT_EQ(Templates().size(), before - 2);
  EXPECT_TRUE(absl::IsNotFound(Find("templates/planter").status()));
}

TEST_F(DeletionTest, IsDoneOnceAndTold) {
  v1::DeleteTemplateRequest request;
  request.set_request_id("once");
  request.set_name("templates/table");
  request.set_revision(1);
  ASSERT_OK(testing::Call(*stub_, &Stub::DeleteTemplate, request));
  ASSERT_OK(testing::Call(*stub_, &Stub::DeleteTemplate, request));
  ASSERT_OK(DeleteTemplate("templates/planter", 1));
  ASSERT_OK(DeleteAssembly("assemblies/planter", 1));
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto events = v1::EventService::NewStub(process_.channel());
  const auto reader = events->FollowEvents(&context, v1::FollowEventsRequest());
  std::multiset<std::string> told;
  v1::Event event;
  while (told.count("assembly.deleted assemblies/planter") == 0 && reader->Read(&event)) {
    told.insert(event.type() + " " + event.subject());
  }
  EXPECT_EQ(told.count("template.deleted templates/table"), 1u);
  EXPECT_EQ(told.count("template.deleted templates/planter"), 1u);
}

}  // namespace
}  // namespace mortise::catalog
