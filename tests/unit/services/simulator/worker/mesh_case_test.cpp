// Cases of uploaded meshes: how those that are wrong, or too large, are refused.
#include "services/simulator/worker/mesh_case.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "tests/support/bad_changes.h"
#include "tests/unit/services/simulator/worker/analysed_mesh.h"

namespace mortise::simulator {
namespace {

using ::testing::HasSubstr;

// How the case is refused: "field: message".
std::string Refusal(const std::string& json, const mesh::GroupedMesh& mesh) {
  const Analysed analysed = Analyse(mesh, Case(json));
  EXPECT_TRUE(analysed.files.empty());
  const absl::Status& status = analysed.analysis.status();
  const std::string field = DetailOf(status).field;
  return absl::StartsWith(status.message(), field)
             ? std::string(status.message())
             : absl::StrCat(field, ": ", std::string(status.message()));
}

// The good case is refused once it is changed so.
void ExpectRefused(const std::vector<testing::BadChange>& changes,
                   const mesh::GroupedMesh& mesh = Box(false)) {
  testing::ExpectRefused(kGoodCase, changes,
                         [&](const std::string& json) { return Refusal(json, mesh); });
}

TEST(MeshCase, GroupsThatAreNotThereAreNamed) {
  ExpectRefused({
      {"[\"x_max\"]", "[\"X-max\"]",
       "case.load_cases[0].forces[0].groups[0]: there is no group of faces 'X-max';"
       " did you mean 'x_max'?"},
      {"[\"x_min\"]", "[\"wall of the house\"]",
       "case.supports[0].groups[0]: there is no group of faces or nodes 'wall of "
       "the house'; there are 'x_max', 'x_min'"},
      {"[\"x_max\"]", "[\"tip\"]", "'tip' is a group of nodes"},
      {"\"forces\"", "\"nodal_forces\"", "'x_max' is a group of faces"},
      {"\"low\"", "\"lwo\"",
       "case.materials[0].groups[0]: there is no group of elements 'lwo'; did you "
       "mean 'low'?"},
  });
  mesh::GroupedMesh mesh = Box(false);
  mesh.face_groups[0].members.clear();
  EXPECT_THAT(Refusal(kGoodCase, mesh), HasSubstr("group of faces 'x_max' is empty"));
}

TEST(MeshCase, ElementsHaveOneMaterial) {
  ExpectRefused({{"[\"low\", \"high\"]", "[\"low\"]",
                  "case.materials: 48 elements of group 'high' have no material"}});
  mesh::GroupedMesh mesh = Box(false);
  mesh.element_groups[0].members.resize(40);
  EXPECT_THAT(Refusal(kGoodCase, mesh),
              HasSubstr("8 elements that are in no group have no material"));
  ExpectRefused({{"\"materials\": [", R"("materials": [{"groups": ["low"], "values":
                      {"density": 1, "youngs_modulus": 1}}, )",
                  "48 elements of 'low and 1 more' have a material already, of 'low'"}});
}

TEST(MeshCase, BadElementsAreCounted) {
  mesh::GroupedMesh mesh = Box(false);
  for (const int e : {7, 9, 30}) std::swap(mesh.tetrahedra(0, e), mesh.tetrahedra(1, e));
  const std::string refusal = Refusal(kGoodCase, mesh);
  EXPECT_THAT(refusal, HasSubstr("mesh_file: 3 of 96 elements are inverted or have no volume"));
  EXPECT_THAT(refusal, HasSubstr("element 5014"));
  mesh = Box(true);
  mesh.nodes.col(mesh.tetrahedra(4, 11)) = mesh.nodes.col(mesh.tetrahedra(3, 11));
  EXPECT_THAT(Refusal(kGoodCase, mesh), HasSubstr("inverted or have no volume"));
}

TEST(MeshCase, WhatIsFreeToMoveIsNamed) {
  ExpectRefused({
      {"\"fixed\": true", "\"displacement\": {\"x\": 0}",
       "case.supports: part 'low and 1 more' is free to"},
      {"{\"groups\": [\"x_min\"], \"fixed\": true}", "", "free to"},
  });
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
  EXPECT_THAT(Refusal(kGoodCase, mesh),
              HasSubstr("the piece near (1000, 5500, 500) mm of part 'low and 1 more' is free to"));
}

