// Relationships and the feasible set: Figure 3-4, articulation, self-contained subtrees, and
// designs that stay buildable wherever they are sampled.
#include "common/assembly/relations/feasible_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>

#include "common/assembly/model/rest_pose.h"
#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

using ::testing::HasSubstr;

constexpr double kTolerance = 1e-6;

// An assembly, parametrised.
struct Parametrised {
  explicit Parametrised(Assembly design)
      : assembly(std::move(design)),
        elements(MakeElements(assembly, kTolerance)),
        drawn(DrawnParameters(assembly, elements)),
        relationships(FindRelationships(assembly, elements, TouchingPairs(elements), kTolerance)) {}

  absl::StatusOr<FeasibleSet> Set(int group, int anchored = -1) const {
    std::vector<Relationship> within = RelationshipsWithin(assembly, relationships, group);
    if (anchored >= 0) {
      for (Relationship& held : Anchor(elements, anchored)) within.push_back(std::move(held));
    }
    return FeasibleSet::Create(within, drawn, VariablesWithin(assembly, elements, group));
  }

  int ElementNamed(const std::string& name) const {
    for (std::size_t e = 0; e < elements.size(); ++e) {
      if (elements[e].name == name) return static_cast<int>(e);
    }
    return -1;
  }

  Assembly assembly;
  std::vector<Element> elements;
  Eigen::VectorXd drawn;
  std::vector<Relationship> relationships;
};

Eigen::MatrixXd EqualityRows(const std::vector<Relationship>& relationships,
                             Eigen::Index variables) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(0, variables);
  for (const Relationship& relationship : relationships) {
    if (!relationship.equality) continue;
    rows.conservativeResize(rows.rows() + 1, variables);
    rows.bottomRows(1).setZero();
    for (const LinearTerm& term : relationship.form.terms) {
      rows(rows.rows() - 1, term.variable) = term.coefficient;
    }
  }
  return rows;
}

Eigen::Index RankOf(const Eigen::MatrixXd& rows) {
  if (rows.rows() == 0) return 0;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(rows.transpose());
  qr.setThreshold(1e-9);
  return qr.rank();
}

Eigen::Index RankOfBoth(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd both(a.rows() + b.rows(), a.cols());
  both << a, b;
  return RankOf(both);
}

BoundingBox BoxAt(const Eigen::VectorXd& q, int element) {
  const Eigen::Vector3d center = q.segment<3>(6 * element);
  const Eigen::Vector3d half = q.segment<3>(6 * element + 3) / 2;
  return {center - half, center + half};
}

// How far two boxes reach into each other; not positive if they are apart, minus the gap.
double Overlap(const BoundingBox& a, const BoundingBox& b) {
  return (a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum)).minCoeff();
}

TEST(FeasibleSetTest, TheTableOfFigure34HasTheFreedomsOneCounts) {
  const Parametrised table(TwoLeggedTable());
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, table.Set(0));
  // Along x: place, top, leg, distance of the legs. y: place, depth. z: place, top, leg.
  EXPECT_EQ(set.degrees_of_freedom(), 9);
  EXPECT_EQ(set.equalities().size(), 18U - 9U);
}

TEST(FeasibleSetTest, TheTableOfFigure34KeepsItsLegsUnderTheTop) {
  const Parametrised table(TwoLeggedTable());
  const int top = table.ElementNamed("top");
  const int leg_1 = table.ElementNamed("leg 1");
  const int leg_2 = table.ElementNamed("leg 2");
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, table.Set(0, top));
  ASSERT_OK_AND_ASSIGN(const std::vector<Eigen::VectorXd> samples, set.Sample(200, 1));
  double lowest = 1e9;
  double highest = 0;
  for (const Eigen::VectorXd& q : samples) {
    EXPECT_NEAR(BoxAt(q, top).minimum.z(), BoxAt(q, leg_1).maximum.z(), 1e-9);
    EXPECT_NEAR(BoxAt(q, top).minimum.z(), BoxAt(q, leg_2).maximum.z(), 1e-9);
    // p_x(leg 1) - p_x(top) = p_x(top) - p_x(leg 2), the thesis's own example.
    EXPECT_NEAR(q[6 * leg_1] - q[6 * top], q[6 * top] - q[6 * leg_2], 1e-9);
    EXPECT_GE(BoxAt(q, leg_1).minimum.x(), BoxAt(q, top).minimum.x() - 1e-9);
    EXPECT_LE(BoxAt(q, leg_1).maximum.x(), BoxAt(q, leg_2).minimum.x() + 1e-9);
    lowest = std::min(lowest, q[SizeVariable(leg_1, Axis::kZ)]);
    highest = std::max(highest, q[SizeVariable(leg_1, Axis::kZ)]);
  }
  // The samples spread over what is allowed: .35 to 1.4 m.
  EXPECT_LT(lowest, 0.45);
  EXPECT_GT(highest, 1.25);
}

