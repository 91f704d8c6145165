// What is streamed of a map with shapes: whole, in order, and the same as the map answers with.
#include "services/interpolator/service/map_stream.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "services/interpolator/service/map_shape.h"
#include "tests/unit/services/interpolator/service/stored_bars.h"

namespace mortise::interpolator {
namespace {

using testing::StoredBars;

// All that is streamed, put together.
struct Streamed {
  v1::MapTree tree;
  std::vector<v1::MapMesh> meshes;
  std::vector<v1::MapExportPart::Sample> samples;
};

ShapeDemand Demand(StoredBars& bars, v1::GeometryKind geometry) {
  v1::EvaluateMapShapeRequest request;
  request.set_geometry(geometry);
  return ReadShapeDemand(bars.map()->record, request).value();
}

ShapeDemand MetricAlone() {
  ShapeDemand demand;
  demand.geometry = v1::GEOMETRY_KIND_UNSPECIFIED;
  demand.metrics = {0};
  return demand;
}

absl::StatusOr<Streamed> Stream(StoredBars& bars, ShapeDemand demand) {
  MapStream stream(bars.map(), &bars.shapes(), 0, std::move(demand));
  Streamed streamed;
  int stage = 0;
  while (true) {
    const auto part = stream.Next();
    if (!part.ok()) return part.status();
    if (!part->has_value()) return streamed;
    const v1::MapExportPart& message = **part;
    // Trees come before meshes, and these before samples.
    EXPECT_GE(static_cast<int>(message.part_case()), stage);
    stage = message.part_case();
    if (message.has_tree()) streamed.tree.MergeFrom(message.tree());
    if (message.has_mesh()) streamed.meshes.push_back(message.mesh());
    if (message.has_sample()) streamed.samples.push_back(message.sample());
  }
}

v1::MapShape Answered(StoredBars& bars, double x, double y, v1::GeometryKind geometry) {
  v1::EvaluateMapShapeRequest request;
  request.set_name("maps/bars");
  request.add_point(x);
  request.add_point(y);
  request.set_geometry(geometry);
  return EvaluateShape(*bars.map(), bars.shapes(), request).value();
}

class MapStreamShapesTest : public ::testing::TestWithParam<v1::GeometryKind> {};

TEST_P(MapStreamShapesTest, HasShapesAsTheMapAnswersWithThem) {
  StoredBars bars;
  const ShapeDemand demand = Demand(bars, GetParam());
  const auto streamed = Stream(bars, demand);
  ASSERT_TRUE(streamed.ok()) << streamed.status();
  EXPECT_EQ(streamed->tree.meshes_size(), 1);
  EXPECT_EQ(streamed->tree.shape_errors(0), 0.125);
  EXPECT_EQ(streamed->tree.field_errors_size(), static_cast<int>(demand.fields.size()));
  EXPECT_EQ(streamed->tree.field_errors(0), 2e4);
  ASSERT_EQ(streamed->samples.size(), 4u);
  ASSERT_EQ(streamed->meshes.size(), 1u);
  for (const v1::MapExportPart::Sample& sample : streamed->samples) {
    const double x = streamed->tree.positions(2 * sample.sample());
    const double y = 10 + 2 * streamed->tree.positions(2 * sample.sample() + 1);
    const v1::MapShape shape = Answered(bars, x, y, GetParam());
    EXPECT_EQ(streamed->meshes[0].SerializeAsString(), shape.new_mesh().SerializeAsString());
    EXPECT_EQ(sample.positions(), shape.positions());
    ASSERT_EQ(sample.fields_size(), shape.fields_size());
    for (int f = 0; f < shape.fields_size(); ++f) {
      EXPECT_EQ(sample.fields(f).name(), shape.fields(f).name());
      EXPECT_EQ(sample.fields(f).load_case(), shape.fields(f).load_case());
      EXPECT_EQ(sample.fields(f).values(), shape.fields(f).values());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Geometry, MapStreamShapesTest,
                         ::testing::Values(v1::SURFACE, v1::TETRAHEDRA));

TEST(MapStreamTest, HasMetricsAloneWhereNoGeometryIsAskedFor) {
  StoredBars bars;
  const auto streamed = Stream(bars, MetricAlone());
  ASSERT_TRUE(streamed.ok());
  EXPECT_EQ(streamed->tree.values_size(), 4);
  EXPECT_TRUE(streamed->tree.meshes().empty());
  EXPECT_TRUE(streamed->meshes.empty());
  EXPECT_TRUE(streamed->samples.empty());
}

TEST(MapStreamTest, HasErrorsOfFieldsInTheOrderOfTheMap) {
  StoredBars bars;
  v1::EvaluateMapShapeRequest request;
  request.set_geometry(v1::TETRAHEDRA);
  request.add_fields("heat");
  request.add_fields("stress");
  const auto streamed = Stream(bars, ReadShapeDemand(bars.map()->record, request).value());
  ASSERT_TRUE(streamed.ok());
  ASSERT_EQ(streamed->tree.field_errors_size(), 2);
  EXPECT_EQ(streamed->tree.field_errors(0), 2e4);
  EXPECT_EQ(streamed->tree.field_errors(1), 0.5);
  EXPECT_EQ(streamed->samples.at(0).fields(0).name(), "stress");
}

TEST(MapStreamTest, SaysWhatIsCutOff) {
  StoredBars bars(3, StoredBars::Has::kNothing);
  const auto streamed = Stream(bars, Demand(bars, v1::SURFACE));
  ASSERT_TRUE(streamed.ok());
  EXPECT_EQ(streamed->tree.meshes(0), -1);
  EXPECT_TRUE(streamed->tree.cut_off(0));
}

TEST(MapStreamTest, SaysWhatHasMetricsAlone) {
  StoredBars bars(3, StoredBars::Has::kMetrics);
  const auto streamed = Stream(bars, Demand(bars, v1::SURFACE));
  ASSERT_TRUE(streamed.ok());
  EXPECT_EQ(streamed->tree.meshes(0), -1);
  EXPECT_FALSE(streamed->tree.cut_off(0));
}

TEST(MapStreamTest, EndsWhereAFileIsGone) {
  StoredBars bars;
  ASSERT_TRUE(bars.blobs().Remove(bars.stored().meshes[0].shapes.at(2)).ok());
  EXPECT_TRUE(absl::IsDataLoss(Stream(bars, Demand(bars, v1::SURFACE)).status()));
  EXPECT_TRUE(Stream(bars, MetricAlone()).ok());
}

}  // namespace
}  // namespace mortise::interpolator
