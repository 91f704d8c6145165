// The assemblies that ship: all can be read, made of items that ship, and what they are
// parametrised to keeps parts apart that do not touch, and parts together that do.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/base/files.h"
#include "common/parametric/assembly_codec.h"
#include "common/parametric/collection.h"
#include "common/parametric/element.h"
#include "common/parametric/feasible_set.h"
#include "common/parametric/linear_design.h"
#include "common/parametric/relationship.h"
#include "common/parametric/rest_pose.h"
#include "common/parametric/template_codec.h"
#include "tests/unit/common/parametric/assemblies.h"

namespace mortise::parametric {
namespace {

constexpr int kSamples = 1000;
constexpr double kAlignment = 1e-6;    // m, what counts as one plane
constexpr double kPenetration = 1e-4;  // m, what a workshop does not see
constexpr double kGap = 1e-8;          // m, rounding

std::filesystem::path CollectionFolder() {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::path(source == nullptr ? "." : source) / "collection";
}

std::vector<std::string> Files() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(CollectionFolder() / "assemblies")) {
    files.push_back(entry.path().stem().string());
  }
  return files;
}

const std::vector<Item>& ShippedItems() {
  static const auto* const items = [] {
    auto* const read = new std::vector<Item>();
    const Collection collection = ReadCollection(CollectionFolder()).value();
    for (const v1::Item& message : collection.items) {
      read->push_back(*FromProto(message));
    }
    return read;
  }();
  return *items;
}

// How deep two boxes intersect, m; negative: how far they are apart.
double Overlap(const BoundingBox& a, const BoundingBox& b) {
  return (a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum)).minCoeff();
}

// A box after a motion that takes axes to axes.
BoundingBox Moved(const Eigen::Isometry3d& motion, const BoundingBox& box) {
  const Eigen::Vector3d a = motion * box.minimum;
  const Eigen::Vector3d b = motion * box.maximum;
  return {a.cwiseMin(b), a.cwiseMax(b)};
}

bool TakesAxesToAxes(const Eigen::Isometry3d& motion) {
  return ((motion.linear().cwiseAbs().array() < 1e-9) ||
          (motion.linear().cwiseAbs().array() > 1 - 1e-9))
      .all();
}

class ShippedAssembly : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const auto path = CollectionFolder() / "assemblies" / (GetParam() + ".textproto");
    const auto text = ReadFile(path);
    ASSERT_TRUE(text.ok()) << text.status();
    const auto message = ParseAssemblyText(*text, path.filename().string());
    ASSERT_TRUE(message.ok()) << message.status();
    auto assembly = FromProto(*message, ShippedItems());
    ASSERT_TRUE(assembly.ok()) << assembly.status();
    assembly_ = *std::move(assembly);
    elements_ = MakeElements(assembly_, kAlignment);
    drawn_ = DrawnParameters(assembly_, elements_);
  }

  FeasibleSet Parametrized() const {
    auto relationships =
        FindRelationships(assembly_, elements_, TouchingPairs(elements_), kAlignment);
    for (Relationship& held : Anchor(elements_, 0)) relationships.push_back(std::move(held));
    auto set = FeasibleSet::Create(std::move(relationships), drawn_,
                                   VariablesWithin(assembly_, elements_, 0));
    EXPECT_TRUE(set.ok()) << set.status();
    return *std::move(set);
  }

  // Of all elements at q.
  std::vector<BoundingBox> BoxesIn(const Pose& pose, const Eigen::VectorXd& q) const {
    const Eigen::Isometry3d motion = MotionIn(pose, assembly_, elements_.size(), q);
    std::vector<BoundingBox> boxes;
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      const BoundingBox box = BoxOf(q, static_cast<int>(e));
      const bool moved =
          pose.joint >= 0 && IsWithin(assembly_, elements_[e].group, pose.moved_group);
      boxes.push_back(moved ? Moved(motion, box) : box);
    }
    return boxes;
  }

  Assembly assembly_;
  std::vector<Element> elements_;
  Eigen::VectorXd drawn_;
};

TEST_P(ShippedAssembly, MayBeChangedInSeveralWays) {
  EXPECT_GE(assembly_.parts.size(), 10U);
  EXPECT_LE(assembly_.parts.size(), 200U);
  EXPECT_GE(Parametrized().degrees_of_freedom(), 3);
}

// In every pose in which boxes stay boxes; other poses need the meshes.
TEST_P(ShippedAssembly, KeepsContactsAndMakesNoNewOnes) {
  const FeasibleSet set = Parametrized();
  const auto samples = set.Sample(kSamples, 1);
  ASSERT_TRUE(samples.ok()) << samples.status();
  for (const Pose& pose : PosesOf(assembly_)) {
    SCOPED_TRACE(pose.name);
    if (!TakesAxesToAxes(MotionIn(pose, assembly_, elements_.size(), drawn_))) continue;
    const std::vector<BoundingBox> drawn = BoxesIn(pose, drawn_);
    for (const Eigen::VectorXd& q : *samples) {
      const std::vector<BoundingBox> boxes = BoxesIn(pose, q);
      for (std::size_t a = 0; a < boxes.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
          const double overlap = Overlap(boxes[a], boxes[b]);
          const bool touched = Overlap(drawn[a], drawn[b]) >= -kGap;
          ASSERT_TRUE(touched ? overlap >= -kGap : overlap < kPenetration)
              << elements_[a].name << " and " << elements_[b].name << ": " << overlap
              << " m, drawn " << Overlap(drawn[a], drawn[b]);
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Collection, ShippedAssembly, ::testing::ValuesIn(Files()),
                         [](const auto& assembly) { return assembly.param; });

}  // namespace
}  // namespace mortise::parametric
