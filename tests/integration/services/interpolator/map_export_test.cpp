// What the service gives away of a map: of each structure a tree with which others interpolate.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/integration/services/interpolator/interpolator_service_fixture.h"

namespace mortise::interpolator {
namespace {

class MapExportServiceTest : public InterpolatorServiceTest {
 protected:
  // All parts of an export, put together; `status` is how it ended.
  v1::MapTree Export(const v1::ExportMapRequest& request, grpc::Status& status) {
    grpc::ClientContext context;
    const auto reader = maps_->ExportMap(&context, request);
    v1::MapTree tree;
    v1::MapExportPart part;
    bool more = true;
    while (reader->Read(&part)) {
      EXPECT_TRUE(more);
      EXPECT_TRUE(part.has_tree());
      more = part.tree().more();
      tree.MergeFrom(part.tree());
    }
    status = reader->Finish();
    EXPECT_EQ(more, !status.ok());
    return tree;
  }

  std::string Refusal(const v1::ExportMapRequest& request) {
    grpc::Status status;
    Export(request, status);
    EXPECT_FALSE(status.ok());
    return status.error_message();
  }
};

TEST_F(MapExportServiceTest, HasAllOfAStructure) {
  v1::BuildMapRequest request = Request(60);
  request.mutable_specification()->add_variations()->set_parameter("x");
  request.mutable_specification()->add_variations()->set_parameter("y");
  request.mutable_specification()->add_variations()->set_parameter("ribs");
  const v1::DesignMap map = Built(request);
  ASSERT_GT(map.structures_size(), 1);
  for (int s = 0; s < map.structures_size(); ++s) {
    v1::ExportMapRequest asked;
    asked.set_name(map.name());
    asked.set_structure(s);
    asked.add_metrics("stress");
    grpc::Status status;
    const v1::MapTree tree = Export(asked, status);
    ASSERT_TRUE(status.ok()) << status.error_message();
    EXPECT_EQ(tree.dimension(), 2);
    EXPECT_EQ(tree.cut_off_size(), map.structures(s).elements());
    EXPECT_EQ(tree.errors_size(), map.structures(s).elements());
    ASSERT_EQ(tree.values_size(), map.structures(s).samples());
    ASSERT_EQ(tree.positions_size(), 2 * tree.values_size());
    // Samples are where the map takes the value that it has of them.
    for (int i = 0; i < tree.values_size(); ++i) {
      const auto& x = map.parameters(0);
      const auto& y = map.parameters(1);
      const v1::EvaluateMapResponse answer = Evaluate(
          map.name(), {x.minimum() + tree.positions(2 * i) * (x.maximum() - x.minimum()),
                       y.minimum() + tree.positions(2 * i + 1) * (y.maximum() - y.minimum()),
                       map.structures(s).values(0).value()});
      EXPECT_NEAR(answer.values(1), tree.values(i), 1e-9 * std::abs(tree.values(i)));
    }
  }
}

TEST_F(MapExportServiceTest, RefusesWhatThereIsNot) {
  v1::ExportMapRequest request;
  request.set_name(Built(Request(20)).name());
  v1::ExportMapRequest other = request;
  other.set_structure(1);
  EXPECT_NE(Refusal(other).find("structure"), std::string::npos);
  other = request;
  other.add_metrics("beauty");
  EXPECT_NE(Refusal(other).find("beauty"), std::string::npos);
  other = request;
  other.add_fields("stress");
  EXPECT_NE(Refusal(other).find("fields"), std::string::npos);
  other = request;
  other.set_geometry(v1::SURFACE);
  EXPECT_NE(Refusal(other).find("metrics alone"), std::string::npos);
  other = request;
  other.set_name("maps/none");
  EXPECT_NE(Refusal(other).find("maps/none"), std::string::npos);
}

}  // namespace
}  // namespace mortise::interpolator
