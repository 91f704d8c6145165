// Uploaded meshes: cases checked, groups found, and what is computed held against exact answers.
#include "services/simulator/mesh_analysis.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/mesh_case.h"
#include "services/simulator/mesh_model.h"
#include "tests/support/mesh_files.h"

namespace mortise::simulator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Steel, in place.
constexpr char kSteel[] =
    R"({"values": {"density": 7800, "youngs_modulus": 2.1e11, "poissons_ratio": 0.3,
        "strength": 2.5e8, "thermal_expansion": 1.2e-5, "thermal_conductivity": 50}})";

v1::MeshCase Case(const std::string& json) {
  v1::MeshCase mesh_case;
  const auto status = google::protobuf::util::JsonStringToMessage(
      absl::StrReplaceAll(json, {{"STEEL", kSteel}}), &mesh_case);
  EXPECT_TRUE(status.ok()) << status.message();
  return mesh_case;
}

struct Analysed {
  absl::StatusOr<MeshAnalysis> analysis = absl::UnknownError("not run");
  std::map<std::string, std::string> files;
};

Analysed Analyse(const mesh::GroupedMesh& mesh, const v1::MeshCase& mesh_case,
                 const MeshAnalysisOptions& options = {.pictures = false}) {
  Analysed analysed;
  analysed.analysis = [&]() -> absl::StatusOr<MeshAnalysis> {
    MORTISE_RETURN_IF_ERROR(CheckMeshCase(mesh_case, "case"));
    MORTISE_ASSIGN_OR_RETURN(const MeshModel model, MakeMeshModel(mesh, mesh_case));
    return AnalyzeMesh(model, options, [&](AnalysisFile file) {
      analysed.files[file.name] = std::move(file.bytes);
      return absl::OkStatus();
    });
  }();
  return analysed;
}

// In millimetres: 2 × 1 × 1 m.
mesh::GroupedMesh Box(bool quadratic, const Eigen::Vector3i& cells = {4, 2, 2}) {
  return testing::GroupedBox({2000, 1000, 1000}, cells, quadratic);
}

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

constexpr char kGood[] = R"({
  "length_unit": "mm", "materials": [{"groups": ["low", "high"], "values": {"density": 7800,
    "youngs_modulus": 2e11, "poissons_ratio": 0.3}}],
  "supports": [{"groups": ["x_min"], "fixed": true}],
  "load_cases": [{"name": "pull", "forces": [{"groups": ["x_max"], "force": {"x": 1}}]}]})";

// How the case is refused once `from` has become `to`: "field: message".
std::string Refusal(const std::string& from, const std::string& to,
                    const mesh::GroupedMesh& mesh = Box(false)) {
  const std::string json = absl::StrReplaceAll(kGood, {{from, to}});
  EXPECT_NE(json, kGood);
  const Analysed analysed = Analyse(mesh, Case(json));
  EXPECT_TRUE(analysed.files.empty());
  const absl::Status& status = analysed.analysis.status();
  const std::string field = DetailOf(status).field;
  return absl::StartsWith(status.message(), field)
             ? std::string(status.message())
             : absl::StrCat(field, ": ", std::string(status.message()));
}

TEST(MeshAnalysis, GroupsThatAreNotThereAreNamed) {
  EXPECT_THAT(
      Refusal("[\"x_max\"]", "[\"X-max\"]"),
      HasSubstr("case.load_cases[0].forces[0].groups[0]: there is no group of faces 'X-max';"
                " did you mean 'x_max'?"));
  EXPECT_THAT(Refusal("[\"x_min\"]", "[\"wall of the house\"]"),
              HasSubstr("case.supports[0].groups[0]: there is no group of faces or nodes 'wall of "
                        "the house'; there are 'x_max', 'x_min'"));
  EXPECT_THAT(Refusal("[\"x_max\"]", "[\"tip\"]"), HasSubstr("'tip' is a group of nodes"));
  EXPECT_THAT(Refusal("\"forces\"", "\"nodal_forces\""), HasSubstr("'x_max' is a group of faces"));
  EXPECT_THAT(Refusal("\"low\"", "\"lwo\""),
              HasSubstr("case.materials[0].groups[0]: there is no group of elements 'lwo'; did you "
                        "mean 'low'?"));
  mesh::GroupedMesh mesh = Box(false);
  mesh.face_groups[0].members.clear();
  EXPECT_THAT(Refusal("\"x\": 1", "\"x\": 2", mesh), HasSubstr("group of faces 'x_max' is empty"));
}

