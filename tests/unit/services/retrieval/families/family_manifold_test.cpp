#include "services/retrieval/families/family_manifold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "common/base/random.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "services/retrieval/families/design_surface.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::retrieval {
namespace {

std::shared_ptr<const templates::Template> CompiledAssembly(const std::string& name) {
  v1::TemplateBundle bundle = templates::ShippedAssembly(name);
  EXPECT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
  return templates::Compile(bundle).value();
}

// Draws parameters within their ranges.
class Box {
 public:
  explicit Box(const std::vector<parametric::Parameter>& parameters) : parameters_(parameters) {}

  Eigen::VectorXd Draw() {
    Eigen::VectorXd q(static_cast<Eigen::Index>(parameters_.size()));
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      const parametric::Parameter& parameter = parameters_[i];
      q[static_cast<Eigen::Index>(i)] =
          parameter.minimum + random_.Uniform() * (parameter.maximum - parameter.minimum);
    }
    return q;
  }

 private:
  const std::vector<parametric::Parameter>& parameters_;
  Random random_{7};
};

// A point with room to all sides: the mean of many.
Eigen::VectorXd Middle(const Manifold& manifold) {
  const std::vector<Eigen::VectorXd> samples = manifold.Sample(100, 1).value();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(manifold.parameters());
  for (const Eigen::VectorXd& q : samples) sum += q;
  return sum / static_cast<double>(samples.size());
}

class FamilyManifoldTest : public ::testing::Test {
 protected:
  FamilyManifoldTest() {
    v1::TemplateBundle bundle = templates::ShippedTemplate("templates/table");
    EXPECT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
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

// A box of the sizes of these is mostly empty of designs.
TEST(FamilyManifoldOfAssembly, HasADesignAtEverySample) {
  for (const std::string name : {"step-stool", "dining-table", "bookshelf"}) {
    const auto function = CompiledAssembly("assemblies/" + name);
    const auto manifold = MakeFamilyManifold(function, MakeDescriptor("d2").value());
    ASSERT_TRUE(manifold.ok()) << manifold.status();
    const auto samples = (*manifold)->Sample(60, 3);
    ASSERT_TRUE(samples.ok()) << samples.status();
    for (const Eigen::VectorXd& q : *samples) {
      const auto design = function->Evaluate(q);
      EXPECT_TRUE(design.ok()) << name << ": " << design.status();
    }
  }
}

// What the box allows and the manifold leaves out cannot be made.
TEST(FamilyManifoldOfAssembly, LeavesOutNothingThatCanBeMade) {
  const auto function = CompiledAssembly("assemblies/step-stool");
  const auto manifold = MakeFamilyManifold(function, MakeDescriptor("d2").value()).value();
  Box box(function->parameters());
  const LinearConstraints& limits = manifold->constraints();
  int made = 0, left_out = 0;
  for (int i = 0; i < 400; ++i) {
    const Eigen::VectorXd q = box.Draw();
    // Nearer than that to a limit, either may be.
    const double beyond = (limits.normals * q - limits.bounds).maxCoeff();
    if (std::abs(beyond) < 1e-5) continue;
    (beyond < 0 ? made : left_out) += 1;
    EXPECT_EQ(function->StructureAt(q).ok(), beyond < 0) << q.transpose();
  }
  EXPECT_GT(made, 10);
  EXPECT_GT(left_out, 100);
}

TEST(FamilyManifoldOfAssembly, EndsWhereDesignsEnd) {
  const auto function = CompiledAssembly("assemblies/step-stool");
  const auto manifold = MakeFamilyManifold(function, MakeDescriptor("d2").value()).value();
  const auto samples = manifold->Sample(10, 5).value();
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const Eigen::VectorXd ray = samples[i] - samples[0];
    const double room = RoomAlong(manifold->constraints(), samples[0], ray);
    EXPECT_TRUE(function->StructureAt(samples[0] + room * ray).ok());
    EXPECT_FALSE(function->StructureAt(samples[0] + 1.01 * room * ray).ok());
  }
}

// By differences of values with steps that are small for the descriptor's kinks.
TEST(FamilyManifoldOfAssembly, HasTheDerivativesThatDifferencesHave) {
  for (const std::string descriptor : {"d2", "voxel"}) {
    const auto manifold = MakeFamilyManifold(CompiledAssembly("assemblies/dining-table"),
                                             MakeDescriptor(descriptor).value())
                              .value();
    ASSERT_TRUE(manifold->OffersDerivatives());
    const Eigen::VectorXd extents = ExtentsOf(manifold->constraints()).value();
    const Eigen::VectorXd q = Middle(*manifold);
    const auto derivatives = manifold->DerivativesAt(q);
    ASSERT_TRUE(derivatives.ok()) << derivatives.status();
    const double largest = (derivatives->first * extents.asDiagonal()).colwise().norm().maxCoeff();
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      const Eigen::VectorXd step = 2e-3 * Eigen::VectorXd::Unit(q.size(), k) * extents[k];
      const Eigen::VectorXd difference =
          (manifold->Evaluate(q + step).value() - manifold->Evaluate(q - step).value()) / 2;
      EXPECT_LT((2e-3 * extents[k] * derivatives->first.col(k) - difference).norm(),
                0.02 * 2e-3 * largest)
          << descriptor << ", parameter " << k;
    }
  }
}

TEST_F(FamilyManifoldTest, FailsWhereTheDesignCannotBeMade) {
  EXPECT_FALSE(manifold_->Evaluate(Eigen::VectorXd::Constant(manifold_->parameters(), 1e6)).ok());
}

}  // namespace
}  // namespace mortise::retrieval
