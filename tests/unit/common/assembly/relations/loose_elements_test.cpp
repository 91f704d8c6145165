// What nothing holds: told of, or held where it is drawn.
#include "common/assembly/relations/loose_elements.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "common/assembly/model/rest_pose.h"
#include "common/assembly/parametric_assembly.h"
#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A board on two posts, and a lamp and a shade beside it that touch nothing.
Assembly BenchWithLamp() {
  Assembly bench;
  bench.name = "bench";
  bench.groups = {{"bench", -1}, {"lamp", 0}};
  bench.parts = {ResizablePart("seat", {0, 0, 0.4}, {1.0, 0.3, 0.45}),
                 ResizablePart("left", {0, 0, 0}, {0.05, 0.3, 0.4}),
                 ResizablePart("right", {0.95, 0, 0}, {1.0, 0.3, 0.4}),
                 ResizablePart("lamp", {0.41, 0.11, 2.0}, {0.5, 0.2, 2.1}),
                 ResizablePart("shade", {3.4, 5.1, 3.0}, {3.5, 5.2, 3.1})};
  bench.parts[3].group = bench.parts[4].group = 1;
  return bench;
}

absl::StatusOr<ParametricAssembly> Held(Assembly assembly) {
  return ParametricAssembly::Create(
      std::move(assembly), [] { return false; }, {}, LoosePolicy::kHold);
}

BoundingBox BoxIn(const ParametricAssembly& assembly, const Eigen::VectorXd& q,
                  const std::string& name) {
  for (const PlacedPart& part : assembly.PartsAt(q)) {
    if (part.name == name) return part.box;
  }
  ADD_FAILURE() << "no part " << name;
  return {};
}

TEST(LooseElements, AreHeldWhereTheyAreDrawnIfThatIsAskedFor) {
  EXPECT_EQ(DetailOf(ParametricAssembly::Create(BenchWithLamp()).status()).reason,
            "FEASIBLE_SET_UNBOUNDED");
  ASSERT_OK_AND_ASSIGN(const ParametricAssembly bench, Held(BenchWithLamp()));
  ASSERT_OK_AND_ASSIGN(const auto open, bench.feasible_set().UnboundedDirection());
  EXPECT_FALSE(open.has_value());
  EXPECT_THAT(bench.feasible_set().Violations(bench.drawn(), 1e-9), IsEmpty());
  const BoundingBox lamp = BoxIn(bench, bench.drawn(), "lamp");
  EXPECT_NEAR(lamp.minimum.z(), 2.0, 1e-12);
}

TEST(LooseElements, FollowWhatTheyAreHeldBy) {
  ASSERT_OK_AND_ASSIGN(const ParametricAssembly bench, Held(BenchWithLamp()));
  ASSERT_OK_AND_ASSIGN(
      const Adjustment higher,
      bench.Adjust(bench.drawn(), {{{"left", Axis::kZ}, 0.6}}, DemandPolicy::kStrict));
  EXPECT_THAT(bench.feasible_set().Violations(higher.q, 1e-9), IsEmpty());
  const double gap =
      BoxIn(bench, higher.q, "lamp").minimum.z() - BoxIn(bench, higher.q, "seat").maximum.z();
  EXPECT_NEAR(gap, 2.0 - 0.45, 1e-9) << "the lamp hangs as high above the seat as it did";
}

// One relationship for each way in which something moves without end, and no more.
TEST(LooseElements, KeepAllOtherFreedom) {
  Assembly alone = BenchWithLamp();
  alone.parts.resize(3);
  ASSERT_OK_AND_ASSIGN(const ParametricAssembly bench, Held(alone));
  ASSERT_OK_AND_ASSIGN(const ParametricAssembly as_ever, ParametricAssembly::Create(alone));
  EXPECT_EQ(bench.relationships().size(), as_ever.relationships().size());
  ASSERT_OK_AND_ASSIGN(const ParametricAssembly with_lamp, Held(BenchWithLamp()));
  ASSERT_OK_AND_ASSIGN(const MeasureRange seat, with_lamp.RangeOf({"seat", Axis::kX}));
  EXPECT_GT(seat.maximum - seat.minimum, 0.5);
  ASSERT_OK_AND_ASSIGN(const MeasureRange lamp, with_lamp.RangeOf({"lamp", Axis::kZ}));
  EXPECT_GT(lamp.maximum - lamp.minimum, 0.05) << "its own sizes are its item's affair";
}

TEST(LooseElements, ThatArePrincipalAreHeldByTheNearest) {
  const Assembly bench = BenchWithLamp();
  const std::vector<Element> elements = MakeElements(bench, 1e-6);
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(6 * 5);
  direction[CenterVariable(3, Axis::kZ)] = direction[CenterVariable(4, Axis::kZ)] = 0.7;
  const Relationship held = HoldWhatMoves(bench, elements, direction);
  EXPECT_THAT(held.description, HasSubstr("'lamp' z minimum keeps its distance from 'seat' z max"));
  EXPECT_TRUE(held.equality);
  EXPECT_EQ(held.group, 0);
  EXPECT_NEAR(held.form.At(DrawnParameters(elements)), 0, 1e-12);
  EXPECT_GT(std::abs(held.form.At(DrawnParameters(elements) + direction)), 0.5);
}

TEST(LooseElements, ThatGrowByThemselvesKeepTheirSize) {
  Assembly board;
  board.name = "board";
  board.groups = {{"board", -1}};
  board.parts = {ResizablePart("board", {0, 0, 0}, {1, 0.3, 0.02})};
  const std::vector<Element> elements = MakeElements(board, 1e-6);
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(6);
  direction[SizeVariable(0, Axis::kX)] = 1;
  const Relationship held = HoldWhatMoves(board, elements, direction);
  EXPECT_NEAR(held.form.At(DrawnParameters(elements)), 0, 1e-12);
  EXPECT_GT(std::abs(held.form.At(DrawnParameters(elements) + direction)), 0.4);
}

TEST(LooseElements, TheCentreOfAJointIsHeldWhereNothingElseMoves) {
  Assembly bench = BenchWithLamp();
  Joint joint;
  joint.name = "hinge";
  joint.group = 1;
  joint.center = {0.45, 0.15, 2.1};
  bench.joints = {joint};
  const std::vector<Element> elements = MakeElements(bench, 1e-6);
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(6 * 5 + 3);
  direction[JointVariable(elements.size(), 0, Axis::kY)] = -1;
  const Relationship held = HoldWhatMoves(bench, elements, direction);
  EXPECT_THAT(held.description, HasSubstr("the centre of 'hinge' along y keeps its distance"));
  ASSERT_EQ(held.form.terms.back().variable, JointVariable(elements.size(), 0, Axis::kY));
}

}  // namespace
}  // namespace mortise::parametric