TEST(MeshCase, CasesAreRefusedByField) {
  ExpectRefused({
      {"\"length_unit\": \"mm\",", "", "case.length_unit: is missing"},
      {"\"mm\"", "\"furlong\"", "case.length_unit: is none"},
      {"2e11", "-2e11", "case.materials[0].values.youngs_modulus"},
      {"2e11", "0", "case.materials[0].values.youngs_modulus"},
      {"0.3", "0.5", "case.materials[0].values.poissons_ratio"},
      {"7800", "0", "case.materials[0].values.density"},
      {"\"fixed\": true", "\"fixed\": false", "case.supports[0].fixed"},
      {", \"fixed\": true", "", "case.supports[0].fixed"},
      {"\"fixed\": true", "\"displacement\": {}", "supports[0].displac"},
      {"[\"x_min\"]", "[]", "case.supports[0].groups"},
      {"\"pull\"", "\"\"", "case.load_cases[0].name"},
      {"\"pull\",", "\"pull\", \"thermal_stress\": true,", "case.load_cases[0].thermal_stress"},
      {"\"load_cases\"", R"("combinations": [{"name": "pull",
                      "terms": [{"load_case": "pull", "factor": 1}]}], "load_cases")",
       "case.combinations[0].name"},
      {"\"load_cases\"", R"("combinations": [{"name": "sum",
                      "terms": [{"load_case": "push"}]}], "load_cases")",
       "case.combinations[0].terms[0].load_case: there is no load case 'push'"},
      {"\"load_cases\"", "\"modes\": 101, \"load_cases\"", "case.modes"},
      {"\"load_cases\"", "\"heat\": {}, \"load_cases\"",
       "case.materials[0].values.thermal_conductivity"},
      {"\"forces\"", R"("point_forces": [{"position": {"x": 9000},
                      "force": {"x": 1}}], "forces")",
       "case.load_cases[0].point_forces[0].position: lies outside the body"},
      {"\"supports\"", R"("probes": [{"name": "a", "points": [{"z": -900}]}],
                      "supports")",
       "case.probes[0].points[0]: lies outside"},
      {"\"fixed\": true}", R"("fixed": true},
                      {"groups": ["y_min"], "displacement": {"x": 1}})",
       "case.supports[1].displacement: contradicts"},
  });
}

