// Shapes that maps answer with: what is in them, what is refused, and files that are damaged.
#include "services/interpolator/service/map_shape.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/server_limits.h"
#include "tests/unit/services/interpolator/service/stored_bars.h"

namespace mortise::interpolator {
namespace {

using testing::BarDesign;
using testing::BarStress;
using testing::StoredBars;

v1::EvaluateMapShapeRequest At(double x, double y) {
  v1::EvaluateMapShapeRequest request;
  request.set_name("maps/bars");
  request.add_point(x);
  request.add_point(y);
  return request;
}

template <typename Number>
std::vector<Number> NumbersOf(const std::string& bytes) {
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

v1::MapShape Answer(StoredBars& bars, const v1::EvaluateMapShapeRequest& asked) {
  const auto answer = EvaluateShape(*bars.map(), bars.shapes(), asked);
  EXPECT_TRUE(answer.ok()) << answer.status();
  return answer.value_or(v1::MapShape());
}

void ExpectRefused(StoredBars& bars, const v1::EvaluateMapShapeRequest& asked,
                   const std::string& field) {
  const auto answer = EvaluateShape(*bars.map(), bars.shapes(), asked);
  EXPECT_EQ(answer.status().code(), absl::StatusCode::kInvalidArgument) << field;
  EXPECT_EQ(DetailOf(answer.status()).field, field);
}

TEST(MapShapeTest, HasTheSurfaceOfTheDesignWithFieldsMetricsAndProportions) {
  StoredBars bars;
  const v1::MapShape shape = Answer(bars, At(0.25, 11));
  EXPECT_FALSE(shape.uncovered());
  EXPECT_EQ(shape.new_mesh().nodes(), bars.mesh().surface_nodes);
  const std::vector<int> triangles = NumbersOf<int>(shape.new_mesh().triangles());
  EXPECT_EQ(static_cast<int>(triangles.size()), 3 * bars.mesh().triangles.cols());
  EXPECT_TRUE(shape.new_mesh().tetrahedra().empty());
  EXPECT_EQ(NumbersOf<int>(shape.new_mesh().parts()).size(), triangles.size() / 3);
  ASSERT_EQ(shape.new_mesh().part_names_size(), 1);
  ASSERT_EQ(shape.new_mesh().regions_size(), 1);
  EXPECT_EQ(shape.new_mesh().regions(0).name(), "end");
  EXPECT_EQ(NumbersOf<int>(shape.new_mesh().regions(0).triangles()).size(), 2u);
  const std::vector<float> positions = NumbersOf<float>(shape.positions());
  ASSERT_EQ(positions.size(), 3u * static_cast<std::size_t>(bars.mesh().surface_nodes));
  // The fields that lie on the surface: of nodes alone.
  ASSERT_EQ(shape.fields_size(), 1);
  EXPECT_EQ(shape.fields(0).load_case(), "pull");
  EXPECT_EQ(shape.fields(0).error(), 2e4);
  const std::vector<float> stress = NumbersOf<float>(shape.fields(0).values());
  ASSERT_EQ(stress.size(), positions.size() / 3);
  for (std::size_t i = 0; i < stress.size(); ++i) {
    // Between two samples along x, each of whose stress is known.
    const double along = positions[3 * i] / 1.25;
    const double expected = 0.75 * BarStress(0, 11, along) + 0.25 * BarStress(1, 11, along);
    EXPECT_NEAR(stress[i], expected, 1e-4 * expected);
  }
  EXPECT_EQ(shape.error(), 0.125);
  ASSERT_EQ(shape.values_size(), 1);
  EXPECT_NEAR(shape.values(0), 3.25, 1e-12);
  EXPECT_EQ(shape.metric_errors(0), 0.25);
  EXPECT_NEAR(shape.volume(), 1.25 * 1.1 * 0.2, 1e-4);
  EXPECT_NEAR(shape.surface_area(), 2 * (1.25 * 1.1 + 1.25 * 0.2 + 1.1 * 0.2), 1e-3);
  EXPECT_NEAR(shape.centroid().x(), 0.625, 1e-4);
}

TEST(MapShapeTest, HasTetrahedraWhereTheyAreAskedFor) {
  StoredBars bars;
  v1::EvaluateMapShapeRequest asked = At(0.5, 11.5);
  asked.set_geometry(v1::TETRAHEDRA);
  const v1::MapShape shape = Answer(bars, asked);
  EXPECT_EQ(NumbersOf<int>(shape.new_mesh().tetrahedra()).size(), 4u * 18);
  EXPECT_EQ(NumbersOf<int>(shape.new_mesh().parts()).size(),
            18u + NumbersOf<int>(shape.new_mesh().triangles()).size() / 3);
  ASSERT_EQ(shape.fields_size(), 2);
  for (const float heat : NumbersOf<float>(shape.fields(1).values())) EXPECT_NEAR(heat, 0.5, 1e-5);
}

TEST(MapShapeTest, SendsNoMeshThatTheCallerHas) {
  StoredBars bars;
  v1::EvaluateMapShapeRequest asked = At(0.5, 11);
  asked.set_known_structure(0);
  asked.set_known_mesh(0);
  EXPECT_FALSE(Answer(bars, asked).has_new_mesh());
  asked.set_known_mesh(1);
  EXPECT_TRUE(Answer(bars, asked).has_new_mesh());
}

TEST(MapShapeTest, GivesWhatIsAskedForAndNothingElse) {
  StoredBars bars;
  v1::EvaluateMapShapeRequest asked = At(0.5, 11);
  asked.set_without_fields(true);
  EXPECT_EQ(Answer(bars, asked).fields_size(), 0);
  asked.add_fields("stress");
  ExpectRefused(bars, asked, "without_fields");
  asked.set_without_fields(false);
  EXPECT_EQ(Answer(bars, asked).fields_size(), 1);
  asked.add_fields("heat");
  ExpectRefused(bars, asked, "fields[1]");
  asked.set_fields(1, "stress");
  ExpectRefused(bars, asked, "fields[1]");
  asked.set_fields(1, "strain");
  ExpectRefused(bars, asked, "fields[1]");
  asked.clear_fields();
  asked.add_metrics("beauty");
  ExpectRefused(bars, asked, "metrics[0]");
  ExpectRefused(bars, At(2, 11), "point");
  asked = At(0.5, 11);
  asked.add_point(1);
  ExpectRefused(bars, asked, "point");
}

TEST(MapShapeTest, HasFieldsInTheOrderOfTheMap) {
  StoredBars bars;
  v1::EvaluateMapShapeRequest asked = At(0.5, 11);
  asked.set_geometry(v1::TETRAHEDRA);
  asked.add_fields("heat");
  asked.add_fields("stress");
  const v1::MapShape shape = Answer(bars, asked);
  ASSERT_EQ(shape.fields_size(), 2);
  EXPECT_EQ(shape.fields(0).name(), "stress");
  EXPECT_EQ(shape.fields(0).error(), 2e4);
  EXPECT_EQ(shape.fields(1).name(), "heat");
  EXPECT_EQ(shape.fields(1).error(), 0.5);
}

TEST(MapShapeTest, CountsAllThatMeshesTakeInMemory) {
  StoredBars bars;
  const auto bytes_of = [&](const fields::DesignFields& design) {
    const auto mesh = CanonicalMesh::Create(design);
    EXPECT_TRUE(mesh.ok()) << mesh.status();
    LoadedShapes loaded(&bars.blobs());
    EXPECT_TRUE(loaded.Mesh(bars.blobs().Put(WriteMesh(*mesh).value()).value()).ok());
    return loaded.bytes();
  };
  fields::DesignFields design = BarDesign(0.5, 11);
  const std::size_t plain = bytes_of(design);
  design.fields.push_back({"mode_shape", "1", "mode 1", fields::FieldPlace::kNodes,
                           Eigen::MatrixXd::Constant(3, design.nodes.cols(), 0.5)});
  const std::size_t with_mode = bytes_of(design);
  EXPECT_GE(with_mode, plain + 3 * 8 * static_cast<std::size_t>(design.nodes.cols()));
  design.control_points = {{"a", design.nodes.col(0), 0}, {"b", design.nodes.col(1), 1}};
  fields::ControlWay way{"edge", 0, 1, Eigen::Matrix3Xd(3, 1000)};
  for (int i = 0; i < 1000; ++i) {
    way.positions.col(i) =
        design.nodes.col(0) + i / 999.0 * (design.nodes.col(1) - design.nodes.col(0));
  }
  design.ways = {way};
  EXPECT_GE(bytes_of(design), with_mode + 3 * 8 * 1000);
}

TEST(MapShapeTest, SaysWhereTheMapHasNothing) {
  StoredBars bars(3, StoredBars::Has::kNothing);
  const v1::MapShape shape = Answer(bars, At(0.5, 11));
  EXPECT_TRUE(shape.uncovered());
  EXPECT_FALSE(shape.shapeless());
  EXPECT_TRUE(shape.positions().empty());
  EXPECT_EQ(shape.values_size(), 0);
}

TEST(MapShapeTest, HasMetricsWhereItHasNoShape) {
  StoredBars bars(3, StoredBars::Has::kMetrics);
  v1::EvaluateMapShapeRequest asked = At(0.5, 11);
  const v1::MapShape shape = Answer(bars, asked);
  EXPECT_FALSE(shape.uncovered());
  EXPECT_TRUE(shape.shapeless());
  EXPECT_FALSE(shape.has_new_mesh());
  EXPECT_TRUE(shape.positions().empty());
  EXPECT_EQ(shape.fields_size(), 0);
  ASSERT_EQ(shape.values_size(), 1);
  EXPECT_NEAR(shape.values(0), 3.5, 1e-12);
  EXPECT_EQ(shape.metric_errors(0), 0.25);
  // Whatever the caller has, there is no mesh to be sent.
  asked.set_known_structure(0);
  asked.set_known_mesh(7);
  EXPECT_FALSE(Answer(bars, asked).has_new_mesh());
}

TEST(MapShapeTest, SaysWhatIsTooLargeForAMessage) {
  v1::MapShape shape;
  shape.set_positions(std::string(rpc::kMaxMessageBytes - 1000, ' '));
  EXPECT_TRUE(CheckMessageSize(shape).ok());
  shape.add_fields()->set_values(std::string(2000, ' '));
  EXPECT_TRUE(absl::IsResourceExhausted(CheckMessageSize(shape)));
  EXPECT_EQ(DetailOf(CheckMessageSize(shape)).field, "fields");
  shape.mutable_positions()->append(std::string(2000, ' '));
  EXPECT_EQ(DetailOf(CheckMessageSize(shape)).field, "geometry");
}

TEST(MapShapeTest, NeverAnswersFromADamagedFile) {
  StoredBars bars;
  for (const std::string& file :
       {bars.stored().meshes[0].shapes.begin()->second, bars.stored().meshes[0].file}) {
    const std::string bytes = bars.blobs().Get(file).value();
    ASSERT_TRUE(bars.blobs().Remove(file).ok());
    LoadedShapes anew(&bars.blobs());
    const auto answer = EvaluateShape(*bars.map(), anew, At(0.25, 10.5));
    EXPECT_TRUE(absl::IsDataLoss(answer.status())) << answer.status();
    EXPECT_EQ(DetailOf(answer.status()).reason, "MAP_DAMAGED");
    ASSERT_TRUE(bars.blobs().Put(bytes).ok());
    EXPECT_TRUE(EvaluateShape(*bars.map(), anew, At(0.25, 10.5)).ok());
  }
}

}  // namespace
}  // namespace mortise::interpolator
