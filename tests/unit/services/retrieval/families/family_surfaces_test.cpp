#include "services/retrieval/families/family_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/retrieval/families/design_surface.h"
#include "services/retrieval/fit/fit.h"
#include "tests/unit/common/templates/shipped_collection.h"
#include "tests/unit/services/retrieval/fit/scans.h"

namespace mortise::retrieval {
namespace {

std::shared_ptr<const templates::Template> Shipped(const std::string& name) {
  v1::TemplateBundle bundle = templates::ShippedTemplate(name);
  EXPECT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
  return templates::Compile(bundle).value();
}

TEST(FamilySurfacesTest, AreThoseOfTheTemplate) {
  const auto table = Shipped("templates/table");
  const FitFamily family = SurfacesOf(table, DomainOf(*table).value());
  ASSERT_EQ(family.surfaces.lower.size(), 6);
  EXPECT_TRUE((family.surfaces.lower.array() < family.surfaces.upper.array()).all());
  const Eigen::VectorXd q = parametric::Defaults(table->parameters());
  const auto surface = family.surfaces.surface(q);
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_EQ(surface->vertices, DesignSurface(*table->Evaluate(q)).vertices);
  EXPECT_FALSE(family.surfaces.surface(1e3 * q).ok());
}

// Scans of hidden designs of a table and a boat, with noise, holes and turned: parameters come
// back.
TEST(FamilySurfacesTest, AreFittedToScans) {
  for (const std::string name : {"templates/table", "templates/boat"}) {
    const auto function = Shipped(name);
    const FitFamily family = SurfacesOf(function, DomainOf(*function).value());
    const Eigen::VectorXd ranges = family.surfaces.upper - family.surfaces.lower;
    for (const std::uint64_t seed : {1, 2, 3}) {
      Random random(seed);
      Eigen::VectorXd q = family.surfaces.lower;
      for (Eigen::Index k = 0; k < q.size(); ++k) q[k] += random.Uniform() * ranges[k];
      const mesh::SurfaceMesh design = *family.surfaces.surface(q);
      const double diagonal = testing::DiagonalOf(design);
      mesh::SurfaceMesh scan = testing::Refined(design, 0.02 * diagonal);
      testing::AddNoise(scan, 0.0002 * diagonal, random);
      testing::CutHoles(scan, 0.1, 4, random);
      scan = testing::Placed(scan, -std::numbers::pi / 2, {1, 2, 3});
      const auto query = FitQuery::Create(scan);
      ASSERT_TRUE(query.ok()) << query.status();
      const Eigen::VectorXd middle = family.surfaces.lower + 0.5 * ranges;
      const auto fitted = FitDesign(*query, family, {{middle}}, {});
      ASSERT_TRUE(fitted.ok()) << fitted.status();
      EXPECT_LT(fitted->remaining.root_mean_square, 0.001 * diagonal) << name << seed;
      EXPECT_LT((fitted->q - q).cwiseQuotient(ranges).cwiseAbs().mean(), 0.02) << name << seed;
    }
  }
}

}  // namespace
}  // namespace mortise::retrieval
