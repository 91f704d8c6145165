// mortise-composer as a real process, beside a catalog with a few assemblies.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/composer.grpc.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/filled_catalog.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::testing {

// A collection of a bookshelf and a dining table.
class FurnitureCollection {
 public:
  FurnitureCollection() {
    namespace fs = std::filesystem;
    const fs::path shipped = ShippedCollection();
    for (const char* each : {"materials.textproto", "versions.csv"}) {
      fs::copy(shipped / each, folder_.path() / each);
    }
    for (const char* each : {"items", "shapes"}) {
      fs::copy(shipped / each, folder_.path() / each, fs::copy_options::recursive);
    }
    fs::create_directories(folder_.path() / "assemblies");
    for (const char* each : {"bookshelf.textproto", "dining_table.textproto"}) {
      fs::copy(shipped / "assemblies" / each, folder_.path() / "assemblies" / each);
    }
  }

  std::string path() const { return folder_.path().string(); }

 private:
  TemporaryFolder folder_;
};

// A catalog with that collection, and the composer.
class ComposerHouse {
 public:
  ComposerHouse() { Connect(); }

  // kill -9, and started again on the same state.
  void KillAndStart() {
    composer_.Kill();
    composer_.Start();
    Connect();
  }

  ServiceUnderTest& catalog_process() { return catalog_; }
  const std::string& composer_address() const { return composer_.address(); }
  v1::ComposerService::Stub& composer() { return *stub_; }
  v1::CatalogService::Stub& catalog() { return *catalog_stub_; }
  v1::AssemblyService::Stub& assemblies() { return *assemblies_; }

  // Begins a model; "models/{id}".
  v1::Model New(const std::string& id) {
    v1::CreateModelRequest request;
    request.set_request_id("new-" + id);
    request.set_model_id(id);
    const auto made = Call(*stub_, &v1::ComposerService::Stub::CreateModel, request);
    EXPECT_TRUE(made.ok()) << made.status();
    return made.value_or(v1::Model());
  }

  absl::StatusOr<v1::Model> Get(const std::string& name) {
    v1::GetModelRequest request;
    request.set_name(name);
    return Call(*stub_, &v1::ComposerService::Stub::GetModel, request);
  }

  // Makes a change of the model that was seen.
  template <typename Request>
  absl::StatusOr<v1::Model> Change(grpc::Status (v1::ComposerService::Stub::*method)(
                                       grpc::ClientContext*, const Request&, v1::Model*),
                                   const v1::Model& seen, Request request = {}) {
    request.set_request_id(absl::StrCat("change-", ++changes_));
    request.set_name(seen.name());
    request.set_revision(seen.revision());
    return Call(*stub_, method, request);
  }

  // Adds a node of a template, where it is drawn, moved by nothing.
  absl::StatusOr<v1::Model> Add(const v1::Model& seen, const std::string& template_id,
                                const std::string& group, const std::string& id) {
    v1::AddComponentRequest request;
    request.set_template_("templates/" + template_id);
    request.set_group(group);
    request.set_component_id(id);
    return Change(&v1::ComposerService::Stub::AddComponent, seen, request);
  }

  absl::StatusOr<v1::Model> Snap(const v1::Model& seen, const std::string& component) {
    v1::SnapComponentRequest request;
    request.set_component(component);
    return Change(&v1::ComposerService::Stub::SnapComponent, seen, request);
  }

  absl::StatusOr<v1::Model> Connect(const v1::Model& seen, const std::string& component) {
    v1::ConnectComponentRequest request;
    request.set_component(component);
    return Change(&v1::ComposerService::Stub::ConnectComponent, seen, request);
  }

  absl::StatusOr<v1::Model> Drag(const v1::Model& seen, const std::string& node,
                                 const std::string& control, double value) {
    v1::DragControlRequest request;
    request.set_node(node);
    request.set_control(control);
    request.set_value(value);
    return Change(&v1::ComposerService::Stub::DragControl, seen, request);
  }

  // Turns a component by quarter turns about an axis.
  absl::StatusOr<v1::Model> Turn(const v1::Model& seen, const std::string& component, v1::Axis axis,
                                 int times = 1) {
    v1::TurnComponentRequest request;
    request.set_component(component);
    for (int i = 0; i < times; ++i) request.add_turns(axis);
    return Change(&v1::ComposerService::Stub::TurnComponent, seen, request);
  }

  absl::StatusOr<v1::Model> Remove(const v1::Model& seen, const std::string& node) {
    v1::RemoveNodeRequest request;
    request.set_node(node);
    return Change(&v1::ComposerService::Stub::RemoveNode, seen, request);
  }

  absl::StatusOr<v1::Model> Undo(const v1::Model& seen) {
    return Change<v1::UndoModelRequest>(&v1::ComposerService::Stub::UndoModel, seen);
  }

  absl::StatusOr<v1::Model> Redo(const v1::Model& seen) {
    return Change<v1::RedoModelRequest>(&v1::ComposerService::Stub::RedoModel, seen);
  }

  absl::StatusOr<v1::SavedModel> Save(const v1::Model& seen, const std::string& template_id) {
    v1::SaveModelRequest request;
    request.set_request_id(absl::StrCat("save-", ++changes_));
    request.set_name(seen.name());
    request.set_revision(seen.revision());
    request.set_template_id(template_id);
    return Call(*stub_, &v1::ComposerService::Stub::SaveModel, request);
  }

 private:
  void Connect() {
    stub_ = v1::ComposerService::NewStub(composer_.channel());
    catalog_stub_ = v1::CatalogService::NewStub(catalog_.channel());
    assemblies_ = v1::AssemblyService::NewStub(catalog_.channel());
  }

  const FurnitureCollection collection_;
  ServiceUnderTest catalog_{"mortise-catalog", {"--collection=" + collection_.path()}};
  ServiceUnderTest composer_{"mortise-composer", {"--peer=catalog=" + catalog_.address()}};
  std::unique_ptr<v1::ComposerService::Stub> stub_;
  std::unique_ptr<v1::CatalogService::Stub> catalog_stub_;
  std::unique_ptr<v1::AssemblyService::Stub> assemblies_;
  int changes_ = 0;
};

// Plans the fabrication of a template of the house, by a planner of its own.
inline absl::StatusOr<v1::Plan> PlanOf(ComposerHouse& house, const std::string& template_name) {
  ServiceUnderTest planner("mortise-fabplanner",
                           {"--peer=catalog=" + house.catalog_process().address()});
  const auto fabplanner = v1::FabPlannerService::NewStub(planner.channel());
  v1::CreatePlanRequest request;
  request.set_request_id("plan");
  request.set_template_(template_name);
  const auto started = Call(*fabplanner, &v1::FabPlannerService::Stub::CreatePlan, request);
  if (!started.ok()) return started.status();
  const auto operations = v1::OperationService::NewStub(planner.channel());
  v1::WaitOperationRequest wait;
  wait.set_name(started->name());
  wait.set_timeout_seconds(120);
  const auto done = Call(*operations, &v1::OperationService::Stub::WaitOperation, wait);
  if (!done.ok()) return done.status();
  v1::Plan plan;
  if (!done->result().UnpackTo(&plan)) return absl::InternalError(done->ShortDebugString());
  return plan;
}

// The component of an id; an empty one where there is none.
inline v1::ModelComponent ComponentOf(const v1::Model& model, const std::string& id) {
  for (const v1::ModelComponent& component : model.components()) {
    if (component.id() == id) return component;
  }
  return {};
}

}  // namespace mortise::testing
