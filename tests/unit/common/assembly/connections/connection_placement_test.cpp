// Connecting elements of whole designs: where they go when somebody drags a principal.
#include "common/assembly/connections/connection_placement.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/common/assembly/connections/connection_assemblies.h"

namespace mortise::parametric {
namespace {

double SoftResidual(const ParametricAssembly& design, const Eigen::VectorXd& q) {
  double squares = 0;
  for (const ElementConnection& connection : design.connections()) {
    const Eigen::VectorXd local = ParametersIn(connection, design.elements().size(), q);
    squares += std::pow(SoftResidual(connection, local), 2);
  }
  return std::sqrt(squares);
}

std::vector<LinearForm> PrincipalForms(const ParametricAssembly& design) {
  std::vector<LinearForm> forms;
  for (std::size_t e = 0; e < design.elements().size(); ++e) {
    if (design.elements()[e].connecting) continue;
    for (int i = 0; i < 6; ++i) {
      forms.push_back(LinearForm::Variable(6 * static_cast<int>(e) + i));
    }
  }
  return forms;
}

int ElementOf(const ParametricAssembly& design, const std::string& name) {
  for (std::size_t e = 0; e < design.elements().size(); ++e) {
    if (design.elements()[e].name == name) return static_cast<int>(e);
  }
  ADD_FAILURE() << "no element " << name;
  return 0;
}

TEST(ConnectionPlacement, DraggedBoardsGetMoreDowels) {
  const ParametricAssembly boards = ParametrizedDesign(DowelledBoards());
  const auto longer =
      boards.Adjust(boards.drawn(), {{{"wall", Axis::kX}, 1}}, DemandPolicy::kStrict);
  ASSERT_TRUE(longer.ok()) << longer.status();
  EXPECT_TRUE(boards.feasible_set().Violations(longer->q, 1e-9).empty());
  const BoundingBox wall = BoxOf(longer->q, ElementOf(boards, "wall"));
  const BoundingBox dowels = BoxOf(longer->q, ElementOf(boards, "dowel 1"));
  EXPECT_NEAR(wall.size().x(), 1, 1e-9);
  EXPECT_NEAR(dowels.minimum.x() - wall.minimum.x(), 0.021, 1e-9);
  EXPECT_NEAR(wall.maximum.x() - dowels.maximum.x(), 0.021, 1e-9);
  EXPECT_EQ(boards.PartsAt(longer->q).size(), 2U + 10U);
  const auto faults = boards.FaultsAt(longer->q);
  ASSERT_TRUE(faults.ok()) << faults.status();
  EXPECT_TRUE(faults->empty()) << Describe(faults->front());
}

TEST(ConnectionPlacement, LeavesPrincipalsAlone) {
  for (Assembly assembly : {DowelledBoards(), BoltedCorner()}) {
    SCOPED_TRACE(assembly.name);
    const ParametricAssembly design = ParametrizedDesign(std::move(assembly));
    const ConnectionPlacement placement(design.feasible_set(), design.elements(),
                                        design.connections());
    EXPECT_GT(placement.degrees_of_freedom(), 0);
    const auto samples = design.Sample(100, 3);
    ASSERT_TRUE(samples.ok()) << samples.status();
    for (const Eigen::VectorXd& q : *samples) {
      const auto placed = placement.Place(q, {});
      ASSERT_TRUE(placed.ok()) << placed.status();
      for (std::size_t e = 0; e < design.elements().size(); ++e) {
        if (design.elements()[e].connecting) continue;
        const auto first = static_cast<Eigen::Index>(6 * e);
        ASSERT_EQ(placed->segment<6>(first), q.segment<6>(first)) << "to the last bit";
      }
      ASSERT_TRUE(design.feasible_set().Violations(*placed, 2e-9).empty());
      const auto again = placement.Place(*placed, {});
      ASSERT_TRUE(again.ok()) << again.status();
      ASSERT_LT((*again - *placed).cwiseAbs().maxCoeff(), 1e-8) << "it is there already";
    }
  }
}

// Whatever else is feasible with the same principals meets the soft relationships no better.
TEST(ConnectionPlacement, IsTheBestOfAllWithThesePrincipals) {
  const ParametricAssembly corner = ParametrizedDesign(BoltedCorner());
  const ConnectionPlacement placement(corner.feasible_set(), corner.elements(),
                                      corner.connections());
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, 0.03);
  const auto samples = corner.Sample(40, 5);
  ASSERT_TRUE(samples.ok()) << samples.status();
  for (const Eigen::VectorXd& q : *samples) {
    const auto placed = placement.Place(q, {});
    ASSERT_TRUE(placed.ok()) << placed.status();
    const double best = SoftResidual(corner, *placed);
    EXPECT_LE(best, SoftResidual(corner, q) + 1e-9);
    std::vector<Demand> principals;
    for (const LinearForm& form : PrincipalForms(corner)) {
      principals.push_back({form, form.At(*placed), "principal"});
    }
    for (int i = 0; i < 20; ++i) {
      Eigen::VectorXd wish = *placed;
      for (double& entry : wish) entry += normal(random);
      const auto other = corner.feasible_set().Nearest(wish, principals);
      if (!other.ok()) continue;  // a principal at the end of its range, missed by rounding
      EXPECT_LE(best, SoftResidual(corner, *other) + 1e-8);
    }
  }
}

TEST(ConnectionPlacement, ADesignerMayStillPlaceAConnectingElement) {
  const ParametricAssembly corner = ParametrizedDesign(BoltedCorner());
  const Measure screw{"screw front", Axis::kX, MeasureKind::kCenter};
  const auto range = corner.RangeOf(screw);
  ASSERT_TRUE(range.ok()) << range.status();
  ASSERT_GT(range->maximum - range->minimum, 0.01);
  const double asked = range->drawn + 0.005;
  const auto placed = corner.Adjust(corner.drawn(), {{screw, asked}}, DemandPolicy::kStrict);
  ASSERT_TRUE(placed.ok()) << placed.status();
  EXPECT_NEAR(placed->reached[0], asked, 1e-9);
  EXPECT_TRUE(corner.feasible_set().Violations(placed->q, 1e-9).empty());
}

TEST(ConnectionPlacement, WithoutConnectingElementsThereIsNothingToPlace) {
  const ParametricAssembly table = ParametrizedDesign(TwoLeggedTable());
  const ConnectionPlacement placement(table.feasible_set(), table.elements(), table.connections());
  EXPECT_EQ(placement.degrees_of_freedom(), 0);
  EXPECT_EQ(*placement.Place(table.drawn(), {}), table.drawn());
}

}  // namespace
}  // namespace mortise::parametric
