// Meshes refined where the error is: what is wanted is reached, with few elements, or it is said
// why not.
#include "services/simulator/analysis/refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "tests/unit/services/simulator/analysis/test_cases.h"

namespace mortise::simulator {
namespace {

// An L of two boxes, held at the top and pulled aside at its foot: stress has no limit along the
// inner edge.
DesignModel InnerCorner() {
  DesignModel model;
  model.surface = mesh::AssembleBoxes(
      {{"stem", {0, 0, 0}, {0.1, 0.1, 0.3}}, {"foot", {0.1, 0, 0}, {0.3, 0.1, 0.1}}});
  model.analysis.materials.assign(2, {"test", 1000, 10e9, 0.3, 0});
  model.analysis.supports.push_back({{0, "z_max"}});
  model.analysis.forces.push_back({{1, "x_max"}, {0, 0, -1000}});
  return model;
}

absl::StatusOr<DesignAnalysis> Refined(const DesignModel& model, double wanted, bool quadratic,
                                       int element_limit = 2'000'000, int threads = 1) {
  DesignAnalysisOptions options;
  options.mesh.element_size = 0.08;
  options.mesh.quadratic = quadratic;
  options.mesh.element_limit = element_limit;
  options.elasticity.threads = threads;
  options.wanted_error = wanted;
  return AnalyzeDesign(model, {"strain_energy", "relative_error"}, false, options);
}

// Against the energy of a far finer solution: that of the error is what is missing of it.
TEST(Refinement, ReachesTheWantedErrorAndItIsTrue) {
  const DesignModel model = InnerCorner();
  const auto truth = Refined(model, 0.03, true);
  ASSERT_TRUE(truth.ok()) << truth.status();
  const double energy = truth->metrics[0].value;
  for (const auto& [quadratic, wanted] : {std::pair(false, 0.25), {true, 0.1}}) {
    const auto refined = Refined(model, wanted, quadratic);
    ASSERT_TRUE(refined.ok()) << refined.status();
    EXPECT_EQ(refined->shortfall, "");
    EXPECT_LE(refined->metrics[1].value, wanted);
    const double error = std::sqrt((energy - refined->metrics[0].value) / energy);
    EXPECT_LT(error, 1.35 * wanted) << "the estimate is no fancy";
    EXPECT_GT(error, 0.3 * wanted) << "nor is far more done than is asked for";
    ASSERT_GE(refined->refinements.size(), 2U);
    for (std::size_t i = 1; i < refined->refinements.size(); ++i) {
      EXPECT_GT(refined->refinements[i].elements, refined->refinements[i - 1].elements);
      EXPECT_LT(refined->refinements[i].relative_error, refined->refinements[i - 1].relative_error);
    }
    EXPECT_EQ(refined->refinements.back().elements, refined->cases[0].solution.summary.elements);
    EXPECT_EQ(refined->refinements.back().relative_error, refined->metrics[1].value);
  }
}

// A mesh as fine everywhere takes more elements and has a larger error.
TEST(Refinement, TakesFewerElementsThanAnEvenMesh) {
  const DesignModel model = InnerCorner();
  const auto refined = Refined(model, 0.08, true);
  ASSERT_TRUE(refined.ok()) << refined.status();
  DesignAnalysisOptions even;
  even.mesh.element_size = 0.036;
  const auto same = AnalyzeDesign(model, {"relative_error"}, false, even);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_GT(same->cases[0].solution.summary.elements, refined->cases[0].solution.summary.elements);
  EXPECT_GT(same->metrics[0].value, refined->metrics[1].value);
}

TEST(Refinement, TellsThatItRefinesAndIsNotAtItsEndMeanwhile) {
  StageProgress progress;
  DesignAnalysisOptions options;
  options.mesh.element_size = 0.08;
  options.wanted_error = 0.1;
  options.progress = &progress;
  options.elasticity.solver.kind = SolverKind::kIterative;
  std::set<std::string> stages;
  bool is_full = false;
  options.elasticity.solver.progress = [&](int, double) {
    const StageProgress::State state = progress.state();
    stages.insert(state.stage);
    is_full = is_full || state.done >= state.total;
    return absl::OkStatus();
  };
  progress.Expect(4);  // geometry, mesh, solution, stresses
  progress.Begin("geometry");
  const auto refined = AnalyzeDesign(InnerCorner(), {"relative_error"}, false, options);
  ASSERT_TRUE(refined.ok()) << refined.status();
  ASSERT_GE(refined->refinements.size(), 2U);
  EXPECT_FALSE(is_full);
  EXPECT_EQ(stages.count("solution"), 1U);
  const std::string refining = absl::StrFormat("refining, step 1, error %.2g %%: solution",
                                               100 * refined->refinements[0].relative_error);
  EXPECT_EQ(stages.count(refining), 1U) << refining;
}

TEST(Refinement, SaysWhyItFallsShort) {
  const auto limited = Refined(InnerCorner(), 0.01, false, 3000);
  ASSERT_TRUE(limited.ok()) << limited.status();
  EXPECT_LE(limited->cases[0].solution.summary.elements, 3000);
  EXPECT_GT(limited->metrics[1].value, 0.01);
  EXPECT_NE(limited->shortfall.find("not 1 %"), std::string::npos) << limited->shortfall;
  EXPECT_NE(limited->shortfall.find("limits of memory or elements"), std::string::npos)
      << limited->shortfall;
}

TEST(Refinement, IsTheSameOnAnyNumberOfThreads) {
  const auto one = Refined(InnerCorner(), 0.1, true),
             two = Refined(InnerCorner(), 0.1, true, 2'000'000, 2);
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_EQ(one->mesh->nodes, two->mesh->nodes);
  EXPECT_EQ(one->metrics[0].value, two->metrics[0].value);
}

TEST(Refinement, WhatIsAccurateIsLeftAlone) {
  const auto coarse = Refined(InnerCorner(), 1, true);
  ASSERT_TRUE(coarse.ok()) << coarse.status();
  EXPECT_EQ(coarse->refinements.size(), 1U);
}

TEST(Refinement, RefusesWhatNoErrorIs) {
  for (const double wanted : {1e-9, 1.5, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(DetailOf(Refined(InnerCorner(), wanted, false).status()).field, "wanted_error");
  }
}

}  // namespace
}  // namespace mortise::simulator
