// Pages of maps in a real browser: what they compute is what the map says, they draw what they
// should, and they meet no fault.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/explore/map_page.h"
#include "common/base/files.h"
#include "common/base/random.h"
#include "services/interpolator/service/map_export.h"
#include "services/interpolator/service/map_shape.h"
#include "services/interpolator/service/map_stream.h"
#include "tests/support/opened_page.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/cli/explore/vase_map.h"
#include "tests/unit/services/interpolator/service/sampled_map.h"
#include "tests/unit/services/interpolator/service/stored_bars.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

// A map with structures, what is exported of it, and what says what is true of it.
struct Example {
  v1::DesignMap map;
  std::vector<maps::InterpolationMap> structures;
  std::vector<ExportedStructure> exported;
};

// A map of SampledMap for each of one or two choices over K numbers from 0.2 to 0.5.
Example MakeExample(int dimension, maps::Basis basis, int choices) {
  Example example;
  v1::DesignMap& map = example.map;
  map.set_name("maps/0198c1");
  map.mutable_specification()->set_subject("templates/vase");
  map.mutable_specification()->set_revision(3);
  if (basis == maps::Basis::kCubic)
    map.mutable_specification()->set_basis(v1::MapSpecification::CUBIC);
  if (choices > 1) {
    v1::MapParameter& material = *map.add_parameters();
    material.set_name("material");
    material.set_whole(true);
    material.set_maximum(choices - 1);
    for (const char* const name : {"fired_clay", "glass"}) material.add_choices(name);
  }
  const std::vector<std::string> names = {"height", "waist", "neck_width", "foot"};
  for (int d = 0; d < dimension; ++d) {
    v1::MapParameter& parameter = *map.add_parameters();
    parameter.set_name(names[static_cast<std::size_t>(d)]);
    parameter.set_unit("m");
    parameter.set_minimum(0.2);
    parameter.set_maximum(0.5);
  }
  for (int s = 0; s < choices; ++s) {
    v1::MapStructure& structure = *map.add_structures();
    if (choices > 1) structure.add_values()->set_value(s);
    example.structures.push_back(
        interpolator::testing::SampledMap(dimension, basis, (60 + 20 * s) << (dimension - 1)));
    ExportedStructure exported;
    exported.structure = s;
    exported.tree = interpolator::ExportTree(example.structures.back(), {0, 1});
    example.exported.push_back(std::move(exported));
    const maps::MapContent& content = example.structures.back().content();
    for (const std::uint8_t cut : content.cut_off) {
      map.set_cut_off_elements(map.cut_off_elements() + (cut != 0 ? 1 : 0));
    }
    map.set_elements(map.elements() + static_cast<int>(content.cut_off.size()));
    map.set_samples(map.samples() + content.values.cols());
  }
  const Eigen::MatrixXd& values = example.structures[0].content().values;
  for (int m = 0; m < 2; ++m) {
    v1::MapMetric& metric = *map.add_metrics();
    metric.set_name(m == 0 ? "mass" : "max_von_mises");
    metric.set_unit(m == 0 ? "kg" : "Pa");
    metric.set_minimum(values.row(m).minCoeff());
    metric.set_maximum(values.row(m).maxCoeff());
  }
  v1::ParameterValue& fixed = *map.add_fixed();
  fixed.set_name("wall_thickness");
  fixed.set_value(0.004);
  v1::MapVerification::Difference& off = *map.mutable_verification()->add_differences();
  off.set_metric("mass");
  off.set_largest(0.02);
  map.set_stale(true);
  v1::MapFailure& failure = *map.add_failures();
  failure.set_count(4);
  failure.set_message("the neck closes");
  return example;
}

class ExplorePageTest : public ::testing::Test {
 protected:
  // Random designs of a map, of all of its structures.
  static std::vector<std::vector<double>> RandomDesigns(const Example& example, int count) {
    Random random(7);
    std::vector<std::vector<double>> designs;
    for (int i = 0; i < count; ++i) {
      std::vector<double> design;
      for (const v1::MapParameter& parameter : example.map.parameters()) {
        const double share = i % 5 == 0 ? std::round(2 * random.Uniform()) / 2 : random.Uniform();
        design.push_back(parameter.whole() ? i % 2
                                           : parameter.minimum() + share * (parameter.maximum() -
                                                                            parameter.minimum()));
      }
      designs.push_back(std::move(design));
    }
    return designs;
  }