TEST(MeshAnalysis, ElementsHaveOneMaterial) {
  EXPECT_THAT(Refusal("[\"low\", \"high\"]", "[\"low\"]"),
              HasSubstr("case.materials: 48 elements of group 'high' have no material"));
  mesh::GroupedMesh mesh = Box(false);
  mesh.element_groups[0].members.resize(40);
  EXPECT_THAT(Refusal("\"x\": 1", "\"x\": 2", mesh),
              HasSubstr("8 elements that are in no group have no material"));
  EXPECT_THAT(Refusal("\"materials\": [", R"("materials": [{"groups": ["low"], "values":
                      {"density": 1, "youngs_modulus": 1}}, )"),
              HasSubstr("48 elements of 'low and 1 more' have a material already, of 'low'"));
}

TEST(MeshAnalysis, BadElementsAreCounted) {
  mesh::GroupedMesh mesh = Box(false);
  for (const int e : {7, 9, 30}) std::swap(mesh.tetrahedra(0, e), mesh.tetrahedra(1, e));
  const std::string refusal = Refusal("\"x\": 1", "\"x\": 2", mesh);
  EXPECT_THAT(refusal, HasSubstr("mesh_file: 3 of 96 elements are inverted or have no volume"));
  EXPECT_THAT(refusal, HasSubstr("element 5014"));
  mesh = Box(true);
  mesh.nodes.col(mesh.tetrahedra(4, 11)) = mesh.nodes.col(mesh.tetrahedra(3, 11));
  EXPECT_THAT(Refusal("\"x\": 1", "\"x\": 2", mesh), HasSubstr("inverted or have no volume"));
}

TEST(MeshAnalysis, WhatIsFreeToMoveIsNamed) {
  EXPECT_THAT(Refusal("\"fixed\": true", "\"displacement\": {\"x\": 0}"),
              HasSubstr("case.supports: part 'low and 1 more' is free to"));
  EXPECT_THAT(Refusal("{\"groups\": [\"x_min\"], \"fixed\": true}", ""), HasSubstr("free to"));
  // A second piece, which nothing holds.
  mesh::GroupedMesh mesh = Box(false);
  const int nodes = static_cast<int>(mesh.nodes.cols());
  mesh.nodes.conservativeResize(3, 2 * nodes);
  mesh.nodes.rightCols(nodes) = mesh.nodes.leftCols(nodes).colwise() + Eigen::Vector3d(0, 5000, 0);
  const int elements = static_cast<int>(mesh.tetrahedra.cols());
  mesh.tetrahedra.conservativeResize(4, 2 * elements);
  mesh.tetrahedra.rightCols(elements) = mesh.tetrahedra.leftCols(elements).array() + nodes;
  for (int e = 0; e < elements; ++e) {
    mesh.element_numbers.push_back(100'000 + e);
    mesh.element_groups[1].members.push_back(elements + e);
  }
  EXPECT_THAT(Refusal("\"x\": 1", "\"x\": 2", mesh),
              HasSubstr("the piece near (1000, 5500, 500) mm of part 'low and 1 more' is free to"));
}

TEST(MeshAnalysis, CasesAreRefusedByField) {
  EXPECT_THAT(Refusal("\"length_unit\": \"mm\",", ""), HasSubstr("case.length_unit: is missing"));
  EXPECT_THAT(Refusal("\"mm\"", "\"furlong\""), HasSubstr("case.length_unit: is none"));
  EXPECT_THAT(Refusal("2e11", "-2e11"), HasSubstr("case.materials[0].values.youngs_modulus"));
  EXPECT_THAT(Refusal("2e11", "0"), HasSubstr("case.materials[0].values.youngs_modulus"));
  EXPECT_THAT(Refusal("0.3", "0.5"), HasSubstr("case.materials[0].values.poissons_ratio"));
  EXPECT_THAT(Refusal("7800", "0"), HasSubstr("case.materials[0].values.density"));
  EXPECT_THAT(Refusal("\"fixed\": true", "\"fixed\": false"), HasSubstr("case.supports[0].fixed"));
  EXPECT_THAT(Refusal(", \"fixed\": true", ""), HasSubstr("case.supports[0].fixed"));
  EXPECT_THAT(Refusal("\"fixed\": true", "\"displacement\": {}"), HasSubstr("supports[0].displac"));
  EXPECT_THAT(Refusal("[\"x_min\"]", "[]"), HasSubstr("case.supports[0].groups"));
  EXPECT_THAT(Refusal("\"pull\"", "\"\""), HasSubstr("case.load_cases[0].name"));
  EXPECT_THAT(Refusal("\"pull\",", "\"pull\", \"thermal_stress\": true,"),
              HasSubstr("case.load_cases[0].thermal_stress"));
  EXPECT_THAT(Refusal("\"load_cases\"", R"("combinations": [{"name": "pull",
                      "terms": [{"load_case": "pull", "factor": 1}]}], "load_cases")"),
              HasSubstr("case.combinations[0].name"));
  EXPECT_THAT(Refusal("\"load_cases\"", R"("combinations": [{"name": "sum",
                      "terms": [{"load_case": "push"}]}], "load_cases")"),
              HasSubstr("case.combinations[0].terms[0].load_case: there is no load case 'push'"));
  EXPECT_THAT(Refusal("\"load_cases\"", "\"modes\": 101, \"load_cases\""), HasSubstr("case.modes"));
  EXPECT_THAT(Refusal("\"load_cases\"", "\"heat\": {}, \"load_cases\""),
              HasSubstr("case.materials[0].values.thermal_conductivity"));
  EXPECT_THAT(Refusal("\"forces\"", R"("point_forces": [{"position": {"x": 9000},
                      "force": {"x": 1}}], "forces")"),
              HasSubstr("case.load_cases[0].point_forces[0].position: lies outside the body"));
  EXPECT_THAT(Refusal("\"supports\"", R"("probes": [{"name": "a", "points": [{"z": -900}]}],
                      "supports")"),
              HasSubstr("case.probes[0].points[0]: lies outside"));
  EXPECT_THAT(Refusal("\"fixed\": true}", R"("fixed": true},
                      {"groups": ["y_min"], "displacement": {"x": 1}})"),
              HasSubstr("case.supports[1].displacement: contradicts"));
}

