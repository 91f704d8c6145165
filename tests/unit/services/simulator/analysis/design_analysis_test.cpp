// Metrics, files and the cache of evaluations.
#include "services/simulator/analysis/design_analysis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/base/files.h"
#include "common/render/image.h"
#include "services/simulator/analysis/analysis_report.h"
#include "services/simulator/analysis/case_outcome.h"
#include "services/simulator/worker/result_cache.h"
#include "tests/support/png_image.h"
#include "tests/unit/services/simulator/analysis/test_cases.h"

namespace mortise::simulator {
namespace {

TEST(Metrics, GeometryNeedsNoMesh) {
  const auto analysis = AnalyzeDesign(LoadedTable(), {"volume", "mass"}, false, {});
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_FALSE(analysis->mesh.has_value());
  EXPECT_EQ(analysis->metrics[0].unit, "m^3");
  EXPECT_NEAR(analysis->metrics[1].value, 450 * analysis->metrics[0].value, 1e-9);
  const double legs = 4 * 0.06 * 0.06 * 0.703, top = 1.4 * 0.8 * 0.027;
  const double aprons = 2 * 0.022 * 0.09 * (1.18 + 0.58);
  EXPECT_NEAR(analysis->metrics[0].value, legs + top + aprons, 1e-12);
}

TEST(Metrics, AreAllThereAndSensible) {
  std::vector<std::string> names;
  for (const MetricDescription& metric : OfferedMetrics()) names.push_back(metric.name);
  DesignModel table = LoadedTable();
  table.cost = Cost{12.5, "EUR"};
  for (Material& material : table.analysis.materials) material.conductivity = 0.12;
  table.heat = HeatCase{.materials = table.analysis.materials,
                        .temperatures = {},
                        .fluxes = {{{0, "z_max"}, 800}},
                        .convections = {{{1, "z_min"}, 10, 293.15}},
                        .sources = {}};
  const auto analysis = AnalyzeDesign(table, names, false, {});
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  ASSERT_EQ(analysis->metrics.size(), names.size());
  const std::vector<std::string> signless{"mass",
                                          "drag",
                                          "draught",
                                          "surface_area",
                                          "max_displacement",
                                          "max_von_mises",
                                          "relative_error",
                                          "max_temperature",
                                          "min_temperature",
                                          "mean_temperature",
                                          "heat_dissipation"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(analysis->metrics[i].name, names[i]);
    EXPECT_TRUE(std::isfinite(analysis->metrics[i].value)) << names[i];
    const bool is_positive = std::count(signless.begin(), signless.end(), names[i]) > 0;
    EXPECT_TRUE(!is_positive || analysis->metrics[i].value > 0) << names[i];
  }
}

TEST(Metrics, ThatADesignCannotHaveAreNamed) {
  DesignModel table = LoadedTable();
  for (Material& material : table.analysis.materials) material.density = 7850;
  const auto refused = AnalyzeDesign(table, {"mass", "draught"}, false, {});
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(AnalyzeDesign(table, {"cost"}, false, {}).status().code(),
            absl::StatusCode::kFailedPrecondition);
  DesignAnalysisOptions options;
  options.leave_out_inapplicable = true;
  const auto analysis = AnalyzeDesign(table, {"draught", "mass", "cost"}, false, options);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  ASSERT_EQ(analysis->metrics.size(), 1u);
  EXPECT_EQ(analysis->metrics[0].name, "mass");
  ASSERT_EQ(analysis->notes.size(), 2u);
  EXPECT_EQ(analysis->notes[0].rfind("draught: ", 0), 0u) << analysis->notes[0];
}

// Where parts touch they have no outside.
TEST(Metrics, SurfaceAreaIsThatOfTheOutside) {
  DesignModel model;
  model.surface = mesh::AssembleBoxes(
      {{"lower", {0, 0, 0}, {1, 1, 1}}, {"upper", {0.25, 0.25, 1}, {0.75, 0.75, 1.5}}});
  model.analysis.materials.assign(2, Spruce());
  const auto analysis = AnalyzeDesign(model, {"surface_area"}, false, {});
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_NEAR(analysis->metrics[0].value, 6 + 4 * 0.5 * 0.5, 1e-12);
  EXPECT_FALSE(analysis->mesh.has_value());
}

TEST(Metrics, AThickerTopDeflectsLess) {
  double previous = 1;
  for (const double top : {0.018, 0.027, 0.04}) {
    DesignModel model = LoadedTable();
    model.surface = mesh::TestTable(1.4, 0.8, 0.73, 0.06, 0.09, top);
    const auto analysis = AnalyzeDesign(model, {"max_displacement"}, false, {});
    ASSERT_TRUE(analysis.ok()) << analysis.status();
    EXPECT_LT(analysis->metrics[0].value, previous);
    previous = analysis->metrics[0].value;
  }
}

// The default mesh is good enough: refining changes the deflection by little.
TEST(Metrics, DefaultMeshIsConverged) {
  DesignAnalysisOptions fine;
  fine.mesh.element_size = 0.035;
  const auto coarse = AnalyzeDesign(LoadedTable(), {"max_displacement", "compliance"}, false, {});
  const auto refined =
      AnalyzeDesign(LoadedTable(), {"max_displacement", "compliance"}, false, fine);
  ASSERT_TRUE(coarse.ok() && refined.ok());
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(coarse->metrics[k].value, refined->metrics[k].value,
                0.03 * refined->metrics[k].value);
  }
}

// Euler's and Bernoulli's beam: f = λ² / 2π √(E I / ρ A L⁴), λ = 1.8751 clamped at one end
// and 4.7300 free at both. This one is forty times as long as it is thick.
TEST(Metrics, NaturalFrequencyIsThatOfABeam) {
  DesignModel beam = Cantilever(1, 0.025, 1, 0);
  const double unit = std::sqrt(10e9 / 1000 * 0.025 * 0.025 / 12) / (2 * std::acos(-1.0));
  const auto clamped = AnalyzeDesign(beam, {"natural_frequency"}, false, {});
  ASSERT_TRUE(clamped.ok()) << clamped.status();
  EXPECT_EQ(clamped->metrics[0].unit, "Hz");
  EXPECT_NEAR(clamped->metrics[0].value, 1.8751 * 1.8751 * unit, 0.005 * clamped->metrics[0].value);
  EXPECT_TRUE(clamped->cases.empty());
  EXPECT_EQ(clamped->vibration->rigid_motions, 0);
  beam.analysis.supports.clear();
  const auto free = AnalyzeDesign(beam, {"natural_frequency"}, false, {});
  ASSERT_TRUE(free.ok()) << free.status();
  EXPECT_EQ(free->vibration->rigid_motions, 6);
  EXPECT_NEAR(free->metrics[0].value, 4.73 * 4.73 * unit, 0.01 * free->metrics[0].value);
}

TEST(Metrics, AsManyModesAsAreWanted) {
  DesignAnalysisOptions options;
  options.modes = 4;
  options.mesh.quadratic = false;
  const auto analysis = AnalyzeDesign(LoadedTable(), {"natural_frequency", "mass"}, true, options);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  ASSERT_EQ(analysis->vibration->modes.size(), 4u);
  EXPECT_EQ(analysis->metrics[0].value, analysis->vibration->modes[0].frequency);
  const auto picture = DrawMode(*analysis->mesh, analysis->vibration->modes[1], "Table: mode 2");
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(testing::DecodePng(*picture)->width, 1200);
  if (const char* folder = std::getenv("MORTISE_PICTURES")) {
    ASSERT_TRUE(WriteFile(std::filesystem::path(folder) / "mode.png", *picture).ok());
  }
  const auto fields = ShapeFields(*analysis->vibration);
  ASSERT_EQ(fields.size(), 4u);
  EXPECT_EQ(fields[3].name.rfind("mode 4 (", 0), 0u) << fields[3].name;
  options.modes = 1'000'000;
  EXPECT_FALSE(AnalyzeDesign(LoadedTable(), {"mass"}, false, options).ok());
}

TEST(Reports, ShowTheStress) {
  const auto analysis = AnalyzeDesign(LoadedTable(), {"max_displacement"}, true, {});
  ASSERT_TRUE(analysis.ok());
  const auto picture =
      DrawStress(*analysis->mesh, analysis->cases[0].solution, "Table, 1000 N on the top");
  ASSERT_TRUE(picture.ok()) << picture.status();
  const auto image = testing::DecodePng(*picture);
  ASSERT_TRUE(image.ok());
  EXPECT_EQ(image->width, 1200);
  const auto fields = WriteFields(*analysis->mesh, analysis->cases[0].solution,
                                  analysis->cases[0].error->element_error, 0);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NE(fields->find("von Mises"), std::string::npos);
  if (const char* folder = std::getenv("MORTISE_PICTURES")) {
    ASSERT_TRUE(WriteFile(std::filesystem::path(folder) / "stress.png", *picture).ok());
    ASSERT_TRUE(WriteFile(std::filesystem::path(folder) / "analysis.vtu", *fields).ok());
  }
}

TEST(Caches, ForgetTheLeastRecentlyUsed) {
  ResultCache cache(2);
  cache.Store("a", "1");
  cache.Store("b", "2");
  EXPECT_EQ(cache.Find("a"), "1");
  cache.Store("c", "3");
  EXPECT_EQ(cache.Find("b"), std::nullopt);
  EXPECT_EQ(cache.Find("a"), "1");
  EXPECT_EQ(cache.Find("c"), "3");
  cache.Store("a", "4");
  EXPECT_EQ(cache.Find("a"), "4");
  EXPECT_EQ(cache.size(), 2u);
}

}  // namespace
}  // namespace mortise::simulator
