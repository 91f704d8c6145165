// Drags of which much is prepared, held against drags of which nothing is: designs that ship, every
// control of their nodes, values in any order.
#include "services/composer/model/node_drag.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "common/assembly/parametric_assembly.h"
#include "common/base/errors.h"
#include "services/composer/model/controlled_node.h"
#include "services/composer/model/controls.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/bookcase.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::Demand;
using parametric::FeasibleSet;
using parametric::LinearForm;

constexpr double kSame = 1e-9;  // m

std::shared_ptr<const DragSpace> SpaceOf(const Design& design) {
  return std::make_shared<const DragSpace>(design.assembly);
}

// The drag as the thesis has it, over the whole feasible set and from nothing: what a NodeDrag must
// come to.
Design PlainDrag(const Design& design, const std::string& node, const Control& control,
                 double value) {
  const auto space = SpaceOf(design);
  const ControlledNode controlled = ControlledNode::Find(space, design, node).value();
  const LinearForm form = controlled.FormOf(control.kind, control.axis);
  const FeasibleSet& free = space->free();
  const auto nearest = [&](double wanted) -> absl::StatusOr<Eigen::VectorXd> {
    std::vector<Demand> demands = controlled.held();
    demands.push_back({form, wanted, ""});
    absl::StatusOr<Eigen::VectorXd> there = free.Nearest(controlled.now(), demands);
    if (!there.ok()) return there;
    for (const int size : SizesToKeep(*design.assembly, controlled.now(), *there)) {
      demands.push_back({LinearForm::Variable(size), controlled.now()[size], ""});
    }
    absl::StatusOr<Eigen::VectorXd> kept = free.Nearest(controlled.now(), demands);
    return kept.ok() ? kept : there;
  };
  absl::StatusOr<Eigen::VectorXd> there = nearest(value);
  if (!there.ok()) {
    const double sign = value < form.At(controlled.now()) ? -1 : 1;
    there = nearest(controlled.End(form, sign).value() - sign * 1e-10);
  }
  return Settled(FromSpace(design.assembly, there.value())).value();
}

double Apart(const Design& a, const Design& b) {
  return (InSpace(a) - InSpace(b)).cwiseAbs().maxCoeff();
}

// Some nodes of a design: all of it, its first groups, and some of its elements.
std::vector<std::string> NodesOf(const Design& design) {
  std::vector<std::string> nodes = {""};
  const auto& groups = design.assembly->assembly().groups;
  for (std::size_t i = 1; i < groups.size() && i < 3; ++i) nodes.push_back(groups[i].name);
  int leaves = 0;
  for (const parametric::Element& element : design.assembly->elements()) {
    if (element.connecting || leaves == 2) continue;
    nodes.push_back(
        design.assembly->assembly().parts[static_cast<std::size_t>(element.parts.front())].name);
    ++leaves;
  }
  return nodes;
}

class NodeDragTest : public ::testing::TestWithParam<std::string> {};

// Values come in any order, some out of reach: each gives the design that one drag from the
// beginning gives, which holds to 1e-9 m.
TEST_P(NodeDragTest, AnyOrderOfValuesGivesWhatOneDragGives) {
  const Design& drawn = ShippedDesign(GetParam());
  const auto space = SpaceOf(drawn);
  std::mt19937 random(7);
  int dragged = 0;
  for (const std::string& node : NodesOf(drawn)) {
    ASSERT_OK_AND_ASSIGN(const std::vector<Control> controls, ControlsOf(drawn, node));
    for (const Control& control : controls) {
      ASSERT_OK_AND_ASSIGN(NodeDrag drag,
                           NodeDrag::Begin(space, drawn, node, control.kind, control.axis));
      const double span = control.maximum - control.minimum;
      std::uniform_real_distribution<double> value(control.minimum - 0.1 * span,
                                                   control.maximum + 0.1 * span);
      for (int i = 0; i < 6; ++i) {
        const double wanted = value(random);
        ASSERT_OK_AND_ASSIGN(const Design there, drag.To(wanted));
        ++dragged;
        EXPECT_TRUE(there.assembly->feasible_set().Violations(there.q, 1e-9).empty());
        EXPECT_NEAR(drag.ValueIn(there), std::clamp(wanted, control.minimum, control.maximum),
                    kSame);
        EXPECT_LE(Apart(there, PlainDrag(drawn, node, control, wanted)), kSame)
            << node << " " << static_cast<int>(control.kind) << " " << AxisName(control.axis)
            << " to " << wanted;
      }
    }
  }
  EXPECT_GT(dragged, 0);
}