// A number that was forgotten is not taken for 0.
TEST(MeshAnalysis, MissingNumbersAreNamed) {
  EXPECT_THAT(Refusal(", \"force\": {\"x\": 1}", ""),
              HasSubstr("case.load_cases[0].forces[0].force: is missing"));
  const auto in_load_case = [](const char* list, const char* field) {
    EXPECT_THAT(
        Refusal("\"forces\"",
                absl::StrCat("\"", list, "\": [{\"groups\": [\"x_max\"]}], \"forces\"")),
        HasSubstr(absl::StrCat("case.load_cases[0].", list, "[0].", field, ": is missing")));
  };
  in_load_case("pressures", "pressure");
  in_load_case("tractions", "traction");
  in_load_case("nodal_forces", "force");
  EXPECT_THAT(Refusal("\"forces\"", R"("point_forces": [{"force": {"x": 1}}], "forces")"),
              HasSubstr("case.load_cases[0].point_forces[0].position: is missing"));
  EXPECT_THAT(Refusal("\"load_cases\"", R"("combinations": [{"name": "sum",
                      "terms": [{"load_case": "pull"}]}], "load_cases")"),
              HasSubstr("case.combinations[0].terms[0].factor: is missing"));
  const auto in_heat = [](const char* list, const char* given, const char* field) {
    const std::string json = absl::StrReplaceAll(
        kGood,
        {{"\"density\"", "\"thermal_conductivity\": 50, \"density\""},
         {"\"load_cases\"", absl::StrCat("\"heat\": {\"", list, "\": [{\"groups\": [\"x_max\"]",
                                         given, "}]}, \"load_cases\"")}});
    EXPECT_THAT(CheckMeshCase(Case(json), "case").message(),
                HasSubstr(absl::StrCat("case.heat.", list, "[0].", field, ": is missing")));
  };
  in_heat("temperatures", "", "temperature");
  in_heat("fluxes", "", "flux");
  in_heat("convections", ", \"coefficient\": 10", "ambient");
  in_heat("sources", "", "power");
}

