// (5.3): of all that a connection allows, what costs least. Held against other designs that satisfy
// it.
#include "services/composer/connecting/fit_programme.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "services/composer/connecting/hold.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

constexpr double kHold = 0.5;
constexpr double kFeasible = 1e-8;  // m
constexpr double kRounding = 1e-6;  // of a cost

// A piece of a design that ships, and what is left of the design.
struct Taken {
  std::string id, node;
};

const std::vector<Taken>& Pieces() {
  static const auto* const all = new std::vector<Taken>{{"dining_table", "top"},
                                                        {"workbench", "top"},
                                                        {"bookshelf", "shelf 3"},
                                                        {"garden_bench", "seat"},
                                                        {"tool_cart", "drawer"}};
  return *all;
}

Design RestOf(const Taken& taken) {
  const parametric::Assembly& whole = ShippedDesign(taken.id).assembly->assembly();
  return AsDrawn(parametric::WithoutSubTree(whole, taken.node).value()).value();
}

// The connections of the design between the piece and the rest, with the parts of both.
std::vector<Candidate> CandidatesOf(const Taken& taken, const BothSides& sides) {
  const auto index_of = [](const std::vector<PrincipalPart>& parts, const std::string& name) {
    const auto found = std::find_if(parts.begin(), parts.end(),
                                    [&](const auto& part) { return part.name == name; });
    return found == parts.end() ? -1 : static_cast<int>(found - parts.begin());
  };
  std::vector<Candidate> candidates;
  for (const CollectionConnection& connection : ShippedConnections(taken.id)) {
    Candidate candidate{&connection, {}};
    int of_component = 0, missing = 0;
    for (const std::string& name : connection.Principals()) {
      const int inside = index_of(sides.component_parts, name);
      const int outside = index_of(sides.body_parts, name);
      of_component += inside >= 0 ? 1 : 0;
      missing += inside < 0 && outside < 0 ? 1 : 0;
      candidate.principals.push_back({inside >= 0, inside >= 0 ? inside : outside});
    }
    const auto count = static_cast<int>(candidate.principals.size());
    if (missing == 0 && of_component > 0 && of_component < count) candidates.push_back(candidate);
  }
  return candidates;
}

double Between(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() % 10'000) / 10'000;
}

// The design a little on its way to a random one, and moved by up to `moved`, m, along each axis.
Design Disturbed(const Design& design, double share, double moved, std::mt19937_64& random) {
  Design made = design;
  const auto samples = design.assembly->Sample(1, random()).value();
  made.q += share * (samples.front() - design.q);
  for (double& along : made.shift) along += Between(random, -moved, moved);
  return made;
}

double CostOf(const Design& before, const Design& after, double of_places) {
  const Eigen::VectorXd scales = ChangeScales(*before.assembly, of_places);
  return (InSpace(after) - InSpace(before)).cwiseQuotient(scales).squaredNorm();
}

// The squared distance that (5.3) minimises.
double CostOf(const BothSides& before, const BothSides& after) {
  const double diagonal = parametric::AssemblyDiagonal(before.body.assembly->assembly());
  return CostOf(before.body, after.body, diagonal) +
         CostOf(before.component, after.component, diagonal);
}

// Whether both sides are designs of theirs, and the connection between them holds, by what places
// connections rather than by the programme.
void ExpectConnected(const BothSides& sides, const Candidate& candidate) {
  for (const Design* const design : {&sides.body, &sides.component}) {
    EXPECT_THAT(design->assembly->feasible_set().Violations(design->q, kFeasible),
                ::testing::IsEmpty());
  }
  const parametric::ConnectionOptimizer optimizer(candidate.from->connection);
  const auto placed = optimizer.Optimize(sides.BoxesOf(candidate));
  ASSERT_TRUE(placed.ok()) << placed.status();
  EXPECT_EQ(LooseHold(candidate.from->connection, *placed, kHold - 1e-6), "");
}