TEST(FeasibleSetTest, ShelvesBecomeOneElement) {
  const Parametrised chest(ChestWithLid());
  const int shelves = chest.ElementNamed("shelf 1");
  ASSERT_GE(shelves, 0);
  EXPECT_EQ(chest.elements[static_cast<std::size_t>(shelves)].parts.size(), 3U);
  EXPECT_EQ(chest.elements.size(), 5U);
}

// Opened, the lid stands behind the hinge; its relationships there hold as well as when closed.
TEST(FeasibleSetTest, ArticulatedPartsKeepTheirRelationshipsInEveryRestPose) {
  const Parametrised chest(ChestWithLid());
  const int lid = chest.ElementNamed("lid board");
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, chest.Set(0, chest.ElementNamed("bottom")));
  ASSERT_OK_AND_ASSIGN(const std::vector<Eigen::VectorXd> samples, set.Sample(100, 2));
  for (const Eigen::VectorXd& q : samples) {
    for (const Pose& pose : PosesOf(chest.assembly)) {
      std::vector<BoundingBox> boxes(chest.elements.size());
      for (const PosedPosition& position : PositionsIn(pose, chest.assembly, chest.elements)) {
        BoundingBox& box = boxes[static_cast<std::size_t>(position.element)];
        if (position.is_minimum) {
          box.minimum[static_cast<int>(position.axis)] = position.position.At(q);
        }
        if (position.is_maximum) {
          box.maximum[static_cast<int>(position.axis)] = position.position.At(q);
        }
      }
      for (std::size_t e = 0; e < boxes.size(); ++e) {
        if (static_cast<int>(e) == lid) continue;
        EXPECT_LE(Overlap(boxes[e], boxes[static_cast<std::size_t>(lid)]), 1e-9)
            << pose.name << ", " << chest.elements[e].name;
      }
    }
  }
}

// What a node holds relates its elements as a design of only these parts would.
TEST(FeasibleSetTest, SubtreesAreSelfContained) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Parametrised whole(RandomAssembly(seed));
    for (int group = 1; group < static_cast<int>(whole.assembly.groups.size()); ++group) {
      Assembly cut = whole.assembly;
      std::erase_if(cut.parts, [&](const AssemblyPart& part) {
        return !IsWithin(whole.assembly, part.group, group);
      });
      if (cut.parts.empty()) continue;
      const Parametrised alone(cut);
      // The same elements, numbered anew.
      std::vector<int> number;
      for (const Element& element : alone.elements) {
        number.push_back(whole.ElementNamed(element.name));
        ASSERT_GE(number.back(), 0);
      }
      std::vector<Relationship> renumbered = alone.relationships;
      for (Relationship& relationship : renumbered) {
        for (LinearTerm& term : relationship.form.terms) {
          term.variable =
              6 * number[static_cast<std::size_t>(term.variable / 6)] + term.variable % 6;
        }
      }
      const Eigen::MatrixXd held = EqualityRows(
          RelationshipsWithin(whole.assembly, whole.relationships, group), whole.drawn.size());
      const Eigen::MatrixXd found = EqualityRows(renumbered, whole.drawn.size());
      const Eigen::Index both = RankOfBoth(held, found);
      EXPECT_EQ(RankOf(found), both) << "seed " << seed << ", group " << group;
      EXPECT_EQ(RankOf(held), both) << "seed " << seed << ", group " << group;
    }
  }
}