// Supports that are moved are so in every load case.
TEST(MeshAnalysis, SumsMoveSupportsOnce) {
  const auto sum = [](const char* first, const char* second) {
    return absl::StrReplaceAll(
        kGood,
        {{"\"fixed\": true", "\"displacement\": {\"x\": 1e-5, \"y\": 0, \"z\": 0}"},
         {"\"load_cases\"", absl::StrCat("\"combinations\": [{\"name\": \"sum\", \"terms\": [",
                                         "{\"load_case\": \"pull\", \"factor\": ", first,
                                         "}, {\"load_case\": \"pull\", \"factor\": ", second,
                                         "}]}], \"load_cases\"")}});
  };
  EXPECT_THAT(CheckMeshCase(Case(sum("1.35", "1.5")), "case").message(),
              HasSubstr("case.combinations[0].terms: has factors that add up to 2.85"));
  EXPECT_TRUE(CheckMeshCase(Case(sum("0.4", "0.6")), "case").ok());
}

// Numbers that no result can hold.
TEST(MeshAnalysis, WhatIsNotFiniteIsRefused) {
  EXPECT_THAT(Refusal("\"x\": 1}", "\"x\": 1e308}"),
              HasSubstr("case.load_cases[0].forces[0].force.x: is beyond 1e+30"));
  EXPECT_THAT(Refusal("\"density\": 7800", "\"density\": 1e31"),
              HasSubstr("case.materials[0].values.density: is beyond"));
  mesh::GroupedMesh mesh = Box(false);
  mesh.nodes *= 1e40;
  EXPECT_THAT(Refusal("\"x\": 1", "\"x\": 2", mesh), HasSubstr("a coordinate is too large"));
  // Whatever else is beyond measure: refused, or every number is finite.
  for (const auto& [from, to] : std::map<std::string, std::string>{
           {"2e11", "1e30"},
           {"2e11,", "1e-300,"},
           {"\"fixed\": true", "\"displacement\": {\"x\": 1e30, \"y\": 0, \"z\": 0}"},
           {"\"load_cases\"", R"("combinations": [{"name": "sum", "terms": [{"load_case": "pull",
            "factor": 1e30}, {"load_case": "pull", "factor": -1e30}]}], "load_cases")"},
           {"\"poissons_ratio\": 0.3}", R"("poissons_ratio": 0.3, "thermal_conductivity": 1e-300}}],
            "heat": {"temperatures": [{"groups": ["tip"], "temperature": 1e30}], "sources":
            [{"power": 1e30}]}, "probes": [{"name": "a", "groups": ["tip"])"}}) {
    const std::string json = absl::StrReplaceAll(kGood, {{from, to}});
    ASSERT_NE(json, kGood);
    const Analysed analysed = Analyse(Box(false), Case(json));
    if (!analysed.analysis.ok()) {
      EXPECT_FALSE(DetailOf(analysed.analysis.status()).reason.empty()) << json;
      continue;
    }
    for (const CaseOutcome& outcome : analysed.analysis->cases) {
      EXPECT_TRUE(std::isfinite(outcome.summary.maximum_displacement)) << json;
      EXPECT_TRUE(std::isfinite(outcome.maximum_von_mises)) << json;
      EXPECT_TRUE(std::isfinite(outcome.summary.compliance)) << json;
      EXPECT_TRUE(std::isfinite(outcome.relative_error)) << json;
    }
  }
}

TEST(MeshAnalysis, LoadsNeedTheOutside) {
  mesh::GroupedMesh mesh = Box(false);
  // The first side that another element has too.
  mesh::FaceGroup inner{"z_inner", {}};
  for (int e = 0; e < mesh.tetrahedra.cols() && inner.members.empty(); ++e) {
    for (int side = 0; side < 4 && inner.members.empty(); ++side) {
      bool is_outer = false;
      for (const mesh::FaceGroup& group : mesh.face_groups) {
        is_outer = is_outer || std::binary_search(group.members.begin(), group.members.end(),
                                                  mesh::ElementSide{e, side});
      }
      if (!is_outer) inner.members.push_back({e, side});
    }
  }
  mesh.face_groups.push_back(inner);
  EXPECT_THAT(Refusal("[\"x_max\"]", "[\"z_inner\"]", mesh), HasSubstr("lie between elements"));
}

