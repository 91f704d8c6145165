// Parts of designs that are things by themselves are found as such: mortise-retrieval as a real
// process, beside a catalog with one assembly that has sub-trees.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/retrieval.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/filled_catalog.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::retrieval {
namespace {

using testing::Call;

constexpr char kChest[] = "templates/chest";
constexpr double kDelta = 0.15;  // of the index

// A frame of three boards and a drawer of two that stands in it: only the lengths of boards are
// free, so that it is covered in seconds.
constexpr char kDrawn[] = R"(
  name: "assemblies/chest"
  title: "Chest"
  groups { name: "frame" }
  groups { name: "drawer" }
  parts {
    name: "frame side" item: "items/board-19x89" group: "frame" length_axis: Z thickness_axis: X
    position {} size { z: 0.6 }
    repeat { count: 2 offset { x: 0.519 } }
  }
  parts {
    name: "frame shelf" item: "items/board-19x89" group: "frame"
    position { x: 0.019 z: 0.3 } size { x: 0.5 }
  }
  parts {
    name: "drawer bottom" item: "items/board-19x89" group: "drawer"
    position { x: 0.069 z: 0.319 } size { x: 0.4 }
  }
  parts {
    name: "drawer front" item: "items/board-19x89" group: "drawer" thickness_axis: Y
    position { x: 0.069 z: 0.338 } size { x: 0.4 }
  })";

// A collection of it alone.
class ChestCollection {
 public:
  ChestCollection() {
    namespace fs = std::filesystem;
    const fs::path shipped = testing::ShippedCollection();
    fs::copy(shipped / "materials.textproto", folder_.path() / "materials.textproto");
    for (const char* each : {"items", "shapes"}) {
      fs::copy(shipped / each, folder_.path() / each, fs::copy_options::recursive);
    }
    EXPECT_TRUE(WriteFile(folder_.path() / "assemblies/chest.textproto", kDrawn).ok());
  }

  std::string path() const { return folder_.path().string(); }

 private:
  testing::TemporaryFolder folder_;
};

// The index of the chest and its sub-trees, which searches share.
class SubTreesTest : public ::testing::Test {
 protected:
  struct House {
    ChestCollection collection;
    testing::ServiceUnderTest catalog{"mortise-catalog", {"--collection=" + collection.path()}};
    testing::ServiceUnderTest service{"mortise-retrieval", {"--peer=catalog=" + catalog.address()}};
  };

  static void SetUpTestSuite() {
    house_ = std::make_unique<House>();
    v1::BuildIndexRequest request;
    request.set_request_id("sub-trees");
    request.add_shape_descriptors(v1::VOXEL);
    request.set_delta(kDelta);
    const auto retrieval = v1::RetrievalService::NewStub(house_->service.channel());
    const auto started = Call(*retrieval, &v1::RetrievalService::Stub::BuildIndex, request);
    ASSERT_TRUE(started.ok()) << started.status();
    const auto operations = v1::OperationService::NewStub(house_->service.channel());
    v1::WaitOperationRequest wait;
    wait.set_name(started->name());
    wait.set_timeout_seconds(600);
    const auto done = Call(*operations, &v1::OperationService::Stub::WaitOperation, wait);
    ASSERT_TRUE(done.ok()) << done.status();
    ASSERT_EQ(done->state(), v1::Operation::SUCCEEDED) << done->ShortDebugString();
  }
  static void TearDownTestSuite() { house_.reset(); }

  static absl::StatusOr<v1::ShapeIndex> Index() {
    const auto retrieval = v1::RetrievalService::NewStub(house_->service.channel());
    v1::GetIndexRequest get;
    get.set_name("indexes/voxel");
    return Call(*retrieval, &v1::RetrievalService::Stub::GetIndex, get);
  }