TEST(FeasibleSetTest, TheKeptEqualitiesAreIndependentAndSpanAll) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Parametrised design(RandomAssembly(seed));
    ASSERT_OK_AND_ASSIGN(const FeasibleSet set, design.Set(0));
    const Eigen::MatrixXd all = EqualityRows(design.relationships, design.drawn.size());
    const Eigen::MatrixXd kept = EqualityRows(set.equalities(), design.drawn.size());
    EXPECT_EQ(RankOf(kept), kept.rows());
    EXPECT_EQ(RankOf(kept), RankOf(all));
    EXPECT_EQ(RankOfBoth(kept, all), RankOf(all));
    EXPECT_EQ(set.degrees_of_freedom(), design.drawn.size() - kept.rows());
    EXPECT_LT((all * set.basis()).cwiseAbs().maxCoeff(), 1e-12);
  }
}

// Random points of random designs: nothing penetrates, nothing that touched parts, sizes hold.
TEST(FeasibleSetTest, SampledDesignsCanBeBuilt) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Parametrised design(RandomAssembly(seed));
    std::vector<Relationship> anchored = design.relationships;
    // Parts that touch nothing are free to drift: hold one of each cluster of touching parts.
    std::vector<int> cluster(design.elements.size());
    for (std::size_t e = 0; e < cluster.size(); ++e) cluster[e] = static_cast<int>(e);
    const auto touching = TouchingPairs(design.elements);
    for (std::size_t pass = 0; pass < cluster.size(); ++pass) {
      for (const auto& [a, b] : touching) {
        int& of_a = cluster[static_cast<std::size_t>(a)];
        int& of_b = cluster[static_cast<std::size_t>(b)];
        of_a = of_b = std::min(of_a, of_b);
      }
    }
    for (std::size_t e = 0; e < cluster.size(); ++e) {
      if (cluster[e] != static_cast<int>(e)) continue;
      for (Relationship& held : Anchor(design.elements, static_cast<int>(e))) {
        anchored.push_back(std::move(held));
      }
    }
    ASSERT_OK_AND_ASSIGN(const FeasibleSet set,
                         FeasibleSet::Create(anchored, design.drawn,
                                             VariablesWithin(design.assembly, design.elements, 0)));
    ASSERT_OK_AND_ASSIGN(const std::vector<Eigen::VectorXd> samples, set.Sample(50, seed));
    ASSERT_EQ(samples.size(), 50U);
    for (const Eigen::VectorXd& q : samples) {
      EXPECT_TRUE(set.Violations(q, 1e-9).empty()) << set.Violations(q, 1e-9)[0].description;
      for (int a = 0; a < static_cast<int>(design.elements.size()); ++a) {
        for (int b = a + 1; b < static_cast<int>(design.elements.size()); ++b) {
          const double before = Overlap(BoxAt(design.drawn, a), BoxAt(design.drawn, b));
          const double after = Overlap(BoxAt(q, a), BoxAt(q, b));
          EXPECT_LE(after, std::max(before, 0.0) + 1e-9);
          if (before > -1e-9) {
            EXPECT_GT(after, -1e-9) << "lost contact";
          }
        }
      }
    }
  }
}

// No design is further along an axis than the furthest corner of many.
TEST(FeasibleSetTest, CornersAreFeasibleAndFurthestOut) {
  const Parametrised table(TwoLeggedTable());
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, table.Set(0, 0));
  ASSERT_OK_AND_ASSIGN(const auto corners, set.Corners(200, 7));
  ASSERT_EQ(corners.size(), 200U);
  Eigen::VectorXd least = corners[0], most = corners[0];
  for (const Eigen::VectorXd& corner : corners) {
    EXPECT_TRUE(set.Violations(corner, 1e-8).empty());
    least = least.cwiseMin(corner);
    most = most.cwiseMax(corner);
  }
  std::vector<LinearForm> forms;
  for (int i = 0; i < table.drawn.size(); ++i) forms.push_back(LinearForm::Variable(i));
  ASSERT_OK_AND_ASSIGN(const std::vector<Range> ranges, set.RangesOf(forms));
  for (Eigen::Index i = 0; i < table.drawn.size(); ++i) {
    EXPECT_NEAR(least[i], ranges[static_cast<std::size_t>(i)].minimum, 1e-8);
    EXPECT_NEAR(most[i], ranges[static_cast<std::size_t>(i)].maximum, 1e-8);
  }
  ASSERT_OK_AND_ASSIGN(const auto again, set.Corners(200, 7));
  EXPECT_EQ(corners, again);
  EXPECT_EQ(set.Corners(-1, 0).status().code(), absl::StatusCode::kInvalidArgument);
}

