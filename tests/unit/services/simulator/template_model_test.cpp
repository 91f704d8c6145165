// Templates of every kind as finite element models.
#include "services/simulator/template_model.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "common/parametric/parameter_values.h"
#include "common/templates/template_codec.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::simulator {
namespace {

using parametric::EvaluatedDesign;

struct Subject {
  std::shared_ptr<const templates::Template> function;
  EvaluatedDesign design;
};

Subject AtDefaults(v1::TemplateBundle bundle) {
  EXPECT_EQ(templates::Complete(bundle, templates::Trial::kDefaults), absl::OkStatus());
  auto function = templates::Compile(bundle);
  EXPECT_TRUE(function.ok()) << function.status();
  auto design = (*function)->Evaluate(parametric::Defaults((*function)->parameters()));
  EXPECT_TRUE(design.ok()) << design.status();
  return {*std::move(function), *std::move(design)};
}

double ValueOf(const DesignAnalysis& analysis, const std::string& name) {
  for (const Metric& metric : analysis.metrics) {
    if (metric.name == name) return metric.value;
  }
  ADD_FAILURE() << "there is no " << name;
  return 0;
}

TEST(TemplateModelTest, ASolidOfFeaturesBendsUnderItsLoad) {
  const Subject wrench = AtDefaults(templates::ShippedTemplate("templates/wrench"));
  const auto model = MakeDesignModel(wrench.function->head().materials, wrench.design);
  ASSERT_TRUE(model.ok()) << model.status();
  DesignAnalysisOptions options;
  options.mesh.element_size = 0.004;
  const auto analysis =
      AnalyzeDesign(*model, {"mass", "max_displacement", "max_von_mises"}, true, options);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_NEAR(ValueOf(*analysis, "mass"), wrench.design.mass, 0.01 * wrench.design.mass);
  EXPECT_GT(ValueOf(*analysis, "max_displacement"), 1e-5);
  EXPECT_LT(ValueOf(*analysis, "max_displacement"), 5e-3);
  // 250 N at the handle: a force spread over all of its faces together, held at the jaw.
  const ElasticitySummary& summary = analysis->solution->summary;
  EXPECT_NEAR(summary.total_load.norm(), 250, 1e-6);
  EXPECT_LT((summary.total_load + summary.total_reaction).norm(), 1e-4);
}

TEST(TemplateModelTest, WhatOnlyConnectsPartsIsLeftOut) {
  const Subject shelf = AtDefaults(templates::ShippedAssembly("assemblies/bookshelf"));
  std::size_t principal = 0;
  for (const parametric::EvaluatedPart& part : shelf.design.parts) principal += !part.connecting;
  ASSERT_LT(principal, shelf.design.parts.size());
  const auto model = MakeDesignModel(shelf.function->head().materials, shelf.design);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ(model->surface.part_names.size(), principal);
  EXPECT_EQ(model->analysis.materials.size(), principal);
}

TEST(TemplateModelTest, PartsWithoutMaterialAreNamed) {
  Subject wrench = AtDefaults(templates::ShippedTemplate("templates/wrench"));
  const absl::Status status = MakeDesignModel({}, wrench.design).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(status).field, "part 'wrench'");
}

TEST(TemplateModelTest, OnlyPartsOfferTheGradientOfMass) {
  const Subject table = AtDefaults(templates::ShippedTemplate("templates/table"));
  EXPECT_TRUE(OffersGradient(*table.function, "mass"));
  EXPECT_FALSE(OffersGradient(*table.function, "max_displacement"));
  const Subject wrench = AtDefaults(templates::ShippedTemplate("templates/wrench"));
  EXPECT_FALSE(OffersGradient(*wrench.function, "mass"));
}

}  // namespace
}  // namespace mortise::simulator
