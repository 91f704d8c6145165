// Uploaded meshes: what is computed of them held against exact answers.
#include "services/simulator/analysis/mesh_analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "tests/unit/services/simulator/worker/analysed_mesh.h"

namespace mortise::simulator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::vector<std::string>> Rows(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  for (const absl::string_view line : absl::StrSplit(csv, '\n', absl::SkipEmpty())) {
    rows.push_back(absl::StrSplit(line, ','));
  }
  return rows;
}

// A bar that is pulled, and one that stretches under its own weight.
TEST(MeshAnalysis, ABarIsPulledAndStretchesUnderItsWeight) {
  const v1::MeshCase mesh_case = Case(R"({
    "title": "Bar", "length_unit": "mm", "materials": [STEEL],
    "supports": [{"groups": ["x_min"], "symmetric": true},
                 {"groups": ["y_min"], "symmetric": true},
                 {"groups": ["z_min"], "displacement": {"z": 0}}],
    "load_cases": [
      {"name": "Pull, 1 kN!", "forces": [{"groups": ["x_max"], "force": {"x": 1000}}]},
      {"name": "weight", "gravity": {"x": 9.81}},
      {"name": "pressure", "pressures": [{"groups": ["x_max"], "pressure": -1000}]},
      {"name": "traction", "tractions": [{"groups": ["x_max"], "traction": {"x": 1000}}]}],
    "combinations": [{"name": "both", "terms": [{"load_case": "weight", "factor": 2},
                                                {"load_case": "traction", "factor": -3}]}],
    "probes": [{"name": "end", "points": [{"x": 2000, "y": 300, "z": 700}]}]})");
  const Analysed analysed = Analyse(Box(true), mesh_case, {.threads = 2, .pictures = false});
  ASSERT_TRUE(analysed.analysis.ok()) << analysed.analysis.status();
  EXPECT_NEAR(analysed.analysis->volume, 2, 1e-12);
  EXPECT_NEAR(analysed.analysis->mass, 15600, 1e-8);
  ASSERT_EQ(analysed.analysis->cases.size(), 5u);
  const auto rows = Rows(analysed.files.at("probes.csv"));
  ASSERT_EQ(rows.size(), 6u);
  constexpr int kUx = 7, kVonMises = 16;  // a comma in the first name moves columns by one
  for (int c = 0; c < 5; ++c) {
    const CaseOutcome& outcome = analysed.analysis->cases[c];
    EXPECT_LT((outcome.summary.total_load + outcome.summary.total_reaction).norm(), 1e-6);
    // Everything that pulls along x comes out at the first support.
    EXPECT_NEAR(outcome.reactions[0].x(), -outcome.summary.total_load.x(), 1e-6);
  }
  const double pulled = 1000 * 2 / 2.1e11;
  EXPECT_NEAR(std::stod(rows[1][kUx + 1]), pulled, 1e-8 * pulled);
  EXPECT_NEAR(std::stod(rows[1][kVonMises + 1]), 1000, 1e-5);
  EXPECT_NEAR(analysed.analysis->cases[0].relative_error, 0, 1e-9);
  EXPECT_NEAR(analysed.analysis->cases[0].summary.strain_energy, 0.5 * 1000 * pulled, 1e-12);
  EXPECT_NEAR(analysed.analysis->cases[0].part_safety_factor[0], 2.5e8 / 1000, 1);
  const double weight = 7800 * 9.81 * 2 * 2 / (2 * 2.1e11);
  EXPECT_NEAR(std::stod(rows[2][kUx]), weight, 0.01 * weight);
  for (int c : {3, 4}) EXPECT_NEAR(std::stod(rows[c][kUx]), pulled, 1e-8 * pulled);
  EXPECT_NEAR(std::stod(rows[5][kUx]), 2 * std::stod(rows[2][kUx]) - 3 * pulled, 1e-6 * pulled);
  for (const char* name : {"1-pull-1-kn.vtu", "5-both.vtu"}) {
    EXPECT_TRUE(analysed.files.contains(name)) << name;
  }
  EXPECT_THAT(analysed.files.at("2-weight.vtu"), HasSubstr("maximum principal stress (Pa)"));
}

