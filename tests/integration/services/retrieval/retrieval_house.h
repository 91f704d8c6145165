// mortise-retrieval as a real process, beside a catalog with a few templates.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/retrieval.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/filled_catalog.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::testing {

inline v1::ParameterValue Value(const std::string& name, double value) {
  v1::ParameterValue parameter;
  parameter.set_name(name);
  parameter.set_value(value);
  return parameter;
}

// A collection of a table and a boat.
class SmallCollection {
 public:
  SmallCollection() {
    namespace fs = std::filesystem;
    const fs::path shipped = ShippedCollection();
    for (const char* each : {"materials.textproto", "versions.csv"}) {
      fs::copy(shipped / each, folder_.path() / each);
    }
    for (const char* each : {"items", "shapes", "cage_templates"}) {
      fs::copy(shipped / each, folder_.path() / each, fs::copy_options::recursive);
    }
    fs::create_directories(folder_.path() / "designs");
    fs::copy(shipped / "designs/table", folder_.path() / "designs/table",
             fs::copy_options::recursive);
  }

  std::string path() const { return folder_.path().string(); }

 private:
  TemporaryFolder folder_;
};

// A catalog with that collection, and the service.
class RetrievalHouse {
 public:
  // `flags` of the service, such as how many covers it makes by itself.
  explicit RetrievalHouse(std::vector<std::string> flags = {})
      : service_("mortise-retrieval", With(std::move(flags))) {
    Connect();
  }

  // On what others of their kind have left in these folders.
  RetrievalHouse(const std::filesystem::path& catalog, const std::filesystem::path& service)
      : catalog_("mortise-catalog", {"--collection=" + collection_.path()}, {}, catalog),
        service_("mortise-retrieval", With({}), {}, service) {
    Connect();
  }

  // kill -9, and started again on the same state.
  void KillAndStart() {
    service_.Kill();
    service_.Start();
    Connect();
  }

  ServiceUnderTest& service() { return service_; }
  ServiceUnderTest& catalog_process() { return catalog_; }
  v1::RetrievalService::Stub& retrieval() { return *retrieval_; }
  v1::CatalogService::Stub& catalog() { return *catalog_stub_; }
  const std::shared_ptr<grpc::Channel>& channel() const { return service_.channel(); }

  absl::StatusOr<v1::Operation> StartBuild(const std::string& id, double delta) {
    v1::BuildIndexRequest request;
    request.set_request_id(id);
    request.add_shape_descriptors(v1::D2);
    request.set_delta(delta);
    return StartBuild(request);
  }

  absl::StatusOr<v1::Operation> StartBuild(const v1::BuildIndexRequest& request) {
    return Call(*retrieval_, &v1::RetrievalService::Stub::BuildIndex, request);
  }

  absl::StatusOr<v1::Operation> Await(const std::string& operation) {
    const auto operations = v1::OperationService::NewStub(service_.channel());
    v1::WaitOperationRequest wait;
    wait.set_name(operation);
    wait.set_timeout_seconds(180);
    return Call(*operations, &v1::OperationService::Stub::WaitOperation, wait);
  }

  v1::Operation Build(const std::string& id, double delta) { return End(StartBuild(id, delta)); }

  // The operation once it has succeeded.
  v1::Operation End(const absl::StatusOr<v1::Operation>& started) {
    EXPECT_TRUE(started.ok()) << started.status();
    const auto done = Await(started->name());
    EXPECT_TRUE(done.ok()) << done.status();
    EXPECT_EQ(done->state(), v1::Operation::SUCCEEDED) << done->ShortDebugString();
    return *done;
  }

  absl::StatusOr<v1::SearchShapesResponse> Search(const v1::SearchShapesRequest& request) {
    return Call(*retrieval_, &v1::RetrievalService::Stub::SearchShapes, request);
  }

  absl::StatusOr<v1::ShapeIndex> Index() {
    v1::GetIndexRequest get;
    get.set_name("indexes/d2");
    return Call(*retrieval_, &v1::RetrievalService::Stub::GetIndex, get);
  }

 private:
  std::vector<std::string> With(std::vector<std::string> flags) const {
    flags.push_back("--peer=catalog=" + catalog_.address());
    return flags;
  }

  void Connect() {
    retrieval_ = v1::RetrievalService::NewStub(service_.channel());
    catalog_stub_ = v1::CatalogService::NewStub(catalog_.channel());
  }

  const SmallCollection collection_;
  ServiceUnderTest catalog_{"mortise-catalog", {"--collection=" + collection_.path()}};
  ServiceUnderTest service_;
  std::unique_ptr<v1::RetrievalService::Stub> retrieval_;
  std::unique_ptr<v1::CatalogService::Stub> catalog_stub_;
};

inline constexpr double kCoarse = 0.5;  // the δ of an index that is made quickly

// The state of a house with a coarse index by D2 of its two templates: covering them lasts many
// seconds, copying what came of it does not. Made once in a program of tests.
class BuiltState {
 public:
  // A house that goes on from it.
  static std::unique_ptr<RetrievalHouse> House() {
    static const BuiltState state;
    return std::make_unique<RetrievalHouse>(state.folder_.path() / "catalog",
                                            state.folder_.path() / "service");
  }

 private:
  BuiltState() {
    RetrievalHouse house;
    house.Build("built", kCoarse);
    house.service().Kill();
    house.catalog_process().Kill();
    constexpr auto kAll = std::filesystem::copy_options::recursive;
    std::filesystem::copy(house.catalog_process().folder(), folder_.path() / "catalog", kAll);
    std::filesystem::copy(house.service().folder(), folder_.path() / "service", kAll);
    // Where they were served tells nothing of where the next ones are.
    std::filesystem::remove(folder_.path() / "catalog/address.json");
    std::filesystem::remove(folder_.path() / "service/address.json");
  }

  TemporaryFolder folder_;
};

}  // namespace mortise::testing