// The same designs are feasible; which of them is nearest is another matter.
// Of a table's width, and of how far its width and height go together.
TEST(FeasibleSetTest, ValuesOfFormsAreThoseThatDesignsHaveTogether) {
  const Parametrised table(TwoLeggedTable());
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, table.Set(0, 0));
  const LinearForm width = LinearForm::Variable(SizeVariable(table.ElementNamed("top"), Axis::kX));
  const LinearForm leg = LinearForm::Variable(SizeVariable(table.ElementNamed("leg 1"), Axis::kX));
  const std::vector<LinearForm> forms = {width, width + leg};
  ASSERT_OK_AND_ASSIGN(const PolyhedronShadow values, set.ValuesOf(forms));
  ASSERT_OK_AND_ASSIGN(const auto corners, set.Corners(20, 1));
  for (const Eigen::VectorXd& q : corners) {
    const Eigen::Vector2d at(forms[0].At(q), forms[1].At(q));
    EXPECT_LT((values.inequalities * at - values.bounds).maxCoeff(), 1e-7);
  }
  for (Eigen::Index i = 0; i < values.bounds.size(); ++i) {
    const LinearForm along =
        Combine(values.inequalities(i, 0), forms[0], values.inequalities(i, 1), forms[1]);
    ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd furthest, set.Furthest(along));
    EXPECT_NEAR(along.At(furthest), values.bounds[i], 1e-6);
  }
}

TEST(FeasibleSetTest, RescaledFindsWhatIsNearestInItsScales) {
  for (const Assembly& assembly : {TwoLeggedTable(), ChestWithLid(), RandomAssembly(5)}) {
    const Parametrised design(assembly);
    ASSERT_OK_AND_ASSIGN(const FeasibleSet set, design.Set(0, 0));
    std::mt19937 random(11);
    std::uniform_real_distribution<double> scale(0.05, 3), shift(-0.2, 0.2);
    const Eigen::Index size = design.drawn.size();
    const Eigen::VectorXd scales =
        Eigen::VectorXd::NullaryExpr(size, [&] { return scale(random); });
    ASSERT_OK_AND_ASSIGN(const FeasibleSet rescaled, set.Rescaled(scales));
    EXPECT_EQ(rescaled.degrees_of_freedom(), set.degrees_of_freedom());
    const auto distance = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
      return (a - b).cwiseQuotient(scales).norm();
    };
    ASSERT_OK_AND_ASSIGN(const auto samples, set.Sample(60, 5));
    for (int round = 0; round < 10; ++round) {
      const Eigen::VectorXd wish =
          design.drawn + Eigen::VectorXd::NullaryExpr(size, [&] { return shift(random); });
      ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd nearest, rescaled.Nearest(wish));
      EXPECT_TRUE(set.Violations(nearest, 1e-8).empty());
      ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd other, set.Nearest(wish));
      EXPECT_LE(distance(nearest, wish), distance(other, wish) + 1e-9);
      // Nor is any nearer on the way to another feasible design.
      for (const Eigen::VectorXd& sample : samples) {
        EXPECT_LE(distance(nearest, wish),
                  distance(nearest + 0.01 * (sample - nearest), wish) + 1e-9);
      }
    }
  }
  const Parametrised table(TwoLeggedTable());
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, table.Set(0, 0));
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    const Eigen::VectorXd scales = Eigen::VectorXd::Constant(table.drawn.size(), bad);
    EXPECT_EQ(DetailOf(set.Rescaled(scales).status()).field, "scales");
  }
}