// A linear displacement on the whole surface is that of every node within, in any format and unit.
TEST(MeshAnalysis, ALinearFieldIsReproducedWhateverTheFormat) {
  const mesh::GroupedMesh box = testing::GroupedBox({2, 1, 1}, {4, 2, 2}, true);
  std::vector<std::string> files{testing::WriteGmsh22(box, false), testing::WriteGmsh22(box, true),
                                 testing::WriteGmsh41(box, false), testing::WriteGmsh41(box, true),
                                 testing::WriteAbaqus(box)};
  std::vector<double> energies;
  for (const std::string& file : files) {
    const auto mesh = mesh::ReadGroupedMesh(file);
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    // u = (1e-3 x, 0, 0) by three planes; v and w by their symmetry planes on both sides.
    const Analysed analysed = Analyse(*mesh, Case(R"({
      "length_unit": "in", "materials": [{"groups": ["low", "high"], "values": {"density": 1,
        "youngs_modulus": 1e9, "poissons_ratio": 0.25}}],
      "supports": [{"groups": ["x_min"], "displacement": {"x": 0}},
                   {"groups": ["tip"], "displacement": {"x": 5.08e-5}},
                   {"groups": ["y_min", "y_max"], "displacement": {"y": 0}},
                   {"groups": ["z_min", "z_max"], "symmetric": true}],
      "load_cases": [{"name": "stretch"}],
      "probes": [{"name": "inside", "points": [{"x": 0.7, "y": 0.4, "z": 0.3}]}]})"));
    ASSERT_TRUE(analysed.analysis.ok()) << analysed.analysis.status();
    const auto rows = Rows(analysed.files.at("probes.csv"));
    EXPECT_NEAR(std::stod(rows[1][4]), 0.7 * 0.0254, 1e-12);
    EXPECT_NEAR(std::stod(rows[1][7]), 1e-3 * 0.7 * 0.0254, 1e-14);
    EXPECT_NEAR(std::stod(rows[1][8]), 0, 1e-14);
    // λ + 2μ = 1.2e9 Pa.
    EXPECT_NEAR(std::stod(rows[1][10]), 1.2e6, 1e-2);
    EXPECT_NEAR(analysed.analysis->cases[0].relative_error, 0, 1e-9);
    energies.push_back(analysed.analysis->cases[0].summary.strain_energy);
  }
  for (const double energy : energies) EXPECT_NEAR(energy, energies[0], 1e-12 * energies[0]);
  EXPECT_NEAR(energies[0], 0.5 * 1.2e9 * 1e-6 * 2 * std::pow(0.0254, 3), 1e-12);
}

// A wall between fixed temperature and convection.
TEST(MeshAnalysis, HeatFlowsThroughAWall) {
  const Analysed analysed = Analyse(Box(false), Case(R"({
    "length_unit": "mm", "materials": [STEEL],
    "heat": {"temperatures": [{"groups": ["x_min"], "temperature": 80}],
             "convections": [{"groups": ["x_max"], "coefficient": 500, "ambient": 20}]},
    "probes": [{"name": "end", "groups": ["tip"]}]})"),
                                    {});
  ASSERT_TRUE(analysed.analysis.ok()) << analysed.analysis.status();
  const double flux = 60 / (2.0 / 50 + 1.0 / 500);  // W/m², through 1 m²
  const HeatOutcome& heat = *analysed.analysis->heat;
  EXPECT_NEAR(heat.maximum, 80, 1e-9);
  EXPECT_NEAR(heat.minimum, 80 - flux * 2 / 50, 1e-8);
  EXPECT_NEAR(heat.through_temperatures, flux, 1e-6);
  EXPECT_THAT(heat.convected, ElementsAre(::testing::DoubleNear(flux, 1e-6)));
  const auto rows = Rows(analysed.files.at("probes.csv"));
  ASSERT_EQ(rows.size(), 10u);  // nine nodes, called as in the file
  EXPECT_EQ(rows[1][1], "node");
  EXPECT_EQ(rows[1][2], std::to_string(10 + 3 * 4));
  EXPECT_NEAR(std::stod(rows[1].back()), heat.minimum, 1e-6);
  EXPECT_TRUE(analysed.files.contains("heat.vtu"));
  EXPECT_TRUE(analysed.files.contains("heat.png"));
}