// Whether the same faces bound what the principals share: so the programme takes it to stay.
bool MeetAlike(const std::vector<parametric::BoundingBox>& before,
               const std::vector<parametric::BoundingBox>& after) {
  const auto differs = [](double a, double b, double c, double d) {
    return (a - b) * (c - d) < 0 && std::abs(c - d) > kFeasible;
  };
  for (std::size_t i = 0; i < before.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (int axis = 0; axis < 3; ++axis) {
        if (differs(before[i].minimum[axis], before[j].minimum[axis], after[i].minimum[axis],
                    after[j].minimum[axis]) ||
            differs(before[i].maximum[axis], before[j].maximum[axis], after[i].maximum[axis],
                    after[j].maximum[axis])) {
          return false;
        }
      }
    }
  }
  return true;
}

class FitProgrammeTest : public ::testing::TestWithParam<Taken> {};

INSTANTIATE_TEST_SUITE_P(Collection, FitProgrammeTest, ::testing::ValuesIn(Pieces()),
                         [](const auto& tested) { return tested.param.id; });

TEST_P(FitProgrammeTest, NoDesignThatTheConnectionAllowsIsNearer) {
  const Design rest = RestOf(GetParam());
  const Design piece = ShippedComponent(GetParam().id, GetParam().node);
  std::mt19937_64 random(53);
  int fitted = 0, compared = 0;
  const FitSpaces spaces = FitSpacesOf(SidesOf(rest, piece));
  for (int drop = 0; drop < 12; ++drop) {
    const BothSides now =
        SidesOf(Disturbed(rest, 0.03, 0, random), Disturbed(piece, 0.1, 0.006, random));
    const std::vector<Candidate> candidates = CandidatesOf(GetParam(), now);
    ASSERT_THAT(candidates, ::testing::Not(::testing::IsEmpty()));
    const Candidate& candidate = candidates[random() % candidates.size()];
    SCOPED_TRACE(candidate.from->connection.name);
    const absl::StatusOr<FittedSides> best = FitSides(now, spaces, {candidate}, kHold);
    if (!best.ok()) {
      EXPECT_EQ(DetailOf(best.status()).reason, "CONNECTION_CONFLICT");
      continue;
    }
    ++fitted;
    ExpectConnected(best->sides, candidate);
    const double cost = CostOf(now, best->sides);
    for (int sample = 0; sample < 12; ++sample) {
      // Other designs that the connection allows: nearest to other ones.
      const BothSides other = SidesOf(Disturbed(best->sides.body, 0.02, 0, random),
                                      Disturbed(best->sides.component, 0.05, 0.003, random));
      const absl::StatusOr<FittedSides> allowed = FitSides(other, spaces, {candidate}, kHold);
      if (!allowed.ok() || !MeetAlike(now.BoxesOf(candidate), allowed->sides.BoxesOf(candidate))) {
        continue;
      }
      ExpectConnected(allowed->sides, candidate);
      ++compared;
      EXPECT_LE(cost, (1 + kRounding) * CostOf(now, allowed->sides) + 1e-12);
    }
  }
  EXPECT_GE(fitted, 3);
  EXPECT_GE(compared, 10);
}

// What fits already stays as it is.
TEST_P(FitProgrammeTest, WhatIsConnectedAsDrawnDoesNotMove) {
  const BothSides now =
      SidesOf(RestOf(GetParam()), ShippedComponent(GetParam().id, GetParam().node));
  const FitSpaces spaces = FitSpacesOf(now);
  for (const Candidate& candidate : CandidatesOf(GetParam(), now)) {
    SCOPED_TRACE(candidate.from->connection.name);
    ASSERT_OK_AND_ASSIGN(const FittedSides fitted, FitSides(now, spaces, {candidate}, kHold));
    EXPECT_LE(fitted.moved_by, 1e-7);
  }
}

}  // namespace
}  // namespace mortise::composer