TEST(FeasibleSetTest, ASeedGivesTheSamePoints) {
  const Parametrised table(TwoLeggedTable());
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, table.Set(0, 0));
  ASSERT_OK_AND_ASSIGN(const auto first, set.Sample(10, 7));
  ASSERT_OK_AND_ASSIGN(const auto again, set.Sample(10, 7));
  ASSERT_OK_AND_ASSIGN(const auto other, set.Sample(10, 8));
  EXPECT_EQ(first, again);
  EXPECT_NE(first, other);
}

TEST(FeasibleSetTest, ViolationsNameTheRelationship) {
  const Parametrised table(TwoLeggedTable());
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, table.Set(0));
  Eigen::VectorXd q = table.drawn;
  q[SizeVariable(table.ElementNamed("leg 1"), Axis::kX)] += 1;
  const std::vector<Violation> violations = set.Violations(q, 1e-9);
  ASSERT_FALSE(violations.empty());
  EXPECT_TRUE(std::any_of(violations.begin(), violations.end(), [](const Violation& violation) {
    return violation.description == "'leg 1' x size at most 0.12 m" &&
           std::abs(violation.amount - 0.94) < 1e-9;
  }));
}

TEST(FeasibleSetTest, TheNearestDesignIsFeasibleAndNoSampleIsNearer) {
  for (const Assembly& assembly : {TwoLeggedTable(), ChestWithLid(), RandomAssembly(3)}) {
    const Parametrised design(assembly);
    ASSERT_OK_AND_ASSIGN(const FeasibleSet set, design.Set(0, 0));
    ASSERT_OK_AND_ASSIGN(const auto samples, set.Sample(100, 5));
    std::mt19937 random(9);
    std::normal_distribution<double> normal(0, 0.3);
    for (int round = 0; round < 30; ++round) {
      Eigen::VectorXd wish = design.drawn;
      for (double& entry : wish) entry += normal(random);
      ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd nearest, set.Nearest(wish));
      EXPECT_TRUE(set.Violations(nearest, 1e-8).empty());
      for (const Eigen::VectorXd& sample : samples) {
        EXPECT_LE((nearest - wish).norm(), (sample - wish).norm() + 1e-9);
      }
    }
    for (const Eigen::VectorXd& sample : samples) {
      ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd same, set.Nearest(sample));
      EXPECT_LE((same - sample).norm(), 1e-8);
    }
  }
}

TEST(FeasibleSetTest, ADemandIsMetAndTheRestFollows) {
  const Parametrised table(TwoLeggedTable());
  const int top = table.ElementNamed("top");
  const int leg = table.ElementNamed("leg 1");
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, table.Set(0, top));
  const int other_leg = table.ElementNamed("leg 2");
  // The top stays where it is held, so its legs grow downwards.
  const Demand floor{LinearForm::Variable(CenterVariable(leg, Axis::kZ)) -
                         LinearForm::Variable(SizeVariable(leg, Axis::kZ), 0.5),
                     -0.2, "leg 1 ends at -0.2 m"};
  ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd q, set.Nearest(table.drawn, {floor}));
  EXPECT_TRUE(set.Violations(q, 1e-9).empty());
  for (const int either : {leg, other_leg}) {
    EXPECT_NEAR(BoxAt(q, either).minimum.z(), -0.2, 1e-9);
    EXPECT_NEAR(BoxAt(q, either).maximum.z(), BoxAt(q, top).minimum.z(), 1e-9);
  }
}

