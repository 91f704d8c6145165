#include "services/retrieval/families/parameter_domain.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/base/random.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

std::shared_ptr<const templates::Template> Compiled(v1::TemplateBundle bundle) {
  EXPECT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
  return templates::Compile(bundle).value();
}

bool IsWithin(const LinearConstraints& cuts, const VectorXd& q) {
  return ((cuts.normals * q).array() <= cuts.bounds.array()).all();
}

TEST(ParameterDomainTest, IsTheBoxWhereNothingCutsIt) {
  const auto table = Compiled(templates::ShippedTemplate("templates/table"));
  const auto domain = DomainOf(*table);
  ASSERT_TRUE(domain.ok()) << domain.status();
  EXPECT_EQ(domain->cuts.bounds.size(), 0);
  for (std::size_t i = 0; i < table->parameters().size(); ++i) {
    EXPECT_EQ(domain->lower[static_cast<Eigen::Index>(i)], table->parameters()[i].minimum);
    EXPECT_EQ(domain->upper[static_cast<Eigen::Index>(i)], table->parameters()[i].maximum);
  }
}

TEST(ParameterDomainTest, TellsWhatTakesWholeNumbersAlone) {
  const auto armchair = Compiled(templates::ShippedTemplate("templates/armchair"));
  const auto domain = DomainOf(*armchair);
  ASSERT_TRUE(domain.ok()) << domain.status();
  std::vector<std::string> whole;
  for (std::size_t i = 0; i < armchair->parameters().size(); ++i) {
    if (domain->whole[i]) whole.push_back(armchair->parameters()[i].name);
  }
  EXPECT_EQ(whole, (std::vector<std::string>{"armrests", "wood", "splats"}));
}

// What the cuts leave can be made, and what they take cannot.
TEST(ParameterDomainTest, TellsWhatAnAssemblyCanHaveTogether) {
  const auto stool = Compiled(templates::ShippedAssembly("assemblies/step-stool"));
  const KeptDomain kept(stool);
  const auto& domain = kept.Get();
  ASSERT_TRUE(domain.ok()) << domain.status();
  ASSERT_GT(domain->cuts.bounds.size(), 0);
  EXPECT_TRUE(IsWithin(domain->cuts, parametric::Defaults(stool->parameters())));
  Random random(5);
  int within = 0;
  for (int i = 0; i < 200; ++i) {
    VectorXd q(domain->lower.size());
    for (Eigen::Index k = 0; k < q.size(); ++k) {
      q[k] = domain->lower[k] + random.Uniform() * (domain->upper[k] - domain->lower[k]);
    }
    within += IsWithin(domain->cuts, q) ? 1 : 0;
    EXPECT_EQ(stool->Evaluate(q).ok(), IsWithin(domain->cuts, q)) << q.transpose();
  }
  EXPECT_GT(within, 20);
  EXPECT_LT(within, 180);
}

}  // namespace
}  // namespace mortise::retrieval