// A body that is warm all over grows without stress, and presses where it may not.
TEST(MeshAnalysis, WarmthStretchesAndPresses) {
  const auto warm = [](const char* end) {
    return Analyse(Box(true), Case(absl::StrCat(R"({
      "length_unit": "mm", "materials": [STEEL],
      "supports": [{"groups": ["x_min"], "symmetric": true},
                   {"groups": ["y_min"], "symmetric": true},
                   {"groups": ["z_min"], "symmetric": true})",
                                                end, R"(],
      "heat": {"temperatures": [{"groups": ["z_max"], "temperature": 80}],
               "reference_temperature": 30},
      "load_cases": [{"name": "warmth", "thermal_stress": true}],
      "probes": [{"name": "end", "points": [{"x": 2000, "y": 500, "z": 500}]}]})")));
  };
  const Analysed free = warm("");
  ASSERT_TRUE(free.analysis.ok()) << free.analysis.status();
  const auto rows = Rows(free.files.at("probes.csv"));
  ASSERT_EQ(rows.size(), 3u);  // heat, and the load case
  EXPECT_NEAR(std::stod(rows[2][7]), 1.2e-5 * 50 * 2, 1e-9);
  EXPECT_NEAR(std::stod(rows[2].back()), 80, 1e-9);
  EXPECT_LT(free.analysis->cases[0].maximum_von_mises, 1);
  const Analysed held = warm(R"(, {"groups": ["x_max"], "displacement": {"x": 0}})");
  ASSERT_TRUE(held.analysis.ok()) << held.analysis.status();
  EXPECT_NEAR(held.analysis->cases[0].maximum_von_mises, 2.1e11 * 1.2e-5 * 50, 100);
}

// An expansion of 0 may be one that nobody knows: what comes of it must not pass for a result.
TEST(MeshAnalysis, AnUnknownExpansionIsNoted) {
  const auto notes = [](const char* expansion, const char* stress) {
    const Analysed analysed = Analyse(Box(false), Case(absl::StrCat(R"({
      "length_unit": "mm",
      "materials": [{"values": {"density": 7850, "youngs_modulus": 2.1e11, "poissons_ratio": 0.3,
                                "thermal_conductivity": 50)",
                                                                    expansion, R"(}}],
      "supports": [{"groups": ["x_min"], "fixed": true}],
      "heat": {"temperatures": [{"groups": ["z_max"], "temperature": 80}],
               "reference_temperature": 30},
      "load_cases": [{"name": "all", "gravity": {"z": -9.81})",
                                                                    stress, "}]}")));
    EXPECT_TRUE(analysed.analysis.ok()) << analysed.analysis.status();
    return analysed.analysis.ok() ? analysed.analysis->notes : std::vector<std::string>();
  };
  constexpr char kStress[] = R"(, "thermal_stress": true)";
  EXPECT_THAT(notes("", kStress), ElementsAre(::testing::HasSubstr("the thermal expansion of")));
  EXPECT_THAT(notes(R"(, "thermal_expansion": 1.2e-5)", kStress), ::testing::IsEmpty());
  EXPECT_THAT(notes("", ""), ::testing::IsEmpty());
}

// Sources in a group of elements, and a temperature held at nodes.
TEST(MeshAnalysis, SourcesInGroupsHeatThem) {
  const Analysed analysed = Analyse(Box(true), Case(R"({
    "length_unit": "mm", "materials": [STEEL],
    "heat": {"temperatures": [{"groups": ["tip"], "temperature": 10}],
             "sources": [{"groups": ["low"], "power": 100}, {"power": 1}],
             "fluxes": [{"groups": ["y_max"], "flux": 3}]}})"));
  ASSERT_TRUE(analysed.analysis.ok()) << analysed.analysis.status();
  EXPECT_NEAR(analysed.analysis->heat->supplied, 100 * 1 + 1 * 2 + 3 * 2, 1e-9);
  EXPECT_NEAR(analysed.analysis->heat->through_temperatures, -108, 1e-6);
}

// Waves along a bar whose sides slide: f = c / (4 L), c² = (λ + 2μ) / ρ.
TEST(MeshAnalysis, FrequenciesAreThoseOfWavesAlongABar) {
  const Analysed analysed =
      Analyse(testing::GroupedBox({2000, 200, 200}, {6, 1, 1}, true), Case(R"({
    "length_unit": "mm",
    "materials": [{"groups": ["low"], "values": {"density": 1000, "youngs_modulus": 1e9}},
                  {"groups": ["high"], "values": {"density": 1000, "youngs_modulus": 1e9}}],
    "supports": [{"groups": ["x_min"], "fixed": true},
                 {"groups": ["y_min", "y_max"], "displacement": {"y": 0}},
                 {"groups": ["z_min", "z_max"], "displacement": {"z": 0}}],
    "modes": 2})"));
  ASSERT_TRUE(analysed.analysis.ok()) << analysed.analysis.status();
  ASSERT_EQ(analysed.analysis->modes.size(), 2u);
  EXPECT_NEAR(analysed.analysis->modes[0].frequency, 1000.0 / 8, 0.01);
  EXPECT_NEAR(analysed.analysis->modes[1].frequency, 3 * 1000.0 / 8, 0.5);
  EXPECT_TRUE(analysed.files.contains("modes.vtu"));
}

// A plank whose grain runs along x, or along y.
TEST(MeshAnalysis, GrainRunsAlongItsAxes) {
  const std::string wood = R"({
    "length_unit": "mm", "materials": [{"values": {"density": 450, "orthotropic": {
      "youngs_modulus": [1e10, 8e8, 5e8], "poissons_ratio": [0.3, 0.4, 0.3],
      "shear_modulus": [7e8, 4e7, 6e8]}}, "axes": {"grain": GRAIN, "radial": {"z": 1}}}],
    "supports": [{"groups": ["x_min"], "symmetric": true}, {"groups": ["y_min"], "symmetric": true},
                 {"groups": ["z_min"], "symmetric": true}],
    "load_cases": [{"name": "pull", "nodal_forces": [], "body_force": {"x": 0},
                    "forces": [{"groups": ["x_max"], "force": {"x": 1000}}]}]})";
  const auto stretch = [&](const char* grain) {
    const Analysed analysed =
        Analyse(Box(false), Case(absl::StrReplaceAll(wood, {{"GRAIN", grain}})));
    EXPECT_TRUE(analysed.analysis.ok()) << analysed.analysis.status();
    return analysed.analysis.ok() ? analysed.analysis->cases[0].summary.compliance / 1000 : 0;
  };
  EXPECT_NEAR(stretch(R"({"x": 2})"), 1000 * 2 / 1e10, 1e-15);
  EXPECT_NEAR(stretch(R"({"y": 1})"), 1000 * 2 / 5e8, 1e-14);  // the tangent lies along x
}

TEST(MeshAnalysis, PointAndNodalForcesTurningAndBodyForces) {
  const Analysed analysed = Analyse(Box(true), Case(R"({
    "length_unit": "mm", "materials": [STEEL],
    "supports": [{"groups": ["x_min"], "fixed": true}],
    "load_cases": [
      {"name": "point", "point_forces": [{"position": {"x": 2000, "y": 500, "z": 500},
                                          "force": {"z": -100}}]},
      {"name": "nodes", "nodal_forces": [{"groups": ["tip"], "force": {"z": -4}}]},
      {"name": "turning", "rotation": {"point": {"y": 500, "z": 500},
                                       "angular_velocity": {"z": 10}}},
      {"name": "field", "body_force": {"y": 50}}]})"));
  ASSERT_TRUE(analysed.analysis.ok()) << analysed.analysis.status();
  const auto& cases = analysed.analysis->cases;
  EXPECT_NEAR(cases[0].summary.total_load.z(), -100, 1e-9);
  EXPECT_NEAR(cases[1].summary.total_load.z(), -4 * 25, 1e-9);
  EXPECT_NEAR(cases[2].summary.total_load.x(), 7800 * 100 * 2, 1e-5);  // ρ ω² ∫ x dV
  EXPECT_NEAR(cases[3].summary.total_load.y(), 100, 1e-9);
}

TEST(MeshAnalysis, ThreadsDoNotChangeTheResult) {
  const Analysed one = Analyse(Box(true), Case(kGoodCase), {.threads = 1});
  const Analysed three = Analyse(Box(true), Case(kGoodCase), {.threads = 3});
  ASSERT_TRUE(one.analysis.ok() && three.analysis.ok());
  EXPECT_TRUE(one.files.contains("1-pull.png"));
  EXPECT_EQ(one.files, three.files);
}

// What was analysed is told first, as a case that can be given again.
TEST(MeshAnalysis, EveryStageIsTold) {
  const v1::MeshCase mesh_case = Case(R"({
    "length_unit": "mm", "materials": [STEEL], "modes": 1,
    "supports": [{"groups": ["x_min"], "fixed": true}],
    "load_cases": [{"name": "weight", "gravity": {"x": 9.81}},
                   {"name": "warm", "thermal_stress": true}],
    "combinations": [{"name": "both", "terms": [{"load_case": "weight", "factor": 1},
                                                {"load_case": "warm", "factor": 1}]}],
    "heat": {"temperatures": [{"groups": ["x_min"], "temperature": 50}],
             "reference_temperature": 20}})");
  StageProgress progress;
  std::vector<std::string> stages;
  const auto model = MakeMeshModel(Box(true), mesh_case);
  ASSERT_TRUE(model.ok()) << model.status();
  progress.Expect(StagesOf(*model));
  const auto analysis =
      AnalyzeMesh(*model, {.pictures = false, .progress = &progress}, [&](const AnalysisFile&) {
        stages.push_back(progress.state().stage);
        return absl::OkStatus();
      });
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_THAT(stages, ElementsAre("heat: files", "heat: files", "load case 1 of 2: files",
                                  "load case 2 of 2: files", "combination 1 of 1: files",
                                  "frequencies: files"));
  // All have begun, and all but the last are behind.
  EXPECT_EQ(progress.state().done, StagesOf(*model) - 1);
  EXPECT_EQ(progress.state().total, StagesOf(*model));
}

TEST(MeshAnalysis, TheCaseIsKeptBesideTheResults) {
  const v1::MeshCase mesh_case = Case(kGoodCase);
  const auto model = MakeMeshModel(Box(false), mesh_case);
  ASSERT_TRUE(model.ok()) << model.status();
  std::vector<std::string> names;
  const auto analysis = AnalyzeMesh(*model, {.pictures = false}, [&](const AnalysisFile& file) {
    if (names.empty()) {
      EXPECT_EQ(Case(file.bytes).SerializeAsString(), mesh_case.SerializeAsString());
    }
    names.push_back(file.name);
    return absl::OkStatus();
  });
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_THAT(names, ElementsAre("case.json", "1-pull.vtu"));
}

}  // namespace
}  // namespace mortise::simulator