INSTANTIATE_TEST_SUITE_P(Collection, NodeDragTest,
                         ::testing::Values("bookshelf", "dining_table", "toy_chest", "tool_cart",
                                           "cabinet", "workbench"),
                         [](const auto& shipped) { return shipped.param; });

// A design that was dragged before is a beginning like any other.
TEST(NodeDragOfDraggedTest, BeginsAnywhere) {
  const Design& drawn = ShippedDesign("bookshelf");
  ASSERT_OK_AND_ASSIGN(Design here, Drag(drawn, "", ControlKind::kSize, Axis::kX, 1.1));
  here.shift += Eigen::Vector3d(0.3, -0.2, 0.1);
  ASSERT_OK_AND_ASSIGN(NodeDrag drag,
                       NodeDrag::Begin(SpaceOf(here), here, "", ControlKind::kSize, Axis::kZ));
  const Control height{ControlKind::kSize, Axis::kZ, 0, 0, 0};
  for (const double value : {2.1, 1.5, 1.9, 9.0, 2.0, 0.1}) {
    ASSERT_OK_AND_ASSIGN(const Design there, drag.To(value));
    EXPECT_LE(Apart(there, PlainDrag(here, "", height, value)), kSame) << value;
    EXPECT_NEAR(BoundsOf(there).minimum.z(), 0.1, kSame);
  }
}

// What is not dragged does not move by a bit, and the first value is that of Drag to the last bit.
TEST(NodeDragOfDraggedTest, TheFirstValueIsThatOfDrag) {
  const Design& drawn = ShippedDesign("cabinet");
  ASSERT_OK_AND_ASSIGN(NodeDrag drag,
                       NodeDrag::Begin(SpaceOf(drawn), drawn, "", ControlKind::kSize, Axis::kX));
  ASSERT_OK_AND_ASSIGN(const Design first, drag.To(1.1));
  ASSERT_OK_AND_ASSIGN(const Design plain, Drag(drawn, "", ControlKind::kSize, Axis::kX, 1.1));
  EXPECT_EQ(first.q, plain.q);
  EXPECT_EQ(first.shift, plain.shift);
}

TEST(NodeDragOfDraggedTest, ManyElementsThatAreAllDifferent) {
  ASSERT_OK_AND_ASSIGN(const Design drawn, AsDrawn(parametric::Bookcase(4, 8)));
  ASSERT_OK_AND_ASSIGN(NodeDrag drag, NodeDrag::Begin(SpaceOf(drawn), drawn, "shelf 1 3",
                                                      ControlKind::kCenter, Axis::kZ));
  const Control height{ControlKind::kCenter, Axis::kZ, 0, 0, 0};
  for (const double value : {0.8, 0.95, 1.3, 1.7, 0.3, 0.9}) {
    ASSERT_OK_AND_ASSIGN(const Design there, drag.To(value));
    EXPECT_LE(Apart(there, PlainDrag(drawn, "shelf 1 3", height, value)), kSame) << value;
  }
}

TEST(NodeDragOfDraggedTest, RefusesWhatDragRefuses) {
  const Design& drawn = ShippedDesign("bookshelf");
  const auto space = SpaceOf(drawn);
  EXPECT_EQ(DetailOf(NodeDrag::Begin(space, drawn, "cellar", ControlKind::kSize, Axis::kX).status())
                .field,
            "node");
  EXPECT_EQ(DetailOf(NodeDrag::Begin(space, drawn, "side 1", ControlKind::kSize, Axis::kX).status())
                .field,
            "control");
  ASSERT_OK_AND_ASSIGN(NodeDrag drag,
                       NodeDrag::Begin(space, drawn, "side 1", ControlKind::kSize, Axis::kZ));
  EXPECT_EQ(DetailOf(drag.To(std::numeric_limits<double>::infinity()).status()).field, "value");
  EXPECT_TRUE(drag.To(1.9).ok());
}

}  // namespace
}  // namespace mortise::composer