TEST(MeshAnalysis, MemoryIsLimitedBeforeItIsTaken) {
  const Analysed analysed =
      Analyse(Box(true), Case(kGood), {.memory_limit = 1e5, .pictures = false});
  EXPECT_EQ(analysed.analysis.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(CheckMemory(1'000'000'000, 800'000'000, 1, 8e9).code(),
            absl::StatusCode::kResourceExhausted);
  EXPECT_TRUE(CheckMemory(280'000, 200'000, 3, 8e9).ok());
}

TEST(MeshAnalysis, ThreadsDoNotChangeTheResult) {
  const Analysed one = Analyse(Box(true), Case(kGood), {.threads = 1});
  const Analysed three = Analyse(Box(true), Case(kGood), {.threads = 3});
  ASSERT_TRUE(one.analysis.ok() && three.analysis.ok());
  EXPECT_TRUE(one.files.contains("1-pull.png"));
  EXPECT_EQ(one.files, three.files);
}

// A group of all nodes, named often enough, would outgrow the mesh by far.
TEST(MeshAnalysis, ConditionsThatMultiplyAMeshAreRefused) {
  mesh::GroupedMesh mesh = testing::GroupedBox({1, 1, 1}, {10, 10, 10}, false);
  mesh::NodeGroup all{"all", {}};
  for (int v = 0; v < mesh.nodes.cols(); ++v) all.members.push_back(v);
  mesh.node_groups.push_back(all);
  const auto list = [&](const v1::MeshCase& mesh_case) {
    EXPECT_TRUE(CheckMeshCase(mesh_case, "case").ok());
    const absl::Status status = MakeMeshModel(mesh, mesh_case).status();
    return status.ok() ? "" : absl::IsResourceExhausted(status) ? DetailOf(status).field : "else";
  };
  v1::MeshCase supports = Case(kGood), repeated = supports, loads = supports, probes = supports;
  for (int i = 0; i < 100; ++i) {
    v1::MeshSupport& support = *supports.add_supports();
    support.add_groups("all");
    support.set_fixed(true);
    // As large as one such list that is allowed.
    v1::NodalForce& force = *loads.mutable_load_cases(0)->add_nodal_forces();
    force.add_groups("all");
    force.mutable_force();
  }
  EXPECT_EQ(list(supports), "");
  EXPECT_EQ(list(loads), "");
  supports.mutable_supports()->MergeFrom(v1::MeshCase(supports).supports());
  supports.mutable_supports()->DeleteSubrange(0, 2);
  EXPECT_EQ(list(supports), "case.supports");
  loads.add_load_cases()->CopyFrom(loads.load_cases(0));
  loads.mutable_load_cases(1)->set_name("again");
  EXPECT_EQ(list(loads), "case.load_cases[1].nodal_forces");
  // One condition that names a group again and again.
  for (int i = 0; i < 999; ++i) repeated.mutable_supports(0)->add_groups("all");
  EXPECT_EQ(list(repeated), "case.supports");
  // Rows of probes are counted before they are made.
  for (int i = 0; i < 30; ++i) {
    v1::MeshProbe& probe = *probes.add_probes();
    probe.set_name(absl::StrCat("probe ", i));
    probe.add_groups("all");
  }
  probes.set_modes(30);
  EXPECT_EQ(list(probes), "");
  EXPECT_THAT(Analyse(mesh, probes).analysis.status().message(), HasSubstr("rows for the probes"));
}

TEST(MeshAnalysis, ModesCountForMemoryBeforeAnythingIsComputed) {
  EXPECT_TRUE(CheckMemory(400'000, 300'000, 1, 8e9).ok());
  EXPECT_TRUE(CheckMemory(400'000, 300'000, 1, 8e9, 10).ok());
  EXPECT_TRUE(absl::IsResourceExhausted(CheckMemory(400'000, 300'000, 1, 8e9, 100)));
  // Room for all but the factor: refused with no load case solved.
  v1::MeshCase mesh_case = Case(kGood);
  constexpr double kRoom = 1.33e6;
  EXPECT_TRUE(
      Analyse(Box(true), mesh_case, {.memory_limit = kRoom, .pictures = false}).analysis.ok());
  mesh_case.set_modes(1);
  const Analysed refused =
      Analyse(Box(true), mesh_case, {.memory_limit = kRoom, .pictures = false});
  EXPECT_TRUE(absl::IsResourceExhausted(refused.analysis.status())) << refused.analysis.status();
  EXPECT_THAT(refused.analysis.status().message(), HasSubstr("a factor of"));
  EXPECT_TRUE(refused.files.empty());
  EXPECT_EQ(Analyse(Box(true), mesh_case).analysis->modes.size(), 1u);
}

// What was analysed is told first, as a case that can be given again.
TEST(MeshAnalysis, TheCaseIsKeptBesideTheResults) {
  const v1::MeshCase mesh_case = Case(kGood);
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
