#include "services/retrieval/families/family_manifold.h"

#include <gtest/gtest.h>

#include <memory>

#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/retrieval/families/design_surface.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::retrieval {
namespace {

class FamilyManifoldTest : public ::testing::Test {
 protected:
  FamilyManifoldTest() {
    v1::TemplateBundle bundle = templates::ShippedTemplate("templates/table");
    EXPECT_EQ(templates::Complete(bundle, templates::Trial::kDefaults), absl::OkStatus());
    function_ = templates::Compile(bundle).value();
    manifold_ = MakeFamilyManifold(function_, descriptor_).value();
  }

  std::shared_ptr<const templates::Template> function_;
  std::shared_ptr<const Descriptor> descriptor_ = MakeDescriptor("d2").value();
  std::unique_ptr<Manifold> manifold_;
};

TEST_F(FamilyManifoldTest, HasTheParametersOfTheTemplate) {
  EXPECT_EQ(manifold_->parameters(), static_cast<Eigen::Index>(function_->parameters().size()));
  EXPECT_EQ(manifold_->dimension(), descriptor_->properties().dimension);
  const auto samples = manifold_->Sample(20, 1);
  ASSERT_TRUE(samples.ok()) << samples.status();
  for (const Eigen::VectorXd& q : *samples) {
    EXPECT_TRUE(function_->Evaluate(q).ok()) << q.transpose();
  }
}

TEST_F(FamilyManifoldTest, DescribesDesignsAsTheirSurfacesAreDescribed) {
  const auto samples = manifold_->Sample(5, 2);
  ASSERT_TRUE(samples.ok());
  for (const Eigen::VectorXd& q : *samples) {
    const auto described = manifold_->Evaluate(q);
    ASSERT_TRUE(described.ok()) << described.status();
    const auto alone = descriptor_->Describe(DesignSurface(*function_->Evaluate(q)));
    ASSERT_TRUE(alone.ok()) << alone.status();
    EXPECT_LT((*described - *alone).norm(), 4 * descriptor_->properties().sampling_noise);
  }
}

TEST_F(FamilyManifoldTest, IsAsSmoothAsItsDescriptor) {
  const Eigen::VectorXd q = parametric::Defaults(function_->parameters());
  Eigen::VectorXd moved = q;
  const Eigen::VectorXd here = manifold_->Evaluate(q).value();
  moved[0] += 1e-4;
  const double near = (manifold_->Evaluate(moved).value() - here).norm();
  moved[0] += 1e-4;
  const double far = (manifold_->Evaluate(moved).value() - here).norm();
  EXPECT_GT(near, 0);
  EXPECT_NEAR(far / near, 2, 0.05);
}

TEST_F(FamilyManifoldTest, FailsWhereTheDesignCannotBeMade) {
  EXPECT_FALSE(manifold_->Evaluate(Eigen::VectorXd::Constant(manifold_->parameters(), 1e6)).ok());
}

}  // namespace
}  // namespace mortise::retrieval
