#include "services/retrieval/families/described_designs.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/templates/template_codec.h"
#include "services/retrieval/families/family_manifold.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::retrieval {
namespace {

// The quickest of the solids that ship.
std::shared_ptr<const templates::Template> Wrench() {
  v1::TemplateBundle bundle = templates::ShippedTemplate("templates/wrench");
  EXPECT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
  return templates::Compile(bundle).value();
}

TEST(DescribedDesignsTest, ManifoldsOfAllDescriptorsShareTheDesignsAndAreAsByThemselves) {
  const auto function = Wrench();
  ASSERT_TRUE(function->MeshesAnew());
  std::vector<std::shared_ptr<const Descriptor>> descriptors;
  for (const std::string& name : DescriptorNames()) {
    descriptors.push_back(MakeDescriptor(name).value());
  }
  const auto shared = std::make_shared<DescribedDesigns>(function, descriptors);
  constexpr int kSamples = 3;
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const auto alone = MakeFamilyManifold(function, descriptors[i]).value();
    const auto together = MakeFamilyManifold(function, descriptors[i], shared, i).value();
    const auto samples = together->Sample(kSamples, 1).value();
    EXPECT_EQ(samples, alone->Sample(kSamples, 1).value());
    for (const Eigen::VectorXd& q : samples) {
      EXPECT_EQ(together->Evaluate(q).value(), alone->Evaluate(q).value());
      EXPECT_EQ(together->Structure(q), alone->Structure(q));
    }
  }
  EXPECT_EQ(shared->made(), kSamples) << "each was made once";
}

TEST(DescribedDesignsTest, TellsOfDesignsThatCannotBeMade) {
  DescribedDesigns designs(Wrench(),
                           {MakeDescriptor("d2").value(), MakeDescriptor("voxel").value()});
  const auto described = designs.At(Eigen::VectorXd(1));  // it has more parameters
  ASSERT_EQ(described->vectors.size(), 2u);
  EXPECT_FALSE(described->vectors[0].ok());
  EXPECT_FALSE(described->vectors[1].ok());
}

}  // namespace
}  // namespace mortise::retrieval
