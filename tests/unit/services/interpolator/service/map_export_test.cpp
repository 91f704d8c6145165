// What is given away of a map interpolates as the map does.
#include "services/interpolator/service/map_export.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/base/random.h"
#include "tests/unit/services/interpolator/service/sampled_map.h"

namespace mortise::interpolator {
namespace {

using testing::SampledMap;

// Interpolates by an exported tree, slowly and exactly as docs/maps.md says.
class ExportedMap {
 public:
  ExportedMap(v1::MapTree tree, bool cubic, int metrics)
      : tree_(std::move(tree)), cubic_(cubic), metrics_(metrics) {}

  int ElementOf(const std::vector<double>& point) const {
    std::vector<double> low(point.size(), 0), high(point.size(), 1);
    int node = 0;
    while (tree_.directions(node) >= 0) {
      const auto d = static_cast<std::size_t>(tree_.directions(node));
      const double middle = (low[d] + high[d]) / 2;
      const bool upper = point[d] >= middle;
      (upper ? low : high)[d] = middle;
      node = tree_.children(node) + (upper ? 1 : 0);
    }
    return tree_.children(node);
  }

  std::vector<double> ValuesAt(const std::vector<double>& point) const {
    std::vector<double> sums(static_cast<std::size_t>(metrics_), 0);
    int part = 0;
    for (int s = 0; s < tree_.levels_size(); ++s) {
      double factor = 1;
      for (int d = 0; d < tree_.dimension(); ++d) {
        const double offset = std::ldexp(point[static_cast<std::size_t>(d)], tree_.levels(s)) -
                              tree_.centres(s * tree_.dimension() + d);
        factor *= cubic_ ? Cubic(offset) : std::max(0.0, 1 - std::abs(offset));
      }
      for (int m = 0; m < metrics_; ++m) {
        double coefficient = cubic_ ? tree_.coefficients(s * metrics_ + m) : 0;
        for (int i = part; i < part + tree_.sample_counts(s); ++i) {
          coefficient += tree_.weights(i) * tree_.values(tree_.samples(i) * metrics_ + m);
        }
        sums[static_cast<std::size_t>(m)] += factor * coefficient;
      }
      part += tree_.sample_counts(s);
    }
    return sums;
  }

  const v1::MapTree& tree() const { return tree_; }

 private:
  static double Cubic(double offset) {
    const double a = std::abs(offset);
    if (a >= 2) return 0;
    return a >= 1 ? std::pow(2 - a, 3) / 6 : 2.0 / 3 - a * a * (1 - a / 2);
  }

  const v1::MapTree tree_;
  const bool cubic_;
  const int metrics_;
};

class MapExportTest : public ::testing::TestWithParam<std::pair<int, maps::Basis>> {};

TEST_P(MapExportTest, InterpolatesAsTheMapDoes) {
  const auto [dimension, basis] = GetParam();
  const maps::InterpolationMap map = SampledMap(dimension, basis, 40 << (dimension - 1));
  // The second metric, then the first.
  const ExportedMap exported(ExportTree(map, {1, 0}), basis == maps::Basis::kCubic, 2);
  const v1::MapTree& tree = exported.tree();
  EXPECT_EQ(tree.cut_off_size(), map.tree().element_count());
  EXPECT_EQ(tree.positions_size(), dimension * map.tree().sample_count());
  EXPECT_EQ(tree.values_size(), 2 * map.tree().sample_count());
  const double range = map.content().values.row(0).maxCoeff();
  Random random(3);
  int covered = 0;
  for (int n = 0; n < 300; ++n) {
    std::vector<double> point;
    for (int d = 0; d < dimension; ++d) {
      // Corners and middles, too.
      const double number = random.Uniform();
      point.push_back(n % 3 == 0 ? std::round(number * 4) / 4 : number);
    }
    const Eigen::Map<const Eigen::VectorXd> place(point.data(), dimension);
    const maps::MapValues truth = map.Evaluate(place);
    const int element = exported.ElementOf(point);
    EXPECT_EQ(tree.cut_off(element), std::isnan(truth.values(0)));
    if (tree.cut_off(element)) continue;
    ++covered;
    EXPECT_EQ(tree.errors(2 * element + 1), truth.errors(0));
    const std::vector<double> values = exported.ValuesAt(point);
    EXPECT_NEAR(values[1], truth.values(0), 1e-12 * range);
    EXPECT_NEAR(values[0], truth.values(1), 1e-12 * 4e6 * dimension);
  }
  EXPECT_GT(covered, 100);
  EXPECT_LT(covered, 300);
}

INSTANTIATE_TEST_SUITE_P(Maps, MapExportTest,
                         ::testing::Values(std::pair(1, maps::Basis::kLinear),
                                           std::pair(2, maps::Basis::kLinear),
                                           std::pair(4, maps::Basis::kLinear),
                                           std::pair(1, maps::Basis::kCubic),
                                           std::pair(3, maps::Basis::kCubic)));

TEST(CutTree, PartsPutTogetherAreTheTree) {
  v1::MapTree tree = ExportTree(SampledMap(2, maps::Basis::kLinear, 60), {0, 1});
  tree.add_meshes(3);
  tree.add_shape_errors(0.25);
  tree.add_field_errors(0.5);
  const std::vector<v1::MapTree> parts = CutTree(tree, 50);
  ASSERT_GT(parts.size(), 3u);
  v1::MapTree whole;
  for (const v1::MapTree& part : parts) {
    EXPECT_EQ(part.more(), &part != &parts.back());
    EXPECT_LT(part.ByteSizeLong(), 600u);
    whole.MergeFrom(part);
  }
  whole.clear_more();
  EXPECT_EQ(whole.SerializeAsString(), tree.SerializeAsString());
  EXPECT_EQ(CutTree(tree).size(), 1u);
}

TEST(CutSample, PartsPutTogetherAreTheSample) {
  v1::MapExportPart::Sample sample;
  sample.set_sample(3);
  sample.set_mesh(1);
  sample.set_positions("abcdefghijkl");
  for (const char* const load_case : {"push", "pull"}) {
    v1::MapFieldValues& field = *sample.add_fields();
    field.set_name("stress");
    field.set_load_case(load_case);
    field.set_values(std::string(load_case) + "0123");
  }
  for (const std::size_t most : {4u, 10u, 16u, 1000u}) {
    std::string positions, push, pull;
    const auto parts = CutSample(sample, most);
    for (const v1::MapExportPart::Sample& part : parts) {
      EXPECT_EQ(part.sample(), 3);
      EXPECT_EQ(part.mesh(), 1);
      std::size_t bytes = part.positions().size();
      positions += part.positions();
      for (const v1::MapFieldValues& field : part.fields()) {
        EXPECT_EQ(field.name(), "stress");
        (field.load_case() == "push" ? push : pull) += field.values();
        bytes += field.values().size();
      }
      EXPECT_LE(bytes, most);
      EXPECT_EQ(bytes % 4, 0u);
    }
    EXPECT_EQ(positions, sample.positions());
    EXPECT_EQ(push, "push0123");
    EXPECT_EQ(pull, "pull0123");
    EXPECT_EQ(parts.size() == 1, most == 1000);
  }
}

}  // namespace
}  // namespace mortise::interpolator
