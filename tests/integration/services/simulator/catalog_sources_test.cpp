// What the simulator fetches from the catalog: shapes and templates, once however many ask, and no
// more than is asked for; and what it does about shapes that are missing or damaged.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <atomic>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/shape_codec.h"
#include "common/base/errors.h"
#include "common/bundles/shape_source.h"
#include "common/cad/cylinder.h"
#include "common/cad/stretch/solid_shape.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "services/simulator/worker/template_source.h"
#include "tests/integration/services/simulator/table_catalog.h"
#include "tests/support/status_assertions.h"

namespace mortise::simulator {
namespace {

using bundles::ShapeSource;
using ::testing::HasSubstr;

constexpr std::size_t kThreads = 8;

// Calls `work` on several threads at once, with the number of each.
void OnThreads(const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> ready = 0;
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, i] {
      ++ready;
      while (ready < kThreads) std::this_thread::yield();
      work(i);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

// A catalog with one shape, which may be damaged or missing.
class ShapeCatalog final : public v1::CatalogService::Service {
 public:
  ShapeCatalog() {
    cad::CylinderShape leg;
    leg.name = "leg";
    leg.center = {0.02, 0.02, 0};
    leg.radius_u = leg.radius_v = 0.02;
    leg.height = 0.4;
    shape_ = parametric::ToProto(cad::ShapeOfSolid(cad::MakeCylinder(leg).value(),
                                                   Eigen::Matrix3d::Identity(), {0, 0, 0},
                                                   {0.04, 0.04, 0.4})
                                     .value());
    shape_.set_name(parametric::NameOf(shape_));
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
    channel_ =
        grpc::CreateChannel(absl::StrCat("127.0.0.1:", port), grpc::InsecureChannelCredentials());
  }
  ~ShapeCatalog() override { server_->Shutdown(); }

  grpc::Status DownloadShape(grpc::ServerContext*, const v1::DownloadShapeRequest* request,
                             grpc::ServerWriter<v1::Chunk>* writer) override {
    ++asked;
    if (missing || request->name() != shape_.name()) {
      return {grpc::StatusCode::NOT_FOUND, request->name()};
    }
    std::string bytes = shape_.SerializeAsString();
    if (damaged) bytes[bytes.size() / 2] ^= 1;
    for (std::size_t at = 0; at < bytes.size(); at += 1000) {
      v1::Chunk chunk;
      chunk.set_offset(static_cast<int64_t>(at));
      chunk.set_data(bytes.substr(at, 1000));
      writer->Write(chunk);
    }
    return grpc::Status::OK;
  }

  // As in a bundle.
  google::protobuf::RepeatedPtrField<v1::Shape> Shown() const {
    google::protobuf::RepeatedPtrField<v1::Shape> shapes;
    *shapes.Add() = shape_;
    shapes[0].clear_brep();
    return shapes;
  }

  // A bundle whose shape did not fit into its message.
  v1::TemplateBundle Bundle() const {
    v1::TemplateBundle bundle;
    bundle.add_more_shapes(shape_.name());
    return bundle;
  }

  const v1::Shape& shape() const { return shape_; }
  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }

  std::atomic<int> asked = 0;
  std::atomic<bool> missing = false;
  std::atomic<bool> damaged = false;

 private:
  v1::Shape shape_;
  std::unique_ptr<grpc::Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
};

TEST(ShapeSourceTest, AsksOnceForWhatItKeeps) {
  ShapeCatalog catalog;
  ShapeSource source(catalog.channel(), 1 << 20);
  for (int round = 0; round < 3; ++round) {
    auto shapes = catalog.Shown();
    const absl::Status status = source.AddExact(shapes, {});
    ASSERT_TRUE(status.ok()) << status;
    EXPECT_EQ(shapes[0].brep(), catalog.shape().brep());
  }
  EXPECT_EQ(catalog.asked, 1);
  // What has its surfaces, or none, is not asked for.
  auto shapes = catalog.Shown();
  shapes[0].set_exact(false);
  *shapes.Add() = catalog.shape();
  EXPECT_TRUE(source.AddExact(shapes, {}).ok());
  EXPECT_EQ(catalog.asked, 1);
  // Too large to be kept.
  ShapeSource forgetful(catalog.channel(), 10);
  for (int round = 0; round < 2; ++round) {
    auto again = catalog.Shown();
    EXPECT_TRUE(forgetful.AddExact(again, {}).ok());
  }
  EXPECT_EQ(catalog.asked, 3);
}

TEST(ShapeSourceTest, RefusesWhatIsMissingOrDamaged) {
  ShapeCatalog catalog;
  ShapeSource source(catalog.channel(), 1 << 20);
  auto shapes = catalog.Shown();
  catalog.missing = true;
  EXPECT_EQ(source.AddExact(shapes, {}).code(), absl::StatusCode::kNotFound);
  catalog.missing = false;
  catalog.damaged = true;
  const absl::Status status = source.AddExact(shapes, {});
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(status.message()), HasSubstr(catalog.shape().name()));
  EXPECT_TRUE(shapes[0].brep().empty());
  catalog.damaged = false;
  ShapeSource small(catalog.channel(), 1 << 20, 1500);
  const absl::Status large = small.AddExact(shapes, {});
  EXPECT_EQ(large.code(), absl::StatusCode::kResourceExhausted) << large;
  EXPECT_THAT(std::string(large.message()), HasSubstr(catalog.shape().name()));
  EXPECT_TRUE(source.AddExact(shapes, {}).ok());
}

TEST(ShapeSourceTest, FetchesOnceWhatManyAskFor) {
  ShapeCatalog catalog;
  ShapeSource source(catalog.channel(), 1 << 20);
  OnThreads([&](std::size_t) {
    auto shapes = catalog.Shown();
    EXPECT_OK(source.AddExact(shapes, {}));
    EXPECT_EQ(shapes[0].brep(), catalog.shape().brep());
  });
  EXPECT_EQ(catalog.asked, 1);
}

TEST(ShapeSourceTest, GivesExactSurfacesOnlyWhereTheyAreAskedFor) {
  ShapeCatalog catalog;
  ShapeSource source(catalog.channel(), 1 << 20);
  v1::TemplateBundle shown = catalog.Bundle();
  ASSERT_OK(source.AddMore(shown, {}, {}));
  ASSERT_EQ(shown.shapes_size(), 1);
  EXPECT_EQ(shown.more_shapes_size(), 0);
  EXPECT_EQ(shown.shapes(0).vertices(), catalog.shape().vertices());
  EXPECT_TRUE(shown.shapes(0).exact());
  EXPECT_TRUE(shown.shapes(0).brep().empty());
  v1::TemplateBundle joined = catalog.Bundle();
  ASSERT_OK(source.AddMore(joined, {catalog.shape().name()}, {}));
  EXPECT_EQ(joined.shapes(0).brep(), catalog.shape().brep());
}

TEST(TemplateSourceTest, CompilesOnceForAllWhoAsk) {
  TableCatalog catalog;
  const auto channel = grpc::CreateChannel(catalog.address(), grpc::InsecureChannelCredentials());
  TemplateSource first(channel);
  ASSERT_OK_AND_ASSIGN(const auto table, first.Get("templates/table", 1, {}));
  TemplateSource source(channel);
  const int before = catalog.asked;
  std::vector<std::shared_ptr<const EvaluatedTemplate>> compiled(kThreads);
  OnThreads([&](std::size_t i) {
    const auto found = source.GetByDigest("templates/table", 1, table->digest, {});
    EXPECT_OK(found);
    if (found.ok()) compiled[i] = *found;
  });
  EXPECT_EQ(catalog.asked, before + 1);
  for (const auto& each : compiled) EXPECT_EQ(each, compiled[0]);
  // What has exact surfaces, where there are any, serves those who need none.
  ASSERT_OK_AND_ASSIGN(const auto without, source.Get("templates/table", 1, {}));
  EXPECT_EQ(without, compiled[0]);
}

TEST(TemplateSourceTest, KeepsTheLatestHoweverLittleRoomThereIs) {
  TableCatalog catalog;
  TemplateSource source(grpc::CreateChannel(catalog.address(), grpc::InsecureChannelCredentials()),
                        1);
  ASSERT_OK_AND_ASSIGN(const auto table, source.Get("templates/table", 0, {}));
  ASSERT_OK_AND_ASSIGN(const auto again, source.Get("templates/table", 1, {}));
  EXPECT_EQ(again, table);
  // Asked for by digest, it is compiled once more, and replaces the other.
  ASSERT_OK_AND_ASSIGN(const auto exact,
                       source.GetByDigest("templates/table", 1, table->digest, {}));
  EXPECT_NE(exact, table);
  ASSERT_OK_AND_ASSIGN(const auto latest, source.Get("templates/table", 1, {}));
  EXPECT_EQ(latest, exact);
}

TEST(TemplateSourceTest, FailuresAreNotKept) {
  TableCatalog catalog;
  TemplateSource source(grpc::CreateChannel(catalog.address(), grpc::InsecureChannelCredentials()));
  EXPECT_EQ(source.Get("templates/chair", 0, {}).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(DetailOf(source.GetByDigest("templates/table", 1, "another", {}).status()).reason,
            "TEMPLATE_CHANGED");
  EXPECT_OK(source.Get("templates/table", 0, {}));
}

}  // namespace
}  // namespace mortise::simulator