  // What the map says of a design.
  static maps::MapValues Truth(const Example& example, const std::vector<double>& design) {
    std::vector<double> place;
    std::size_t structure = 0;
    for (int p = 0; p < example.map.parameters_size(); ++p) {
      const v1::MapParameter& parameter = example.map.parameters(p);
      const double value = design[static_cast<std::size_t>(p)];
      if (parameter.whole()) {
        structure = static_cast<std::size_t>(value);
      } else {
        place.push_back((value - parameter.minimum()) /
                        (parameter.maximum() - parameter.minimum()));
      }
    }
    return example.structures[structure].Evaluate(
        Eigen::Map<const Eigen::VectorXd>(place.data(), static_cast<Eigen::Index>(place.size())));
  }

  // Opens a page in the browser and takes what its self-test says of these designs.
  Json Open(const std::string& page, const std::vector<std::vector<double>>& designs,
            const std::vector<std::string>& flags = {}) {
    const auto file = folder_.path() / "page.html";
    EXPECT_TRUE(WriteFile(file, page).ok());
    return testing::OpenPage(file, designs, flags);
  }

  // Compares what a page has computed of a design with what is true. Returns whether it has values.
  static bool Compare(const Example& example, const std::vector<double>& design,
                      const Json& answer) {
    const maps::MapValues truth = Truth(example, design);
    const bool covered = !std::isnan(truth.values(0));
    EXPECT_EQ(answer["values"].is_array(), covered);
    EXPECT_EQ(answer["saysNoValues"], !covered);
    if (!covered || !answer["values"].is_array()) {
      EXPECT_EQ(answer["shown"], Json::array({"no value", "no value"}));
      return false;
    }
    for (std::size_t m = 0; m < 2; ++m) {
      const auto row = static_cast<Eigen::Index>(m);
      const v1::MapMetric& metric = example.map.metrics(static_cast<int>(m));
      const double least = 1e-3 * (metric.maximum() - metric.minimum());
      EXPECT_NEAR(answer["values"][m].get<double>(), truth.values(row),
                  1e-9 * std::max(std::abs(truth.values(row)), least));
      EXPECT_EQ(answer["errors"][m].get<double>(), truth.errors(row));
      EXPECT_NE(answer["shown"][m], "no value");
    }
    return true;
  }

  // The same of all designs; returns how many have values.
  static int CompareAll(const Example& example, const std::vector<std::vector<double>>& designs,
                        const Json& told) {
    EXPECT_EQ(told["answers"].size(), designs.size());
    int covered = 0;
    for (std::size_t i = 0; i < designs.size() && i < told["answers"].size(); ++i) {
      covered += Compare(example, designs[i], told["answers"][i]) ? 1 : 0;
    }
    return covered;
  }

  testing::TemporaryFolder folder_;
};

TEST_F(ExplorePageTest, SaysOfAllDesignsWhatTheMapSays) {
  const Example example = MakeExample(3, maps::Basis::kLinear, 2);
  const auto designs = RandomDesigns(example, 120);
  const Json told = Open(MapPage(example.map, example.exported).value(), designs);
  const int covered = CompareAll(example, designs, told);
  EXPECT_GT(covered, 60);
  EXPECT_LT(covered, 120);
  // The slider that was moved has moved the first number, and all that is said.
  std::vector<double> moved = designs.back();
  moved[1] = 0.5;
  EXPECT_EQ(told["moved"]["design"].get<std::vector<double>>(), moved);
  Compare(example, moved, told["moved"]);
}

TEST_F(ExplorePageTest, SaysOfSmoothMapsWhatTheySay) {
  const Example example = MakeExample(2, maps::Basis::kCubic, 1);
  const auto designs = RandomDesigns(example, 60);
  CompareAll(example, designs, Open(MapPage(example.map, example.exported).value(), designs));
}

TEST_F(ExplorePageTest, DrawsShapesBetweenSamples) {
  Example example = MakeExample(2, maps::Basis::kLinear, 2);
  for (ExportedStructure& structure : example.exported) AddVases(structure);
  *example.map.mutable_shapes() = VaseShapes();
  const auto designs = RandomDesigns(example, 20);
  const Json told = Open(MapPage(example.map, example.exported).value(), designs);
  CompareAll(example, designs, told);
  EXPECT_THAT(told["webgl"].get<std::string>(), HasSubstr("WebGL 2"));
  int drawn = 0;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const Json& answer = told["answers"][i];
    if (answer["values"].is_null()) {
      EXPECT_TRUE(answer["positions"].is_null());
      EXPECT_EQ(answer["colours"], 1) << "nothing is drawn where there is nothing";
      continue;
    }
    ++drawn;
    EXPECT_GT(answer["colours"].get<int>(), 100);
    // All of it is linear in the numbers, so that between samples it is what it is at them.
    const auto unit = [&](std::size_t p) { return (designs[i][p] - 0.2) / 0.3; };
    const std::string bytes = VaseAt(0, unit(1), unit(2)).positions();
    std::vector<float> truth(bytes.size() / sizeof(float));
    std::memcpy(truth.data(), bytes.data(), bytes.size());
    ASSERT_EQ(answer["positions"].size(), 30u);
    for (std::size_t n = 0; n < 30; ++n) {
      EXPECT_NEAR(answer["positions"][n].get<double>(), truth[n], 1e-5 * 0.5);
    }
  }
  EXPECT_GT(drawn, 8);
}

