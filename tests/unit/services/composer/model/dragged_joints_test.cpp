// What a joint moves follows when the body is dragged: its centre stays where its hinge is.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "services/composer/connecting/connect.h"
#include "services/composer/model/controls.h"
#include "services/composer/model/design.h"
#include "services/composer/snapping/snap.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::AssemblyPart;

// A cabinet's door, dropped near its case, snapped and connected.
absl::StatusOr<Connected> CabinetWithDoor() {
  const Design body = ShippedComponent("cabinet", "case");
  const Design door = DroppedAt(ShippedComponent("cabinet", "left door"), {0.26, -0.02, 0.31});
  const Original original = ShippedOriginal("cabinet");
  MORTISE_ASSIGN_OR_RETURN(const Snapped snapped, Snap(door, &original.design, body));
  return Connect(body, snapped.component, "door", &original, AllShippedConnections(),
                 ShippedOptions());
}

// From the joint's centre to the middle of the first hinge, across the axis, which is along z.
Eigen::Vector2d FromCenterToHinge(const Assembly& assembly) {
  const auto hinge =
      std::find_if(assembly.parts.begin(), assembly.parts.end(), [](const AssemblyPart& part) {
        return part.connecting && part.name.find("hinge") != std::string::npos &&
               part.name.find("screw") == std::string::npos;
      });
  EXPECT_NE(hinge, assembly.parts.end());
  return (hinge->box.center() - assembly.joints.front().center).head<2>();
}

TEST(DraggedJointsTest, TheCenterStaysWhereTheHingeIs) {
  ASSERT_OK_AND_ASSIGN(const Connected made, CabinetWithDoor());
  ASSERT_OK_AND_ASSIGN(const Assembly before, DrawnAt(made.model));
  ASSERT_EQ(before.joints.size(), 1U);
  const Eigen::Vector2d apart = FromCenterToHinge(before);
  const double width = BoundsOf(made.model).size().x();
  for (const double wanted : {width + 0.2, width - 0.1}) {
    ASSERT_OK_AND_ASSIGN(const Design dragged,
                         Drag(made.model, "", ControlKind::kSize, Axis::kX, wanted));
    ASSERT_OK_AND_ASSIGN(const Assembly after, DrawnAt(dragged));
    // The middle stays, so the side that the door hangs on moves, and its hinges with it.
    EXPECT_GT((after.joints.front().center - before.joints.front().center).norm(), 0.04);
    EXPECT_LE((FromCenterToHinge(after) - apart).norm(), 1e-6) << wanted;
    EXPECT_EQ(after.joints.front().kind, parametric::JointKind::kHinge);
  }
}

}  // namespace
}  // namespace mortise::composer