TEST(FeasibleSetTest, DemandsThatCannotBeMetAreNamedWithWhatStandsAgainstThem) {
  const Parametrised table(TwoLeggedTable());
  const int leg_1 = table.ElementNamed("leg 1");
  const int leg_2 = table.ElementNamed("leg 2");
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, table.Set(0, 0));
  const LinearForm thickness = LinearForm::Variable(SizeVariable(leg_1, Axis::kX));
  const auto thick = set.Nearest(table.drawn, {{thickness, 0.2, "leg 1 is 0.2 m thick"}});
  EXPECT_EQ(DetailOf(thick.status()).reason, "DEMANDS_CONFLICT");
  EXPECT_THAT(std::string(thick.status().message()), HasSubstr("leg 1 is 0.2 m thick"));
  EXPECT_THAT(std::string(thick.status().message()), HasSubstr("x size at most 0.12 m"));
  // The legs are mirror images: one thickness.
  const LinearForm other = LinearForm::Variable(SizeVariable(leg_2, Axis::kX));
  const auto uneven = set.Nearest(
      table.drawn, {{thickness, 0.08, "leg 1 is 0.08 m thick"}, {other, 0.07, "leg 2 is 0.07 m"}});
  EXPECT_EQ(DetailOf(uneven.status()).reason, "DEMANDS_CONFLICT");
  EXPECT_THAT(std::string(uneven.status().message()), HasSubstr("leg 2 is 0.07 m"));
  const auto fixed = set.Nearest(table.drawn, {{thickness - other, 0.01, "unlike legs"}});
  EXPECT_EQ(DetailOf(fixed.status()).reason, "DEMANDS_CONFLICT");
  EXPECT_TRUE(set.Nearest(table.drawn, {{thickness - other, 0, "like legs"}}).ok());
}

TEST(FeasibleSetTest, WishesAndDemandsThatAreNoneAreRefused) {
  const Parametrised table(TwoLeggedTable());
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, table.Set(0, 0));
  EXPECT_TRUE(absl::IsInvalidArgument(set.Nearest(Eigen::VectorXd::Zero(1)).status()));
  Eigen::VectorXd wish = table.drawn;
  wish[0] = std::nan("");
  EXPECT_TRUE(absl::IsInvalidArgument(set.Nearest(wish).status()));
  const auto beyond = set.Nearest(table.drawn, {{LinearForm::Variable(9999), 1, "nothing"}});
  EXPECT_EQ(DetailOf(beyond.status()).field, "demands[0]");
}

// Bounded along every axis of z, but open between them: chains may miss it for long.
TEST(FeasibleSetTest, AnOpenCornerIsFoundExactly) {
  std::vector<Relationship> cone;
  for (const double slope : {1e-3, -1.0}) {
    Relationship relationship;
    relationship.equality = false;
    relationship.form = LinearForm::Variable(0, slope) - LinearForm::Variable(1, slope * 0.999);
    relationship.form.constant = -1;
    cone.push_back(relationship);
  }
  Relationship end;
  end.equality = false;
  end.form = LinearForm::Variable(0, -1);
  end.form.constant = -1;
  cone.push_back(end);
  ASSERT_OK_AND_ASSIGN(const FeasibleSet open,
                       FeasibleSet::Create(cone, Eigen::VectorXd::Zero(2), {0, 1}));
  EXPECT_EQ(DetailOf(open.Sample(1, 1).status()).reason, "FEASIBLE_SET_UNBOUNDED");
  end.form.terms[0].coefficient = 1;
  cone.push_back(end);
  ASSERT_OK_AND_ASSIGN(const FeasibleSet closed,
                       FeasibleSet::Create(cone, Eigen::VectorXd::Zero(2), {0, 1}));
  EXPECT_TRUE(closed.Sample(1, 1).ok());
}

TEST(FeasibleSetTest, ADriftingDesignCannotBeSampled) {
  const Parametrised table(TwoLeggedTable());
  ASSERT_OK_AND_ASSIGN(const FeasibleSet set, table.Set(0));
  const auto samples = set.Sample(1, 1);
  EXPECT_EQ(samples.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(samples.status()).reason, "FEASIBLE_SET_UNBOUNDED");
  EXPECT_EQ(set.Sample(-1, 1).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(FeasibleSetTest, ADrawingThatBreaksARelationshipIsNamed) {
  const Parametrised table(TwoLeggedTable());
  std::vector<Relationship> wrong = table.relationships;
  Relationship impossible = Anchor(table.elements, 0)[0];
  impossible.form.constant += 1;
  wrong.push_back(impossible);
  const auto set =
      FeasibleSet::Create(wrong, table.drawn, VariablesWithin(table.assembly, table.elements, 0));
  EXPECT_EQ(set.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(set.status().message()), HasSubstr("held in place along x"));
}

}  // namespace
}  // namespace mortise::parametric
