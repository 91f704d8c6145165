// Files of maps: written, read, and damaged.
#include "services/interpolator/records/stored_map.h"

#include <gtest/gtest.h>

#include "common/maps/map_sampling.h"

namespace mortise::interpolator {
namespace {

maps::MapContent Sampled(maps::Basis basis) {
  maps::MapSamplingOptions options;
  options.basis = basis;
  options.budget = 40;
  maps::MapSampling sampling = maps::MapSampling::Create(2, 1, options).value();
  while (!sampling.Done()) {
    for (const maps::AskedPoint& point : sampling.Ask(4)) {
      const double x = point.position[0], y = point.position[1];
      const absl::Status told =
          x > 0.9 && y > 0.9
              ? sampling.TellFailure(point.number, absl::InternalError("it fails"))
              : sampling.Tell(point.number, Eigen::VectorXd::Constant(1, std::exp(x) * y * y));
      EXPECT_TRUE(told.ok()) << told;
    }
  }
  return sampling.Content().value();
}

TEST(StoredMapTest, ReadsWhatWasWritten) {
  const std::vector<maps::MapContent> contents = {Sampled(maps::Basis::kLinear),
                                                  Sampled(maps::Basis::kCubic)};
  const std::string bytes = SerializeMap(contents);
  EXPECT_EQ(bytes, SerializeMap(contents));
  const auto read = ParseMap(bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->size(), 2u);
  for (std::size_t s = 0; s < 2; ++s) {
    const maps::MapContent& content = (*read)[s].map.content();
    EXPECT_TRUE((*read)[s].shapes.element_meshes.empty());
    EXPECT_EQ(content.basis, contents[s].basis);
    EXPECT_EQ(content.options, contents[s].options);
    EXPECT_EQ(content.splits, contents[s].splits);
    EXPECT_EQ(content.values, contents[s].values);
    EXPECT_EQ(content.errors, contents[s].errors);
    EXPECT_EQ(content.cut_off, contents[s].cut_off);
  }
}

// A digest of one digit.
std::string Digest(char digit) { return std::string(64, digit); }

// Shapes in two meshes, of a map of that content.
StoredShapes ShapesOf(const maps::MapContent& content) {
  StoredShapes shapes;
  shapes.meshes = {{Digest('a'), {{0, Digest('1')}, {3, Digest('2')}}}, {Digest('b'), {}}};
  const auto elements = static_cast<Eigen::Index>(content.cut_off.size());
  for (Eigen::Index e = 0; e < elements; ++e) {
    shapes.element_meshes.push_back(static_cast<int>(e % 3) - 1);
  }
  shapes.shape_errors = Eigen::VectorXd::LinSpaced(elements, 0, 1);
  shapes.field_errors = Eigen::MatrixXd::Constant(2, elements, 0.5);
  return shapes;
}

// Of a map that has no metrics beside its shapes.
maps::MapContent WithoutMetrics(maps::MapContent content) {
  content.values.resize(0, content.values.cols());
  content.errors.resize(0, content.errors.cols());
  return content;
}

TEST(StoredMapTest, ReadsShapesThatWereWritten) {
  const maps::MapContent sampled = Sampled(maps::Basis::kLinear);
  for (const maps::MapContent& content : {sampled, WithoutMetrics(sampled)}) {
    const StoredShapes shapes = ShapesOf(content);
    const auto read = ParseMap(SerializeMap({content}, {shapes}));
    ASSERT_TRUE(read.ok()) << read.status();
    ASSERT_EQ(read->size(), 1u);
    EXPECT_EQ((*read)[0].map.content().values, content.values);
    const StoredShapes& again = (*read)[0].shapes;
    EXPECT_EQ(again.element_meshes, shapes.element_meshes);
    ASSERT_EQ(again.meshes.size(), 2u);
    EXPECT_EQ(again.meshes[0].file, shapes.meshes[0].file);
    EXPECT_EQ(again.meshes[0].shapes, shapes.meshes[0].shapes);
    EXPECT_EQ(again.shape_errors, shapes.shape_errors);
    EXPECT_EQ(again.field_errors, shapes.field_errors);
  }
}

// What the first version wrote of one element with one metric, byte by byte.
TEST(StoredMapTest, ReadsMapsOfTheFirstVersion) {
  const std::string numbers(4 * 8, '\0');
  const std::string structure =
      std::string("\x08\x02\x10\x01\x18\x04\x20\x14\x38\x01\x42\x20", 12) + numbers + "\x4a\x08" +
      std::string(8, '\0');
  const std::string bytes =
      std::string("\x08\x01\x12") + static_cast<char>(structure.size()) + structure;
  const auto read = ParseMap(bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->size(), 1u);
  EXPECT_EQ((*read)[0].map.content().values, Eigen::MatrixXd::Zero(1, 4));
  EXPECT_EQ((*read)[0].map.dimension(), 2);
  EXPECT_TRUE((*read)[0].shapes.meshes.empty());
}

class StoredMapDamageTest : public ::testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(WithAndWithoutShapes, StoredMapDamageTest, ::testing::Bool());

TEST_P(StoredMapDamageTest, RefusesWhatIsNone) {
  const maps::MapContent content = Sampled(maps::Basis::kLinear);
  const std::string bytes =
      GetParam() ? SerializeMap({content}, {ShapesOf(content)}) : SerializeMap({content});
  for (std::size_t length = 0; length < bytes.size(); length += 7) {
    const auto read = ParseMap(bytes.substr(0, length));
    EXPECT_TRUE(absl::IsDataLoss(read.status())) << length;
  }
  // Any byte that is changed is either noticed or leaves a map that can be asked: the digest of the
  // file tells the rest.
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x55);
    const auto read = ParseMap(changed);
    if (!read.ok()) {
      EXPECT_TRUE(absl::IsDataLoss(read.status())) << read.status();
    }
  }
}

}  // namespace
}  // namespace mortise::interpolator