  // What is found for the parts of the chest whose names begin so.
  static absl::StatusOr<v1::SearchShapesResponse> SearchForParts(const std::string& beginning) {
    const auto catalog = v1::CatalogService::NewStub(house_->catalog.channel());
    v1::EvaluateTemplateRequest evaluate;
    evaluate.set_name(kChest);
    evaluate.set_without_triangles(true);
    const auto design = Call(*catalog, &v1::CatalogService::Stub::EvaluateTemplate, evaluate);
    if (!design.ok()) return design.status();
    v1::SearchShapesRequest request;
    request.set_shape_descriptor(v1::VOXEL);
    request.mutable_design()->set_template_(kChest);
    for (const auto& part : design->parts()) {
      if (part.name().starts_with(beginning)) request.mutable_design()->add_parts(part.name());
    }
    const auto retrieval = v1::RetrievalService::NewStub(house_->service.channel());
    return Call(*retrieval, &v1::RetrievalService::Stub::SearchShapes, request);
  }

  static std::unique_ptr<House> house_;
};

std::unique_ptr<SubTreesTest::House> SubTreesTest::house_;

TEST_F(SubTreesTest, AreFamiliesBesideTheWhole) {
  const auto index = Index();
  ASSERT_TRUE(index.ok()) << index.status();
  std::set<std::string> groups;
  for (const v1::ShapeIndex::Family& family : index->families()) {
    EXPECT_EQ(family.template_(), kChest);
    EXPECT_EQ(family.fault(), "") << family.group();
    EXPECT_EQ(family.failed_evaluations(), 0) << family.group();
    EXPECT_TRUE(groups.insert(family.group()).second);
  }
  EXPECT_TRUE(groups.contains(""));
  EXPECT_TRUE(groups.contains("drawer"));
  EXPECT_EQ(index->family_count(), index->families_size());
}

TEST_F(SubTreesTest, AreFoundByWhatTheyLookLike) {
  const auto found = SearchForParts("drawer");
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_GT(found->matches_size(), 1);
  const v1::ShapeMatch& nearest = found->matches(0);
  EXPECT_EQ(nearest.template_(), kChest);
  EXPECT_EQ(nearest.group(), "drawer");
  EXPECT_LT(nearest.distance(), found->matches(1).distance());
  EXPECT_GT(nearest.parameters_size(), 0);
}

TEST_F(SubTreesTest, AreFoundTheSameEachTime) {
  const auto first = SearchForParts("drawer");
  ASSERT_TRUE(first.ok()) << first.status();
  for (int time = 0; time < 10; ++time) {
    const auto again = SearchForParts("drawer");
    ASSERT_TRUE(again.ok()) << again.status();
    ASSERT_EQ(again->matches_size(), first->matches_size());
    for (int i = 0; i < first->matches_size(); ++i) {
      EXPECT_EQ(again->matches(i).ShortDebugString(), first->matches(i).ShortDebugString());
    }
  }
}

TEST_F(SubTreesTest, AreAskedForByTheirGroups) {
  const auto index = Index();
  ASSERT_TRUE(index.ok()) << index.status();
  v1::SearchShapesRequest request;
  request.set_shape_descriptor(v1::VOXEL);
  request.mutable_design()->set_template_(index->families(0).template_());
  request.mutable_design()->add_parts("drawer");
  const auto retrieval = v1::RetrievalService::NewStub(house_->service.channel());
  const auto found = Call(*retrieval, &v1::RetrievalService::Stub::SearchShapes, request);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->matches(0).group(), "drawer");
  request.mutable_design()->set_parts(0, "drawers");
  const absl::Status refused =
      Call(*retrieval, &v1::RetrievalService::Stub::SearchShapes, request).status();
  EXPECT_EQ(DetailOf(refused).field, "design.parts") << refused;
  EXPECT_THAT(refused.message(), ::testing::HasSubstr("did you mean 'drawer'?"));
}

TEST_F(SubTreesTest, DoNotStandForTheWhole) {
  const auto found = SearchForParts("");
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->matches(0).group(), "");
  EXPECT_LE(found->matches(0).distance(), kDelta);
}

}  // namespace
}  // namespace mortise::retrieval
