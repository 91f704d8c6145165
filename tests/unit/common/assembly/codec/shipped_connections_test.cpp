// The connections of the assemblies that ship: all are found, hold for every design of the family,
// and can be placed anew for its principals.
#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/codec/parametrization_codec.h"
#include "tests/unit/common/assembly/codec/shipped_assemblies.h"
#include "tests/unit/common/assembly/connections/connection_assemblies.h"

namespace mortise::parametric {
namespace {

constexpr int kSamples = 200;

class ShippedConnections : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    auto assembly = ReadShippedAssembly(GetParam());
    ASSERT_TRUE(assembly.ok()) << assembly.status();
    auto design = ParametricAssembly::Create(*std::move(assembly));
    ASSERT_TRUE(design.ok()) << design.status();
    design_ = *std::move(design);
  }

  std::optional<ParametricAssembly> design_;
};

TEST_P(ShippedConnections, HoldEveryConnectingElement) {
  const std::vector<Element>& elements = design_->elements();
  std::set<int> connecting;
  std::set<std::pair<int, int>> connected;
  for (const ElementConnection& connection : design_->connections()) {
    SCOPED_TRACE(connection.name);
    for (const int element : connection.connecting) {
      EXPECT_TRUE(elements[static_cast<std::size_t>(element)].connecting);
      EXPECT_TRUE(connecting.insert(element).second) << "in one connection only";
    }
    for (const int a : connection.principals) {
      EXPECT_FALSE(elements[static_cast<std::size_t>(a)].connecting);
      EXPECT_TRUE(IsWithin(design_->assembly(), elements[static_cast<std::size_t>(a)].group,
                           connection.group));
      for (const int b : connection.principals) connected.emplace(a, b);
    }
    EXPECT_FALSE(connection.patches.empty());
  }
  for (std::size_t e = 0; e < elements.size(); ++e) {
    EXPECT_EQ(connecting.contains(static_cast<int>(e)), elements[e].connecting) << elements[e].name;
  }
  for (const auto& [a, b] : design_->contacts()) {
    const Element& first = elements[static_cast<std::size_t>(a)];
    const Element& second = elements[static_cast<std::size_t>(b)];
    if (first.connecting || second.connecting) continue;
    const auto kind =
        FindPatch(first, first.box, second, second.box, design_->tolerance(), design_->tolerance())
            .kind;
    EXPECT_TRUE(connected.contains({a, b}) || kind != PatchKind::kContact)
        << first.name << " with " << second.name;
  }
}

// In any design of the family the hard relationships hold, so the connection can be placed, no
// worse than it is.
TEST_P(ShippedConnections, HoldForRandomDesigns) {
  auto samples = design_->Sample(kSamples, 2);
  ASSERT_TRUE(samples.ok()) << samples.status();
  samples->insert(samples->begin(), design_->drawn());
  for (const ElementConnection& connection : design_->connections()) {
    SCOPED_TRACE(connection.name);
    const ConnectionOptimizer optimizer(connection);
    for (std::size_t i = 0; i < samples->size(); ++i) {
      const Eigen::VectorXd& q = (*samples)[i];
      const Eigen::VectorXd local = ParametersIn(connection, design_->elements().size(), q);
      for (const Relationship& hard : connection.hard) {
        const double value = hard.form.At(local);
        ASSERT_LT(hard.equality ? std::abs(value) : value, 2e-9) << hard.description;
      }
      const auto made = optimizer.Optimize(PrincipalsAt(connection, q));
      ASSERT_TRUE(made.ok()) << made.status();
      ASSERT_LT(made->hard_residual, 1e-9);
      ASSERT_LE(made->soft_residual, SoftResidual(connection, local) + 1e-7);
      if (i > 0) continue;
      ASSERT_LT((made->q - local).cwiseAbs().maxCoeff(), 1e-9) << "as drawn";
    }
  }
}

// As they are dragged: all connections at once, sound in every rest pose.
TEST_P(ShippedConnections, ArePlacedSoundly) {
  const auto samples = design_->Sample(kSamples, 4);
  ASSERT_TRUE(samples.ok()) << samples.status();
  for (const Eigen::VectorXd& q : *samples) {
    const auto placed = design_->Adjust(q, {}, DemandPolicy::kStrict);
    ASSERT_TRUE(placed.ok()) << placed.status();
    const auto violations = design_->feasible_set().Violations(placed->q, 2e-9);
    ASSERT_TRUE(violations.empty()) << violations.front().description;
    const auto faults = design_->FaultsAt(placed->q);
    ASSERT_TRUE(faults.ok()) << faults.status();
    ASSERT_TRUE(faults->empty()) << Describe(faults->front());
  }
}

// What a client may receive at once.
TEST_P(ShippedConnections, FitIntoAMessage) {
  const auto message = ToProto(*design_);
  ASSERT_TRUE(message.ok()) << message.status();
  EXPECT_EQ(message->connections_size(), static_cast<int>(design_->connections().size()));
  EXPECT_LT(message->ByteSizeLong(), 2'000'000U);
}

INSTANTIATE_TEST_SUITE_P(Collection, ShippedConnections, ::testing::ValuesIn(ShippedAssemblyIds()),
                         [](const auto& assembly) { return assembly.param; });

}  // namespace
}  // namespace mortise::parametric