TEST_F(ExplorePageTest, ShowsMetricsWhereThereIsNoShape) {
  Example example = MakeExample(2, maps::Basis::kLinear, 1);
  AddVases(example.exported[0]);
  *example.map.mutable_shapes() = VaseShapes();
  example.map.mutable_shapes()->set_unmapped(3);
  // Every other element.
  v1::MapTree& tree = example.exported[0].tree;
  for (int e = 0; e < tree.meshes_size(); e += 2) tree.set_meshes(e, -1);
  example.map.set_shapeless_elements((tree.meshes_size() + 1) / 2);
  const auto designs = RandomDesigns(example, 30);
  const Json told = Open(MapPage(example.map, example.exported).value(), designs);
  CompareAll(example, designs, told);
  EXPECT_EQ(told["faults"], Json::array());
  int with = 0, without = 0;
  for (const Json& answer : told["answers"]) {
    if (answer["values"].is_null()) continue;
    const bool has_shape = !answer["positions"].is_null();
    EXPECT_EQ(answer["saysNoShape"], !has_shape);
    EXPECT_EQ(answer["colours"].get<int>() > 100, has_shape);
    ++(has_shape ? with : without);
  }
  EXPECT_GT(with, 3);
  EXPECT_GT(without, 3);
}

TEST_F(ExplorePageTest, DrawsWhatTheServiceAnswersWith) {
  interpolator::testing::StoredBars bars;
  v1::DesignMap map = bars.map()->record;
  for (v1::MapShapes::Field& field : *map.mutable_shapes()->mutable_fields()) {
    field.set_components(1);
  }
  v1::EvaluateMapShapeRequest asked;
  asked.set_geometry(v1::SURFACE);
  interpolator::MapStream stream(bars.map(), &bars.shapes(), 0,
                                 interpolator::ReadShapeDemand(map, asked).value());
  ExportedStructure exported;
  for (auto part = stream.Next().value(); part; part = stream.Next().value()) {
    AddPart(*std::move(part), exported);
  }
  std::vector<std::vector<double>> designs;
  Random random(3);
  for (int i = 0; i < 15; ++i) {
    designs.push_back({random.Uniform(), 10 + 2 * random.Uniform()});
  }
  const Json told = Open(MapPage(map, {exported}).value(), designs);
  ASSERT_EQ(told["answers"].size(), designs.size());
  for (std::size_t i = 0; i < designs.size(); ++i) {
    *asked.mutable_point() = {designs[i].begin(), designs[i].end()};
    const v1::MapShape truth =
        interpolator::EvaluateShape(*bars.map(), bars.shapes(), asked).value();
    const Json& answer = told["answers"][i];
    EXPECT_NEAR(answer["values"][0].get<double>(), truth.values(0), 1e-9 * truth.values(0));
    EXPECT_GT(answer["colours"].get<int>(), 50);
    ASSERT_EQ(answer["positions"].size(), 30u);
    for (std::size_t n = 0; n < 30; ++n) {
      float expected = 0;
      std::memcpy(&expected, truth.positions().data() + n * sizeof(float), sizeof(float));
      EXPECT_NEAR(answer["positions"][n].get<double>(), expected, 1e-5 * bars.mesh().size);
    }
  }
}

TEST_F(ExplorePageTest, ShowsMetricsWithoutWebGl) {
  Example example = MakeExample(2, maps::Basis::kLinear, 1);
  for (ExportedStructure& structure : example.exported) AddVases(structure);
  *example.map.mutable_shapes() = VaseShapes();
  const auto designs = RandomDesigns(example, 10);
  const Json told =
      Open(MapPage(example.map, example.exported).value(), designs, {"--disable-3d-apis"});
  EXPECT_TRUE(told["webgl"].is_null());
  CompareAll(example, designs, told);
}

}  // namespace
}  // namespace mortise::cli
