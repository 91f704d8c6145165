#include "services/pareto/discovery/search_box.h"

#include <gtest/gtest.h>

namespace mortise::pareto {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Four parameters, of which the second is fixed, and the fourth has a single value that can be set.
DesignSpace TwoOfFourVary() {
  DesignSpace space;
  space.lower = Eigen::Vector4d(0, 5, -1, 2);
  space.upper = Eigen::Vector4d(2, 5, 3, 2.5);
  space.step = Eigen::Vector4d(0, 0, 1, 1);
  return space;
}

TEST(SearchBoxTest, LeavesOutWhatHasASingleValue) {
  const SearchBox box(TwoOfFourVary());
  ASSERT_EQ(box.size(), 2);
  EXPECT_EQ(box.box().lower, VectorXd(Eigen::Vector2d(0, -1)));
  EXPECT_EQ(box.box().upper, VectorXd(Eigen::Vector2d(2, 3)));
  EXPECT_EQ(box.space().size(), 4);
}

TEST(SearchBoxTest, KeepsOneParameterWhereNoneVaries) {
  DesignSpace space;
  space.lower = space.upper = Eigen::Vector2d(3, 4);
  const SearchBox box(space);
  ASSERT_EQ(box.size(), 1);
  EXPECT_EQ(box.DesignAt(VectorXd::Constant(1, 0.5)), space.lower);
}

TEST(SearchBoxTest, GivesTheNearestDesignThatCanBeSetAndItsCoordinates) {
  const SearchBox box(TwoOfFourVary());
  const VectorXd x = box.DesignAt(Eigen::Vector2d(0.25, 0.6));
  EXPECT_EQ(x, VectorXd(Eigen::Vector4d(0.5, 5, 1, 2)));
  EXPECT_EQ(box.UnitOf(x), VectorXd(Eigen::Vector2d(0.25, 0.5)));
}

TEST(SearchBoxTest, DerivesByUnitCoordinates) {
  const SearchBox box(TwoOfFourVary());
  const MatrixXd jacobian = Eigen::RowVector4d(1, 10, 100, 1000);
  EXPECT_EQ(box.UnitJacobian(jacobian), MatrixXd(Eigen::RowVector2d(2, 400)));
  EXPECT_EQ(box.UnitJacobian({}).size(), 0);
}

TEST(SearchBoxTest, CompletesAPieceWithWhatIsFixed) {
  const SearchBox box(TwoOfFourVary());
  FrontPiece piece{Eigen::Vector2d(1, 2), MatrixXd(Eigen::Vector2d(0.6, 0.8)), 7};
  box.AddHeldParameters(piece);
  EXPECT_EQ(piece.origin, VectorXd(Eigen::Vector4d(1, 5, 2, 2)));
  EXPECT_EQ(piece.directions, MatrixXd(Eigen::Vector4d(0.6, 0, 0.8, 0)));
  EXPECT_EQ(piece.points, 7);
}

}  // namespace
}  // namespace mortise::pareto