// A number that was forgotten is not taken for 0.
TEST(MeshCase, MissingNumbersAreNamed) {
  ExpectRefused(
      {{", \"force\": {\"x\": 1}", "", "case.load_cases[0].forces[0].force: is missing"}});
  const auto in_load_case = [](const char* list, const char* field) {
    ExpectRefused(
        {{"\"forces\"", absl::StrCat("\"", list, "\": [{\"groups\": [\"x_max\"]}], \"forces\""),
          absl::StrCat("case.load_cases[0].", list, "[0].", field, ": is missing")}});
  };
  in_load_case("pressures", "pressure");
  in_load_case("tractions", "traction");
  in_load_case("nodal_forces", "force");
  ExpectRefused({
      {"\"forces\"", R"("point_forces": [{"force": {"x": 1}}], "forces")",
       "case.load_cases[0].point_forces[0].position: is missing"},
      {"\"load_cases\"", R"("combinations": [{"name": "sum",
                      "terms": [{"load_case": "pull"}]}], "load_cases")",
       "case.combinations[0].terms[0].factor: is missing"},
  });
  const auto in_heat = [](const char* list, const char* given, const char* field) {
    const std::string json = absl::StrReplaceAll(
        kGoodCase,
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

// An empty vector is one whose numbers were forgotten; one that has some is 0 along the others.
TEST(MeshCase, EmptyVectorsOfLoadsAreRefused) {
  const auto refused = [](const std::string& load, const std::string& field) {
    ExpectRefused(
        {{"\"forces\"", absl::StrCat(load, ", \"forces\""),
          absl::StrCat("case.load_cases[0].", field, ": needs at least one of x, y, z")}});
  };
  ExpectRefused(
      {{"{\"x\": 1}", "{}", "case.load_cases[0].forces[0].force: needs at least one of x, y, z"}});
  refused(R"("tractions": [{"groups": ["x_max"], "traction": {}}])", "tractions[0].traction");
  refused(R"("nodal_forces": [{"groups": ["tip"], "force": {}}])", "nodal_forces[0].force");
  refused(R"("point_forces": [{"position": {"x": 9}, "force": {}}])", "point_forces[0].force");
  refused(R"("gravity": {})", "gravity");
  refused(R"("body_force": {})", "body_force");
  refused(R"("rotation": {"angular_velocity": {}})", "rotation.angular_velocity");
  ExpectRefused({{"\"forces\"", "\"rotation\": {\"point\": {\"x\": 1}}, \"forces\"",
                  "case.load_cases[0].rotation.angular_velocity: is missing"}});
  // A 0 that is there is a number, beside a load that is none.
  EXPECT_TRUE(
      CheckMeshCase(Case(absl::StrReplaceAll(
                        kGoodCase, {{"\"forces\"", "\"gravity\": {\"z\": 0}, \"forces\""}})),
                    "case")
          .ok());
}

// All zeros that look like results are as good as none.
TEST(MeshCase, LoadCasesThatNothingLoadsFail) {
  const std::string loads = R"("forces": [{"groups": ["x_max"], "force": {"x": 1}}])";
  const auto status = [&](const std::string& others, const std::string& held = "\"fixed\": true") {
    return CheckMeshCase(
        Case(absl::StrReplaceAll(kGoodCase, {{", " + loads, others}, {"\"fixed\": true", held}})),
        "case");
  };
  for (const char* nothing :
       {"", R"(, "gravity": {"z": 0})", R"(, "pressures": [{"groups": ["x_max"], "pressure": 0}])",
        R"(, "forces": [{"groups": ["x_max"], "force": {"x": 0, "y": 0, "z": 0}}])",
        R"(, "rotation": {"angular_velocity": {"z": 0}})"}) {
    const absl::Status failure = status(nothing);
    EXPECT_EQ(failure.code(), absl::StatusCode::kFailedPrecondition) << nothing;
    EXPECT_EQ(DetailOf(failure).reason, "NO_LOADS") << nothing;
    EXPECT_EQ(DetailOf(failure).field, "case.load_cases[0]") << nothing;
  }
  EXPECT_TRUE(status(R"(, "gravity": {"z": -9.8})").ok());
  // Supports that are moved load whatever they hold.
  EXPECT_TRUE(status("", R"("displacement": {"x": 1e-5, "y": 0, "z": 0})").ok());
}

// Supports that are moved are so in every load case.
TEST(MeshCase, SumsMoveSupportsOnce) {
  const auto sum = [](const char* first, const char* second) {
    return absl::StrReplaceAll(
        kGoodCase,
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
TEST(MeshCase, WhatIsNotFiniteIsRefused) {
  ExpectRefused({
      {"\"x\": 1}", "\"x\": 1e308}", "case.load_cases[0].forces[0].force.x: is beyond 1e+30"},
      {"\"density\": 7800", "\"density\": 1e31", "case.materials[0].values.density: is beyond"},
  });
  mesh::GroupedMesh mesh = Box(false);
  mesh.nodes *= 1e40;
  EXPECT_THAT(Refusal(kGoodCase, mesh), HasSubstr("a coordinate is too large"));
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
    const std::string json = absl::StrReplaceAll(kGoodCase, {{from, to}});
    ASSERT_NE(json, kGoodCase);
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

TEST(MeshCase, LoadsNeedTheOutside) {
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
  ExpectRefused({{"[\"x_max\"]", "[\"z_inner\"]", "lie between elements"}}, mesh);
}

TEST(MeshCase, MemoryIsLimitedBeforeItIsTaken) {
  const Analysed analysed =
      Analyse(Box(true), Case(kGoodCase), {.memory_limit = 1e5, .pictures = false});
  EXPECT_EQ(analysed.analysis.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(CheckMemory(1'000'000'000, 800'000'000, 1, 8e9).code(),
            absl::StatusCode::kResourceExhausted);
  EXPECT_TRUE(CheckMemory(280'000, 200'000, 3, 8e9).ok());
}

// A group of all nodes, named often enough, would outgrow the mesh by far.
TEST(MeshCase, ConditionsThatMultiplyAMeshAreRefused) {
  mesh::GroupedMesh mesh = testing::GroupedBox({1, 1, 1}, {10, 10, 10}, false);
  mesh::NodeGroup all{"all", {}};
  for (int v = 0; v < mesh.nodes.cols(); ++v) all.members.push_back(v);
  mesh.node_groups.push_back(all);
  const auto list = [&](const v1::MeshCase& mesh_case) {
    EXPECT_TRUE(CheckMeshCase(mesh_case, "case").ok());
    const absl::Status status = MakeMeshModel(mesh, mesh_case).status();
    return status.ok() ? "" : absl::IsResourceExhausted(status) ? DetailOf(status).field : "else";
  };
  v1::MeshCase supports = Case(kGoodCase), repeated = supports, loads = supports, probes = supports;
  for (int i = 0; i < 100; ++i) {
    v1::MeshSupport& support = *supports.add_supports();
    support.add_groups("all");
    support.set_fixed(true);
    // As large as one such list that is allowed.
    v1::NodalForce& force = *loads.mutable_load_cases(0)->add_nodal_forces();
    force.add_groups("all");
    force.mutable_force()->set_x(1);
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

TEST(MeshCase, ModesCountForMemoryBeforeAnythingIsComputed) {
  EXPECT_TRUE(CheckMemory(400'000, 300'000, 1, 8e9).ok());
  EXPECT_TRUE(CheckMemory(400'000, 300'000, 1, 8e9, 10).ok());
  EXPECT_TRUE(absl::IsResourceExhausted(CheckMemory(400'000, 300'000, 1, 8e9, 100)));
  // Room for all but the factor: refused with no load case solved.
  v1::MeshCase mesh_case = Case(kGoodCase);
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

}  // namespace
}  // namespace mortise::simulator
